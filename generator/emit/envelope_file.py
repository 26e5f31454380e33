"""Text of the envelope's .proto file, for a project whose table owns that file."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import header, render


def text(envelope: ir.Envelope, table: str) -> str:
    """Return the envelope's .proto file: its imports, its oneof, and its reserved numbers and names."""
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
    )
