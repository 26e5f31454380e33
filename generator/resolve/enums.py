"""Conversion of proto enums to ROS: each becomes an integer field, and constants of the message with the field."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir import ros_names
from roverlink.generator.protos.schema import ProtoEnum, ProtoEnumValue, commented
from roverlink.generator.resolve.conversion_rules import CONSTANT_NAME

# An enum of proto is an int32; the smallest ROS type saves bytes in every message.
_INTEGERS = (("uint8", 0, 2**8), ("uint16", 0, 2**16), ("uint32", 0, 2**32))
_SIGNED_INTEGERS = (("int8", -(2**7), 2**7), ("int16", -(2**15), 2**15), ("int32", -(2**31), 2**31))


def integer_type(enum: ProtoEnum) -> str:
    """Return the smallest ROS integer type that holds all values of an enum.

    The type is signed only if a value is negative.
    """
    numbers = [value.number for value in enum.values]
    for name, low, end in _SIGNED_INTEGERS if min(numbers) < 0 else _INTEGERS:
        if low <= min(numbers) and max(numbers) < end:
            return name
    raise AssertionError("an enum value is an int32")


def constants(enum: ProtoEnum, prefix: str, report: Callable[[Diagnostic], None]) -> Iterator[ir.RosConstant]:
    """Yield a constant of a ROS message for each value of an enum; the constants' names begin with ``prefix``.

    A value that cannot become a constant is reported.
    """
    type = integer_type(enum)
    seen: dict[str, ProtoEnumValue] = {}
    for value in enum.values:
        name = prefix + ros_names.constant_name(value.name)
        first = seen.setdefault(name, value)
        if not ros_names.is_constant_name(name):
            message = (
                f"'{enum.full_name}.{value.name}' cannot be a ROS constant, which has capitals, digits and single _"
            )
            report(
                CONSTANT_NAME.at(
                    enum.span, message, "rename the value; the name is not sent, so the encoding does not change"
                )
            )
        elif first.number != value.number:
            message = f"'{enum.full_name}.{value.name}' and {first.name!r} would both become the constant {name!r}"
            report(
                CONSTANT_NAME.at(
                    enum.span, message, "rename one of the values; names are not sent, so the encoding does not change"
                )
            )
        elif first is value:  # with allow_alias, two names of one number may differ only in capitals
            yield ir.RosConstant(name, type, value.number, commented(value), enum.full_name)


def constants_of(
    enums: Iterable[ProtoEnum],
    others: Iterable[ir.RosConstant],
    ros: str,
    span: Span,
    report: Callable[[Diagnostic], None],
) -> Iterator[ir.RosConstant]:
    """Yield the constants of a ROS message: those for its enums, and ``others``, which are for its oneofs.

    If two constants share a name, those of an enum get the enum's name as a prefix. `span` is the place of the message.
    """
    enums, others = tuple(enums), tuple(dict.fromkeys(others))
    # All constants of a ROS message share one scope. Enums that are declared in different messages may use the same
    # names.
    names = [other.name for other in others]
    names += [name for enum in enums for name in {ros_names.constant_name(value.name) for value in enum.values}]
    seen: dict[str, ir.RosConstant] = {}
    for other in others:
        yield from _unless_taken(other, seen, ros, span, report)
    for enum in enums:
        shared = any(names.count(ros_names.constant_name(value.name)) > 1 for value in enum.values)
        prefix = f"{ros_names.constant_name(enum.full_name.rpartition('.')[2])}_" if shared else ""
        for constant in constants(enum, prefix, report):
            yield from _unless_taken(constant, seen, ros, enum.span, report)


def _unless_taken(
    constant: ir.RosConstant,
    seen: dict[str, ir.RosConstant],
    ros: str,
    span: Span,
    report: Callable[[Diagnostic], None],
) -> Iterator[ir.RosConstant]:
    holder = seen.setdefault(constant.name, constant).enum
    if holder == constant.enum:
        yield constant
        return
    message = f"{ros!r} would have the constant {constant.name!r} twice: from {holder!r} and from {constant.enum!r}"
    report(
        CONSTANT_NAME.at(span, message, "rename one of them, or give an enum a ROS message of its own under `enums`")
    )
