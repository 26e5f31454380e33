"""Inverse of the conversion of a payload to a standard message: from the standard message back to the payload."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from roverlink.generator.ir.interfaces import (
    BoardTime,
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

# A row to a peer goes the other way: the payload is computed from the message. Not every mapping can be read backwards:
# - A scaled number can: the factor is never zero. But not if it was rounded to an integer, since several payloads give
#   the same integer.
# - A choice by an enum can, if no two values of the enum give the same constant.
# - A rotation can: its three angles follow from the quaternion. So can a time.
# - Constants and unset fields tell nothing about the payload.
#
# What remains is a check that the payload is determined: all of its fields are found (`found`), and at most one member
# of each oneof.


@dataclass(frozen=True, slots=True)
class Inverse:
    """Conversion from a standard message back to the payload, or the reason why this conversion is not possible."""

    recovered: tuple[Recovered, ...]
    obstacle: str
    """Reason why the payload cannot be computed from the message; empty if it can."""
    found: tuple[str, ...]
    """Paths of the payload's fields that can be computed from the message, with dots: ``accel.x``."""


def invert(fields: Iterable[TargetField]) -> Inverse:
    """Return the conversion of a standard message back to the payload.

    If two fields of the message contain the same field of the payload, the first one is used.
    """
    recovered: list[Recovered] = []
    found: dict[str, Source] = {}
    obstacle = ""
    for path, field in _leaves(fields, ()):
        value = field.value
        sources = [source for source in _sources(value) if source.dotted not in found]
        if not sources or not isinstance(value, (Taken, Chosen, Rotation, Moment)):
            continue
        obstacle = obstacle or _obstacle(value, path)
        recovered.append(Recovered(path, field.type, value))
        found |= {source.dotted: source for source in sources}
    oneofs = Counter(source.oneof for source in found.values() if source.oneof)
    if not obstacle and (shared := next((name for name, count in oneofs.items() if count > 1), "")):
        obstacle = f"the mapping uses several members of the oneof {shared!r}, but only one of them can be set"
    if obstacle:
        return Inverse((), obstacle, ())
    return Inverse(tuple(recovered), "", tuple(found))


def _leaves(fields: Iterable[TargetField], path: Path) -> Iterator[tuple[Path, TargetField]]:
    for field in fields:
        own = (*path, field.name)
        if isinstance(field.value, Parts):
            yield from _leaves(field.value.fields, own)
        else:
            yield own, field


def sources_of(fields: Iterable[TargetField]) -> Iterator[Source]:
    """Yield every field of the payload that is used in a standard message; a field may appear several times."""
    for _, field in _leaves(fields, ()):
        yield from _sources(field.value)
        if isinstance(field.value, BoardTime):
            yield field.value.counter


def _sources(value: Expression) -> list[Source]:
    if isinstance(value, (Taken, Chosen)):
        return [value.source]
    if isinstance(value, Rotation):
        return [part.source for part in (value.roll, value.pitch, value.yaw) if isinstance(part, Taken)]
    return [value.source] if isinstance(value, Moment) and value.source else []


def _obstacle(value: Expression, path: Path) -> str:
    """Return the reason why the payload cannot be computed from the field ``path`` of a standard message.

    ``value`` is the expression that fills this field. The reason is empty if the payload can be computed.
    """
    dotted = ".".join(path)
    if isinstance(value, Taken) and value.rounded:
        return f"{dotted!r} contains {value.source.dotted!r} rounded to an integer"
    if isinstance(value, Chosen):
        seen: dict[object, str] = {}
        for case in value.cases:
            if (first := seen.setdefault(case.counterpart.value, case.name)) != case.name:
                shared = case.counterpart.shown
                return f"{dotted!r} is {shared} for {first!r} and for {case.name!r} of {value.source.dotted!r}"
        if value.default is not None and value.default.value in seen:
            shared = value.default.shown
            return (
                f"{dotted!r} is {shared} for {seen[value.default.value]!r} and for all other values of "
                f"{value.source.dotted!r}"
            )
    return ""
