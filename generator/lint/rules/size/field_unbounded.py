"""A payload of a microcontroller has a field without a bound, which is the limit of its size.

A peer with `max_size` has fixed buffers. So nanopb's options beside the .proto file must limit the length of each
string and the count of each repeated field. Without a bound, nanopb cannot reserve memory for the field, and the
largest size of the envelope is unknown.

Bad::

    // note.proto
    message Note {
      string text = 1;
    }

Good::

    # note.options
    Note.text max_length:20
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.nanopb import Unbounded, largest_size
from roverlink.generator.table import PeerSettings, Row

RULE = Rule("FIX101", "field-unbounded", __doc__)
_HELP = "set max_length (string), max_size (bytes) or max_count (repeated) in a .options file beside the .proto file"


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each payload whose sender or receiver has a `max_size`, if a field has no size limit."""
    schema, bounds = context.schema, context.bounds
    if schema is None or bounds is None:
        return
    for proto, (row, peer) in _limited(context).items():
        found = largest_size(schema, bounds, proto) if proto in schema.messages else 0
        if isinstance(found, Unbounded):
            first, _, _ = found.path.partition(".")
            number = next((field.number for field in schema.messages[proto].fields if field.name == first), None)
            field = f"{proto}.{found.path}" if found.path else proto
            message = f"{field!r} has no largest size: {found.reason}"
            also = [(row.at("proto"), f"the peer {peer.name!r} accepts at most {peer.max_size} bytes")]
            yield RULE.at(found.span, message, _HELP, also, type=proto, number=number)


def _limited(context: Context) -> dict[str, tuple[Row, PeerSettings]]:
    """Return the payloads whose sender or receiver has a `max_size`, each with its first row and this peer."""
    peers = context.table.peers_by_name()
    found: dict[str, tuple[Row, PeerSettings]] = {}
    for row in context.table.rows:
        for name in (row.peer, *row.forward):
            if name in peers and peers[name].max_size is not None:
                found.setdefault(row.proto, (row, peers[name]))
    return found
