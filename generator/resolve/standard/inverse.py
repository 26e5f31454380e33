"""Inverse of a conversion: the expressions that give the payload's fields, and obstacles."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from roverlink.generator.ir.interfaces import (
    Chosen,
    Expression,
    Moment,
    Parts,
    Path,
    Recovered,
    Rotation,
    Source,
    Taken,
    TargetField,
)


@dataclass(frozen=True, slots=True)
class Inverse:
    """Conversion of a standard message back to the payload."""

    recovered: tuple[Recovered, ...]
    obstacle: str
    """Reason why the conversion is impossible; empty if it is possible."""
    told: tuple[str, ...]
    """Paths of the payload's fields that the message contains."""


def invert(fields: Iterable[TargetField]) -> Inverse:
    """Return the inverse of a message's expressions. A field that is used twice is taken from the first expression."""
    recovered: list[Recovered] = []
    told: dict[str, Source] = {}
    obstacle = ""
    for path, field in _leaves(fields, ()):
        value = field.value
        sources = [source for source in _sources(value) if source.dotted not in told]
        if not sources or not isinstance(value, (Taken, Chosen, Rotation, Moment)):
            continue
        obstacle = obstacle or _obstacle(value, path)
        recovered.append(Recovered(path, field.type, value))
        told |= {source.dotted: source for source in sources}
    oneofs = Counter(source.oneof for source in told.values() if source.oneof)
    if not obstacle and (shared := next((name for name, count in oneofs.items() if count > 1), "")):
        obstacle = f"it uses several members of the oneof {shared!r}, but only one of them can be set"
    if obstacle:
        return Inverse((), obstacle, ())
    return Inverse(tuple(recovered), "", tuple(told))


def _leaves(fields: Iterable[TargetField], path: Path) -> Iterator[tuple[Path, TargetField]]:
    for field in fields:
        own = (*path, field.name)
        if isinstance(field.value, Parts):
            yield from _leaves(field.value.fields, own)
        else:
            yield own, field


def sources_of(fields: Iterable[TargetField]) -> Iterator[Source]:
    """Yield every field of the payload that fills a message's fields."""
    for _, field in _leaves(fields, ()):
        yield from _sources(field.value)


def _sources(value: Expression) -> list[Source]:
    if isinstance(value, (Taken, Chosen)):
        return [value.source]
    if isinstance(value, Rotation):
        return [part.source for part in (value.roll, value.pitch, value.yaw) if isinstance(part, Taken)]
    return [value.source] if isinstance(value, Moment) and value.source else []


def _obstacle(value: Expression, path: Path) -> str:
    """Return the reason why an expression cannot be inverted; empty if it can."""
    dotted = ".".join(path)
    if isinstance(value, Taken) and value.rounded:
        return f"{dotted!r} contains {value.source.dotted!r} rounded to an integer"
    if isinstance(value, Chosen):
        seen: dict[object, str] = {}
        for case in value.cases:
            if (first := seen.setdefault(case.value, case.name)) != case.name:
                shared = case.constant or case.value
                return f"{dotted!r} is {shared} for {first!r} and for {case.name!r} of {value.source.dotted!r}"
        if value.default is not None and value.default.value in seen:
            shared = value.default.constant or value.default.value
            return (
                f"{dotted!r} is {shared} for {seen[value.default.value]!r} and for every other {value.source.dotted!r}"
            )
    return ""
