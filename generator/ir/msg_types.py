"""Spelling of types in .msg files."""

from __future__ import annotations

from roverlink.generator import ir


def msg_type(type: ir.RosType) -> str:
    """Return a field's type as a .msg file spells it."""
    name = f"{type.package}/{type.name}" if type.package else type.name
    return f"{name}[]" if type.is_sequence else name
