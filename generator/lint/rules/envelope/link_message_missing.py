"""The envelope of another repository does not have the link message that the table has under `link`.

If the table owns the envelope's file (`owner: mapping`), `roverlink generate` writes the link message's file and the
member of the envelope. If another repository owns it (`owner: proto`), that repository has to declare both, as below.
Field names, numbers and types must be these, because all programs that use the link message share them.

Bad::

    # mapping.yaml
    envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}
    link: {number: 22}

    # envelope.proto
    message Imu { float x = 1; }
    message Envelope {
      oneof payload {
        Imu imu = 1;
      }
    }

Good::

    # mapping.yaml
    envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}
    link: {number: 22}

    # envelope.proto
    import "link.proto";
    message Imu { float x = 1; }
    message Envelope {
      oneof payload {
        Imu imu = 1;
        roverlink.Link link = 22;
      }
    }

    # link.proto
    syntax = "proto3";
    package roverlink;
    message Link {
      uint32 session = 1;
      uint32 sequence = 2;
      uint32 sent = 3;
      uint32 received = 4;
      uint64 time_us = 5;
      uint64 echo_us = 6;
      uint32 echo_age_us = 7;
      repeated uint32 numbers = 8;
      repeated fixed32 hashes = 9;
    }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.ir import LINK_FIELDS
from roverlink.generator.lint.context import Context

RULE = Rule("LNK101", "link-message-missing", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic if the envelope lacks the link message, or if the link message has other fields."""
    table, link = context.table, context.table.link
    envelope = context.schema.messages.get(table.envelope.message) if context.schema else None
    if context.schema is None or envelope is None or link is None or table.envelope.owner != "proto":
        return
    member = f"{link.proto} {link.name} = {link.number};"
    found = [field for field in envelope.fields if link.number == field.number or link.name == field.name]
    declared = context.schema.messages.get(link.proto)
    if [(f.number, f.name, f.wire_type, f.oneof) for f in found] != [
        (link.number, link.name, link.proto, table.envelope.oneof)
    ]:
        message = f"the oneof {table.envelope.oneof!r} of the envelope has no member `{member}`"
        help = f"add the member and link.proto in the envelope's repository, as `roverlink explain {RULE.id}` shows"
        also = [(field.span, "the member is here") for field in found]
        yield RULE.at(link.at("number"), message, help, also, type=table.envelope.message, number=link.number)
    elif declared is not None and declared.on_the_wire().fields != LINK_FIELDS:
        message = f"the message {link.proto} has other fields than the link message"
        help = f"give it the fields that `roverlink explain {RULE.id}` shows"
        yield RULE.at(declared.span, message, help, type=table.envelope.message, number=link.number)
