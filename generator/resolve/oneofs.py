"""Conversion of oneofs: the members become fields, and a discriminator tells which member is set."""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.generator import ir
from roverlink.generator.ir import ros_names
from roverlink.generator.protos.schema import ProtoField, ProtoMessage

NONE = "NONE"


def discriminator(
    message: ProtoMessage, oneof: str, members: Sequence[ProtoField], name: str | None
) -> tuple[ir.RosField, list[ir.RosConstant], tuple[ir.Choice, ...]]:
    """Return the discriminator field of a oneof, and its constants.

    A member's constant is its field number, so that adding or reordering members does not change the others.
    """
    source, prefix = f"{message.full_name}.{oneof}", ros_names.constant_name(oneof)
    type = smallest(max(member.number for member in members))
    ros = ir.RosField(
        name or f"which_{ros_names.lowered(oneof)}".rstrip("_"),
        ir.RosType(type),
        f"The member of {oneof} that is set.",
        source,
    )
    choices = tuple(ir.Choice(member.name, f"{prefix}_{ros_names.constant_name(member.name)}") for member in members)
    numbers = [(f"{prefix}_{NONE}", 0), *((choice.constant, one.number) for choice, one in zip(choices, members))]
    return ros, [ir.RosConstant(constant, type, number, "", source) for constant, number in numbers], choices


def smallest(number: int) -> str:
    """Return the smallest unsigned ROS integer type for numbers from 0 to a number."""
    return "uint8" if number < 2**8 else "uint16" if number < 2**16 else "uint32"
