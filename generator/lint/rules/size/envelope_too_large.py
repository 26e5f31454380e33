"""An envelope can become larger than a peer accepts.

A peer with `max_size` has a buffer of that many bytes, and cuts off or drops a larger datagram. This happens only if
the values are long, so a short test often does not show it.

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
from roverlink.generator.ir import largest_link_size
from roverlink.generator.lint.context import Context
from roverlink.generator.nanopb import Bounds, envelope_size, field_sizes, largest_size
from roverlink.generator.protos.schema import Schema
from roverlink.generator.table import Row

RULE = Rule("FIX102", "envelope-too-large", __doc__)
_HELP = "lower a limit in the .options file, split the message, or raise `max_size` if the peer has the memory"


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row whose largest envelope exceeds the `max_size` of its sender or receiver."""
    table, schema, bounds = context.table, context.schema, context.bounds
    if schema is None or bounds is None:
        return
    peers = table.peers_by_name()
    for row in table.rows:
        payload = largest_size(schema, bounds, row.proto) if row.proto in schema.messages else None
        if not isinstance(payload, int):
            continue  # FIX101 reports a payload without a bound
        size = envelope_size(schema, bounds, table.envelope.message, row.number, payload)
        for peer in (peers[name] for name in (row.peer, *row.forward) if name in peers):
            if peer.max_size is not None and size > peer.max_size:
                largest = _largest_fields(row, schema, bounds)
                message = f"envelopes with {row.name!r} have up to {size} bytes"
                message = f"{message}; the peer {peer.name!r} accepts at most {peer.max_size}"
                also = [(peer.at("max_size"), "the limit is here")]
                envelope = table.envelope.message
                text = f"{message}; {largest}"
                yield RULE.at(row.at("proto"), text, _HELP, also, type=envelope, number=row.number)
    if link := table.link:
        size = envelope_size(schema, bounds, table.envelope.message, link.number, largest_link_size())
        for peer in table.peers:
            if peer.max_size is not None and size > peer.max_size:
                message = f"the link message has up to {size} bytes; the peer {peer.name!r} accepts at most"
                help = "raise `max_size` if the peer has the memory, or remove `link`"
                also = [(peer.at("max_size"), "the limit is here")]
                yield RULE.at(
                    table.at("link"),
                    f"{message} {peer.max_size}",
                    help,
                    also,
                    type=table.envelope.message,
                    number=link.number,
                )


def _largest_fields(row: Row, schema: Schema, bounds: Bounds) -> str:
    first, *more = field_sizes(schema, bounds, row.proto)[:3] or [("nothing", 0)]
    return ", ".join(
        [f"the largest parts are {first[0]!r} ({first[1]} bytes)", *(f"{name!r} ({size})" for name, size in more)]
    )
