"""Conversion of ROS types to the text that stands in .msg files."""

from __future__ import annotations

from roverlink.generator import ir


def msg_type(type: ir.RosType) -> str:
    """Return the type of a field as a .msg file writes it: ``float64[]``."""
    name = f"{type.package}/{type.name}" if type.package else type.name
    return f"{name}[]" if type.is_sequence else name
