"""A row speaks of a peer that the table does not have, or forwards where it cannot.

`direction` and `forward` name machines under `peers`; the datagrams of any other would go nowhere. A row forwarding to
the peer from which it comes would send every datagram back.

Bad::

    peers:
      hardware: {}
    messages:
      - {number: 16, name: mode, proto: ControlMode, topic: mode, direction: basestation_to_ros}

Good::

    peers:
      hardware: {}
      basestation: {}
    messages:
      - {number: 16, name: mode, proto: ControlMode, topic: mode, direction: basestation_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.context import Subject
from generator.diagnostics import Diagnostic, Rule, nearest
from generator.table import Row

RULE = Rule("TAB103", "unknown-peer")


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Directions and forwards without a peer."""
    table = subject.table
    if not table.whole:
        return  # the peer may be among what could not be read
    peers = {peer.name for peer in table.peers}
    for row in table.rows:
        for key, message, help in (*_unknown(row, peers), *_misdirected(row)):
            yield RULE.at(row.at(key), message, help, type=table.envelope.message, number=row.number)


_Fault = tuple[str, str, str]  # the key of the row where it stands, what is wrong, the cure


def _unknown(row: Row, peers: set[str]) -> Iterator[_Fault]:
    known = f"there are {', '.join(sorted(peers))}" if peers else "name the peers under `peers`"
    if row.direction and row.peer not in peers:
        message = f"{row.name} goes {row.direction}, but there is no peer {row.peer!r}"
        yield "direction", message, nearest(row.peer, peers, known)
    for target in row.forward:
        if target not in peers:
            message = f"{row.name} forwards to {target!r}, which is no peer"
            yield f"forward.{target}", message, nearest(target, peers, known)


def _misdirected(row: Row) -> Iterator[_Fault]:
    if row.forward and not row.inbound:
        message = f"{row.name} goes {row.direction}: there is no datagram to forward"
        yield "forward", message, "remove `forward`"
    elif row.peer in row.forward:
        message = f"{row.name} comes from {row.peer} and would be sent back to it"
        yield f"forward.{row.peer}", message, "forward to another peer"
