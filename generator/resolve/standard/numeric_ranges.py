"""Which numbers fit where: ranges, and what a conversion from one type to another loses."""

from __future__ import annotations

from fractions import Fraction

from roverlink.generator.ir.interfaces import Scaling, Source

_MANTISSA = {"float32": 24, "float64": 53}
_SPELLED = {"byte": "uint8", "char": "uint8", "octet": "uint8"}


def range_of(type: str) -> tuple[int, int] | None:
    """The smallest and the largest number of an integer type; None for any other."""
    type = _SPELLED.get(type, type)
    if "int" not in type:
        return None
    bits = int(type.removeprefix("u").removeprefix("int"))
    return (0, 2**bits - 1) if type.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


def is_float(type: str) -> bool:
    """Whether it holds numbers with a fraction."""
    return type in _MANTISSA


def loss(source: Source, scaling: Scaling, target: str) -> str:
    """What may be lost on the way from a source to a type; empty for nothing."""
    taken = range_of(source.type)
    if is_float(target):
        return _loss_in_float(source.type, scaling, target)
    if taken is None or not scaling.is_whole:
        return f"becomes a whole number in {target}"
    low, high = sorted(int(end * scaling.factor + scaling.offset) for end in taken)
    room = range_of(target)
    if room is None or (room[0] <= low and high <= room[1]):
        return ""
    return f"goes from {low} to {high}, and {target} from {room[0]} to {room[1]}"


def _loss_in_float(source: str, scaling: Scaling, target: str) -> str:
    """A scaled number is as exact as a double; one that stays as it is keeps its own digits."""
    digits = _MANTISSA[target]
    taken = range_of(source)
    if taken is None:
        return f"has the digits of a {source}, and {target} has fewer" if _MANTISSA[source] > digits else ""
    if not scaling.is_identity and target == "float32":
        return "scaled has more digits than float32" if max(map(abs, taken)) >= 2**16 else ""
    if max(map(abs, taken)) > 2**digits:
        return f"has up to {max(taken).bit_length()} bits, and {target} keeps {digits} of them"
    return ""


def constant(value: Fraction | float, type: str) -> int | float | None:
    """A number of the table in a type; None where it does not fit."""
    if is_float(type):
        return float(value)
    room = range_of(type)
    if room is None or isinstance(value, float) or value.denominator != 1 or not room[0] <= value <= room[1]:
        return None
    return int(value)
