"""How .msg files spell types."""

from __future__ import annotations

from roverlink.generator import ir


def msg_type(type: ir.RosType) -> str:
    """A field's type as a .msg spells it."""
    name = f"{type.package}/{type.name}" if type.package else type.name
    return f"{name}[]" if type.is_sequence else name
