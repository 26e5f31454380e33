"""Descriptions of the values that fill the fields of a standard message, as text for docs/messages.md."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.ir import StandardTopic
from roverlink.generator.ir.interfaces import (
    BoardTime,
    Chosen,
    Constant,
    Expression,
    Moment,
    Parts,
    Path,
    Rotation,
    Scaling,
    Taken,
    TargetField,
    Unset,
)


def fields(standard: StandardTopic) -> list[tuple[str, str]]:
    """Return each filled field of a standard topic's message: its path, and the description of its value.

    An entry is ``("angular_velocity.x", "`gyro_x` × 1/180 × π (deg/s to rad/s)")``.
    """
    return list(_rows(standard.fields, ()))


def _rows(fields: tuple[TargetField, ...], path: Path) -> Iterator[tuple[str, str]]:
    for field in fields:
        own = (*path, field.name)
        if isinstance(field.value, Parts):
            yield from _rows(field.value.fields, own)
        elif not isinstance(field.value, Unset):
            yield ".".join(own), _words(field.value)


def _words(value: Expression) -> str:
    if isinstance(value, Taken):
        return _taken(value)
    if isinstance(value, Chosen):
        cases = ", ".join(f"{case.name}: {case.counterpart.shown}" for case in value.cases)
        default = f"; else {value.default.shown}" if value.default else ""
        return f"`{value.source.dotted}` ({cases}{default})"
    if isinstance(value, Rotation):
        return "roll {}, pitch {}, yaw {}".format(*(_words(part) for part in (value.roll, value.pitch, value.yaw)))
    if isinstance(value, BoardTime):
        return f"time of measuring: `{value.counter.dotted}`, each {value.nanoseconds} ns, by the clock of the board"
    if isinstance(value, Moment):
        if value.source is None:
            return "time of reception"
        return f"`{value.source.dotted}`, each {value.nanoseconds} ns"
    return _constant(value) if isinstance(value, Constant) else ""


def _taken(value: Taken) -> str:
    default = f"; {value.default.shown} if it is absent" if value.default else ""
    return f"`{value.source.dotted}`{_scaled(value.scaling)}{default}"


def _scaled(scaling: Scaling) -> str:
    if scaling.is_identity:
        return f" ({scaling.unit})" if scaling.unit else ""
    factor = "" if scaling.factor == 1 else f" × {scaling.factor}"
    pi = f" × π{'' if scaling.pi == 1 else f'^{scaling.pi}'}" if scaling.pi else ""
    offset = "" if not scaling.offset else f" {'-' if scaling.offset < 0 else '+'} {abs(scaling.offset)}"
    units = f" ({scaling.unit} to {scaling.to})" if scaling.unit or scaling.to else ""
    return f"{factor}{offset}{pi}{units}"


def _constant(value: Constant) -> str:
    if isinstance(value.value, tuple):
        return f"[{', '.join(map(str, value.value))}]"
    if value.name:
        return f"{value.name} ({value.value})"
    return f"`{value.value}`" if isinstance(value.value, str) else str(value.value)
