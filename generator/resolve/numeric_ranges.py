"""Ranges of numeric types, and texts about range and precision that a conversion between two types loses."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction

from roverlink.generator.ir.interfaces import Scaling, Source

# Bits of the significand with the hidden one (IEEE 754, binary32 and binary64): every integer up to 2**24, or 2**53, is
# exact.
_MANTISSA = {"float32": 24, "float64": 53}
# In a .msg file, `byte` and `char` are both 8 bits without a sign (rosidl_adapter, MSG_TYPE_TO_IDL).
_SPELLED = {"byte": "uint8", "char": "uint8", "octet": "uint8"}


def range_of(type: str) -> tuple[int, int] | None:
    """Return the smallest and the largest number of an integer type; None for a type that is no integer."""
    type = _SPELLED.get(type, type)
    if "int" not in type:
        return None
    bits = int(type.removeprefix("u").removeprefix("int"))
    return (0, 2**bits - 1) if type.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def smallest_integer(numbers: Collection[int]) -> str:
    """Return the smallest ROS integer type of at most 32 bits that holds all numbers.

    The type is signed only if a number is negative: ``uint8`` for 0 to 3, ``int8`` for -1 to 3.
    """
    low, high = min(numbers), max(numbers)
    needed = max(high, -low - 1).bit_length() + (low < 0)
    return f"{'' if low < 0 else 'u'}int{next(bits for bits in (8, 16, 32) if needed <= bits)}"


def is_float(type: str) -> bool:
    """Return True if the type is a floating point type."""
    return type in _MANTISSA


def loss(source: Source, scaling: Scaling, target: str) -> str:
    """Return a text about the range or precision that a payload field may lose in a ROS type; empty if nothing is lost.

    Example: ``has values from 0 to 65535, but uint8 only from 0 to 255``. ``scaling`` is the conversion of the number,
    and ``target`` is the ROS type.
    """
    taken = range_of(source.type)
    if is_float(target):
        return _loss_in_float(source.type, scaling, target)
    if taken is None or not scaling.is_whole:
        return f"is rounded to an integer in {target}"
    low, high = sorted(int(end * scaling.factor + scaling.offset) for end in taken)
    room = range_of(target)
    if room is None or (room[0] <= low and high <= room[1]):
        return ""
    return f"has values from {low} to {high}, but {target} only from {room[0]} to {room[1]}"


def _loss_in_float(source: str, scaling: Scaling, target: str) -> str:
    """Return a text about the digits that a number may lose in a floating point type; empty if nothing is lost.

    An integer loses digits if it has more bits than the significand. A scaled integer of at most 16 bits fits a
    float32, because the rounding error is far below the resolution of a sensor.
    """
    digits = _MANTISSA[target]
    taken = range_of(source)
    if taken is None:
        return f"is a {source}, which is more precise than {target}" if _MANTISSA[source] > digits else ""
    # A scaled value is usually no float32, and is rounded once. Up to 16 bits, that error is at most 1/256 of the
    # integer's last digit, far below the resolution of the sensor.
    if not scaling.is_identity and target == "float32":
        return "after scaling has more digits than float32" if max(map(abs, taken)) >= 2**16 else ""
    if max(map(abs, taken)) > 2**digits:
        return f"has up to {max(taken).bit_length()} bits, but {target} keeps only {digits}"
    return ""


def constant(value: Fraction | float, type: str) -> int | float | None:
    """Convert a number from the table to a value of a numeric type; return None if the type cannot hold it."""
    if is_float(type):
        return float(value)
    room = range_of(type)
    if room is None or isinstance(value, float) or value.denominator != 1 or not room[0] <= value <= room[1]:
        return None
    return int(value)
