"""What a standard message must hold by the IR, reckoned exactly; for `crosscheck`.

A reading of the IR that shares nothing with the one that writes Python: fractions instead of floats, values instead of
text. rosbags says which bytes a message has.
"""

from __future__ import annotations

import math
import struct
from fractions import Fraction
from functools import reduce
from typing import Any

from google.protobuf.message import Message as Payload

from roverlink.generator.ir import StandardTopic
from roverlink.generator.ir.interfaces import (
    Chosen,
    Constant,
    Expression,
    InterfaceType,
    Moment,
    Parts,
    Rotation,
    Scaling,
    Source,
    Taken,
    Unset,
)
from roverlink.runtime.interfaces import Time

_LARGEST_ANGLE = 100.0
"""Beyond, the last digit of an angle is felt in its sine."""

DOES_NOT_FIT = object()
"""Stands for a value that the bridge must refuse."""


def values(standard: StandardTopic, payload: Payload, stamp: Time) -> dict[str, Any]:
    """What a message holds, but for what nothing fills."""
    return _parts(Parts(standard.fields), payload, stamp)


def _parts(parts: Parts, payload: Payload, stamp: Time) -> dict[str, Any]:
    return {
        field.name: _value(field.value, field.type, payload, stamp)
        for field in parts.fields
        if not isinstance(field.value, Unset)
    }


def _value(value: Expression, type: InterfaceType, payload: Payload, stamp: Time) -> Any:
    if isinstance(value, Parts):
        return _parts(value, payload, stamp)
    if isinstance(value, Constant):
        held = list(value.value) if isinstance(value.value, tuple) else value.value
        return _single(held) if type.name == "float32" and isinstance(held, float) else held
    if isinstance(value, Moment):
        return _time(value, payload, stamp)
    if isinstance(value, Rotation):
        return _quaternion(*(_angle(part, payload) for part in (value.roll, value.pitch, value.yaw)))
    if isinstance(value, Chosen):
        found = [case.counterpart.value for case in value.cases if case.number == _of(payload, value.source)]
        return found[0] if found else (value.default.value if value.default else DOES_NOT_FIT)
    assert isinstance(value, Taken)
    return _taken(value, type, payload)


def _of(payload: Payload, source: Source) -> Any:
    return reduce(getattr, source.path, payload)


def _taken(value: Taken, type: InterfaceType, payload: Payload) -> Any:
    *holders, name = value.source.path
    if value.default and not reduce(getattr, holders, payload).HasField(name):
        return value.default.value
    raw = _of(payload, value.source)
    if value.source.type == "bytes":
        return list(raw)
    if value.source.repeated:
        made = [_number(value, type, item) for item in raw]
        if type.length is not None and len(made) != type.length:
            return DOES_NOT_FIT
        return DOES_NOT_FIT if DOES_NOT_FIT in made else made
    return raw if isinstance(raw, (str, bool)) else _number(value, type, raw)


def _number(value: Taken, type: InterfaceType, raw: float) -> Any:
    scaled = _scaled(value.scaling, raw)
    if "int" in type.name:
        if not math.isfinite(scaled):
            return DOES_NOT_FIT
        whole = round(scaled)
        bits = int(type.name.removeprefix("u").removeprefix("int"))
        low = 0 if type.name.startswith("u") else -(2 ** (bits - 1))
        return whole if low <= whole < low + 2**bits else DOES_NOT_FIT
    if type.name == "float32":
        try:
            return _single(float(scaled))
        except OverflowError:
            return DOES_NOT_FIT
    return float(scaled)


def _single(value: float) -> float:
    return float(struct.unpack("f", struct.pack("f", value))[0])


def _scaled(scaling: Scaling, raw: float) -> Fraction | float:
    if not math.isfinite(raw):
        return raw if scaling.factor > 0 else -raw
    exact = Fraction(raw) * scaling.factor + scaling.offset
    return exact if not scaling.pi else float(exact) * math.pi**scaling.pi


def _angle(part: Taken | Constant, payload: Payload) -> float:
    if isinstance(part, Constant):
        assert isinstance(part.value, float)
        return part.value
    found = _taken(part, InterfaceType("float64"), payload)
    assert isinstance(found, float)
    return found


def _quaternion(roll: float, pitch: float, yaw: float) -> Any:
    """A product of three turns: about x first, about z last."""
    if not all(map(math.isfinite, (roll, pitch, yaw))):
        return DOES_NOT_FIT
    if max(map(abs, (roll, pitch, yaw))) > _LARGEST_ANGLE:
        return {}
    turned = (0.0, 0.0, 0.0, 1.0)
    for axis, angle in enumerate((roll, pitch, yaw)):
        turn = [0.0, 0.0, 0.0, math.cos(angle / 2)]
        turn[axis] = math.sin(angle / 2)
        turned = _product(turn, turned)
    return dict(zip("xyzw", turned))


def _product(a: Any, b: Any) -> tuple[float, float, float, float]:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _time(value: Moment, payload: Payload, stamp: Time) -> Any:
    if value.source is None:
        return {"sec": stamp.sec, "nanosec": stamp.nanosec}
    raw = _of(payload, value.source)
    if not math.isfinite(raw):
        return DOES_NOT_FIT
    exact = raw * value.nanoseconds if isinstance(raw, int) else raw * float(value.nanoseconds)
    if not math.isfinite(exact):
        return DOES_NOT_FIT
    sec, nanosec = divmod(round(exact), 10**9)
    return {"sec": sec, "nanosec": nanosec} if -(2**31) <= sec < 2**31 else DOES_NOT_FIT


def fits(value: Any) -> bool:
    """Whether nothing in it must be refused."""
    if isinstance(value, dict):
        return all(fits(part) for part in value.values())
    return value is not DOES_NOT_FIT


def equal(found: Any, wanted: Any, tolerance: float = 1e-12) -> bool:
    """Whether what was found holds what was wanted; floats may differ in their last digits, rotations in their sign."""
    if isinstance(wanted, dict) and set(wanted) == set("xyzw") and set(found) == set("xyzw"):
        turned = {name: -part for name, part in wanted.items()}
        off = (max(abs(found[name] - one[name]) for name in found) for one in (wanted, turned))
        return min(off) < max(tolerance, 1e-9)
    if isinstance(wanted, dict):
        return all(equal(found[name], part, tolerance) for name, part in wanted.items() if name in found)
    if isinstance(wanted, list):
        return len(found) == len(wanted) and all(equal(a, b, tolerance) for a, b in zip(found, wanted))
    if isinstance(wanted, float) and math.isnan(wanted):
        return math.isnan(found)
    if isinstance(wanted, float):
        return math.isclose(found, wanted, rel_tol=1e-6 if abs(found) < 1e-37 else tolerance, abs_tol=1e-12)
    return bool(found == wanted)
