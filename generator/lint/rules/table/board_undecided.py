"""A row sends to a peer that has boards with addresses, but nothing tells to which board.

A row goes to the board whose name begins the name of its message. Messages with another name need the key `board` in
the row. Without a board, the bridge has no address for the row's datagrams.

Bad::

    peers:
      hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
    messages:
      - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware}

Good::

    peers:
      hardware: {boards: {ArmBoard: {host: 192.168.0.21}}}
    messages:
      - {number: 9, name: motor, proto: Motor, topic: motor, direction: ros_to_hardware, board: ArmBoard}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context

RULE = Rule("TAB115", "board-undecided", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row to a peer with boards that has no board with an address."""
    table = context.table
    if not table.whole:
        return  # the board may be in a part that could not be read
    peers = table.peers_by_name()
    for row in table.rows:
        peer, board = peers.get(row.peer), table.board_of(row)
        boards = [one.name for one in peer.boards] if peer else []
        # A board that the row names, and that does not exist, is reported by unknown-board.
        if row.inbound or not boards or board in boards or row.board not in ("", *(peer.board_names if peer else ())):
            continue
        message = f"nothing tells to which board of the peer {row.peer!r} the row {row.name!r} goes"
        help = f"write `board:` with one of {', '.join(boards)} in the row"
        if board:
            message = f"{row.name!r} goes to the board {board!r} of the peer {row.peer!r}, which has no address"
            help = f"add {board!r} with its `host` to `boards` of the peer {row.peer!r}, or {help}"
        span, envelope = row.at("board" if row.board else "proto"), table.envelope.message
        yield RULE.at(span, message, help, type=envelope, number=row.number)
