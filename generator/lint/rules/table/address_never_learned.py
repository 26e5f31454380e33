"""The host of a peer or a board is `learn`, but the bridge cannot learn its address.

`learn` stands for the source of the last valid datagram. So a row must come from the peer or the board, and `learn`
must be its only host.

Bad::

    peers:
      hardware: {host: [learn, 192.168.0.21]}
    messages:
      - {number: 9, name: imu, proto: Imu, topic: imu, direction: hardware_to_ros}

Good::

    peers:
      hardware: {host: learn}
    messages:
      - {number: 9, name: imu, proto: Imu, topic: imu, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.table import LEARN

RULE = Rule("TAB118", "address-never-learned", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each peer or board whose address is to be learned, but never can be."""
    table = context.table
    speaking = {(row.peer, table.board_of(row)) for row in table.rows if row.inbound}
    speaking |= {(peer, "") for peer, _ in speaking}
    for peer in table.peers:
        for settings, end in peer.ends:
            if LEARN not in settings.hosts:
                continue
            if len(settings.hosts) > 1:
                message = f"{LEARN!r} stands beside other hosts of {end.name!r}"
                yield RULE.at(settings.at("host"), message, f"write `host: {LEARN}`, or list only other hosts")
            elif table.whole and (peer.name, end.name if peer.boards else "") not in speaking:
                message = f"no row comes from {end.name!r}, so its address is never learned"
                yield RULE.at(settings.at("host"), message, "write its address or name as `host`")
