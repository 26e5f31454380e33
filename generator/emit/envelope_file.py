"""Texts of the .proto files of the envelope and the link message, for tables with ``owner: mapping``."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import header, render


def text(envelope: ir.Envelope, table: str) -> str:
    """Return the text of the envelope's .proto file: imports, the oneof of payloads, and reserved numbers and names.

    ``table`` is the name of the table, for the comment at the top.
    """
    package, _, message = envelope.message.rpartition(".")
    return render(
        "envelope.proto.j2",
        header=header(table, "//"),
        package=package,
        # protoc looks a name up from the innermost scope outwards; a leading dot makes it start at the outermost.
        outermost="." if package else "",
        message=message,
        oneof=envelope.oneof,
        imports=sorted({member.file for member in envelope.members}),
        members=envelope.members,
        retired=envelope.retired,
        burned=envelope.burned,
        signature=envelope.signature,
    )


def link_text(table: str) -> str:
    """Return the text of the link message's .proto file; ``table`` is the name of the table, for the comment."""
    package, _, message = ir.LINK_MESSAGE.rpartition(".")
    return render("link.proto.j2", header=header(table, "//"), package=package, message=message, fields=ir.LINK_FIELDS)
