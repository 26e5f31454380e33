"""Conversion of proto enums to ROS: an enum field becomes an integer field, and the enum's values become constants.

The constants are declared in the .msg file that has the field.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir import ros_names
from roverlink.generator.protos.schema import ProtoEnum, ProtoEnumValue, commented
from roverlink.generator.resolve.conversion_rules import ConstantName
from roverlink.generator.resolve.numeric_ranges import smallest_integer


def integer_type(enum: ProtoEnum) -> str:
    """Return the smallest ROS integer type that holds all values of an enum."""
    return smallest_integer([value.number for value in enum.values])


def constants(enum: ProtoEnum, prefix: str, report: Callable[[Diagnostic], None]) -> Iterator[ir.RosConstant]:
    """Yield a constant of a ROS message for each value of an enum; each constant's name begins with ``prefix``.

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
                ConstantName.at(
                    enum.span, message, "rename the value; the name is not sent, so the encoding does not change"
                )
            )
        elif first.number != value.number:
            message = f"'{enum.full_name}.{value.name}' and {first.name!r} would both become the constant {name!r}"
            report(
                ConstantName.at(
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
    """Yield all constants of a ROS message: the constants of its enums, and ``others``, the constants of its oneofs.

    If a constant of an enum has the same name as another constant, all constants of the enum get the enum's name as a
    prefix: ``MODE_IDLE`` for the value ``IDLE`` of ``Mode``. ``ros`` is the name of the ROS message. ``span`` is the
    place in the .proto file for diagnostics about ``others``.
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
    message = (
        f"the ROS message {ros!r} would have two constants with the name {constant.name!r}, "
        f"one for the enum or oneof {holder!r} and one for {constant.enum!r}"
    )
    help = (
        "rename an enum value or a member of the oneof in the .proto file, or list an enum under `enums` in "
        "mapping.yaml: it then becomes a ROS message of its own"
    )
    report(ConstantName.at(span, message, help))
