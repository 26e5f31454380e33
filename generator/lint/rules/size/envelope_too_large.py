"""An envelope can become larger than the peer takes.

A peer with `max_size` has a buffer of that many bytes. A datagram that is larger is cut off or thrown away there, and
only when the values happen to be long: on the field, not on the desk.

Bad::

    peers:
      board: {max_size: 32}
    # note.options
    Note.text max_length:40

Good::

    # note.options
    Note.text max_length:20
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.nanopb import Bounds, envelope_size, field_sizes, largest_size
from roverlink.generator.protos.schema import Schema
from roverlink.generator.table import Row

RULE = Rule("FIX102", "envelope-too-large", __doc__)
_HELP = "lower a bound in the .options file, split the message, or raise max_size if the peer has the memory"


def check(context: Context) -> Iterator[Diagnostic]:
    """Rows whose largest envelope exceeds what a peer takes that sends it or is sent it."""
    table, schema, bounds = context.table, context.schema, context.bounds
    if schema is None or bounds is None:
        return
    peers = table.peers_by_name()
    for row in table.rows:
        payload = largest_size(schema, bounds, row.proto) if row.proto in schema.messages else None
        if not isinstance(payload, int):
            continue  # one without a bound is a fault of its own
        size = envelope_size(schema, bounds, table.envelope.message, row.number, payload)
        for peer in (peers[name] for name in (row.peer, *row.forward) if name in peers):
            if peer.max_size is not None and size > peer.max_size:
                largest = _largest_fields(row, schema, bounds)
                message = f"{row.name} makes an envelope of up to {size} bytes, {peer.name} takes {peer.max_size}"
                also = [(peer.at("max_size"), "said here")]
                envelope = table.envelope.message
                text = f"{message}; {largest}"
                yield RULE.at(row.at("proto"), text, _HELP, also, type=envelope, number=row.number)


def _largest_fields(row: Row, schema: Schema, bounds: Bounds) -> str:
    first, *more = field_sizes(schema, bounds, row.proto)[:3] or [("nothing", 0)]
    return ", ".join([f"most of it is {first[0]} ({first[1]} bytes)", *(f"{name} ({size})" for name, size in more)])
