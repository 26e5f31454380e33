"""Conversion of oneofs to ROS: each member becomes a field, and one more field tells which member is set.

For a oneof ``order``, this is the integer field ``which_order`` with constants such as ``ORDER_DRILL_TO``.
"""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.generator import ir
from roverlink.generator.ir import ros_names
from roverlink.generator.protos.schema import ProtoField, ProtoMessage
from roverlink.generator.resolve.numeric_ranges import smallest_integer

NONE = "NONE"


def discriminator(
    message: ProtoMessage, oneof: str, members: Sequence[ProtoField], name: str | None
) -> tuple[ir.RosField, list[ir.RosConstant], tuple[ir.Choice, ...]]:
    """Return the ROS field that tells which member of a oneof is set, its constants, and a choice for each member.

    The value of a member's constant is the member's field number, so it does not change if members are added or
    reordered. The value 0 means that no member is set. ``name`` is the ROS field's name from the table; None for the
    default name ``which_<oneof>``.
    """
    source, prefix = f"{message.full_name}.{oneof}", ros_names.constant_name(oneof)
    type = smallest_integer([member.number for member in members])
    ros = ir.RosField(
        name or f"which_{ros_names.lowered(oneof)}".rstrip("_"),
        ir.RosType(type),
        f"The member of {oneof} that is set.",
        source,
    )
    choices = tuple(ir.Choice(member.name, f"{prefix}_{ros_names.constant_name(member.name)}") for member in members)
    numbers = [(f"{prefix}_{NONE}", 0), *((choice.constant, member.number) for choice, member in zip(choices, members))]
    return ros, [ir.RosConstant(constant, type, number, "", source) for constant, number in numbers], choices
