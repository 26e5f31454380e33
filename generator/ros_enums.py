"""What an enum becomes in ROS: an integer, and constants."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from generator import ir, naming
from generator.findings import Finding, Rule
from generator.protos import ProtoEnum

CONSTANT_NAME = Rule("CNV108", "constant-name")

_INTEGERS = (("uint8", 0, 2**8), ("uint16", 0, 2**16), ("uint32", 0, 2**32))
_SIGNED_INTEGERS = (("int8", -(2**7), 2**7), ("int16", -(2**15), 2**15), ("int32", -(2**31), 2**31))


def integer_type(enum: ProtoEnum) -> str:
    """The smallest ROS integer that holds every declared value; signed only where one is negative."""
    numbers = [value.number for value in enum.values]
    for name, low, end in _SIGNED_INTEGERS if min(numbers) < 0 else _INTEGERS:
        if low <= min(numbers) and max(numbers) < end:
            return name
    raise AssertionError("an enum value is an int32")


def constants(enum: ProtoEnum, prefix: str, report: Callable[[Finding], None]) -> Iterator[ir.RosConstant]:
    """An enum's values as constants of a ROS message."""
    type = integer_type(enum)
    for value in enum.values:
        name = prefix + value.name
        if not naming.is_constant_name(name):
            message = f"{enum.full_name}.{value.name} cannot be a constant: ROS wants capitals, digits and single _"
            report(CONSTANT_NAME.at(enum.span, message, "rename it: no wire has its name"))
        yield ir.RosConstant(name, type, value.number, value.comment, enum.full_name)
