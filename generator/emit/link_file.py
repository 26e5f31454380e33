"""Text of the link message's .proto file. roverlink writes this file if the table has ``link``."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import header, render


def text(table: str) -> str:
    """Return the text of the link message's .proto file; ``table`` is the name of the table, for the comment."""
    package, _, message = ir.LINK_MESSAGE.rpartition(".")
    return render("link.proto.j2", header=header(table, "//"), package=package, message=message, fields=ir.LINK_FIELDS)
