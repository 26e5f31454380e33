"""The `board` of a row is not a board of the row's peer.

The boards of a peer are those under its `boards`, and its `prefixes` if there are several. For another name, the bridge
has no address, and diagnostics would show a board that does not exist.

Bad::

    peers:
      hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
    messages:
      - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware, board: ArmBord}

Good::

    peers:
      hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
    messages:
      - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware, board: ArmBoard}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, nearest
from roverlink.generator.lint.context import Context

RULE = Rule("TAB116", "unknown-board", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row whose `board` is unknown."""
    table = context.table
    if not table.whole:
        return  # the board may be in a part that could not be read
    peers = table.peers_by_name()
    for row in table.rows:
        known = peers[row.peer].board_names if row.peer in peers else ()
        if row.board and row.peer in peers and row.board not in known:
            message = f"unknown board {row.board!r} of the peer {row.peer!r} (known: {', '.join(known) or 'none'})"
            help = nearest(row.board, known, f"add the board under `boards` of the peer {row.peer!r}")
            yield RULE.at(row.at("board"), message, help, type=table.envelope.message, number=row.number)
