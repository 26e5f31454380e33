"""A peer has boards with addresses, and also an address of its own.

Each row goes to one of the boards, so nothing would be sent to the address of the peer. Only `port` has a meaning
beside `boards`: it is the port of the boards that have none.

Bad::

    peers:
      hardware: {host: 192.168.0.20, boards: {ArmBoard: {host: 192.168.0.21}}}

Good::

    peers:
      hardware: {port: 8, boards: {ArmBoard: {host: 192.168.0.21}}}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context

RULE = Rule("TAB119", "address-beside-boards", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each key with an address of a peer that has boards."""
    for peer in context.table.peers:
        for key in ("host", "interface", "ttl", "parameter"):
            if peer.boards and key in peer.spans:
                message = f"`{key}` of the peer {peer.name!r} has no effect, because the peer has `boards`"
                other = "; every board has parameters of its own" if key == "parameter" else ", or write it at a board"
                yield RULE.at(peer.at(key), message, f"remove `{key}`{other}")
