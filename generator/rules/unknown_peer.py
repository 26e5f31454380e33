"""A row speaks of a peer that the table does not have.

`direction` and `forward` name machines under `peers`; a row forwarding to the peer from which it comes would send
every datagram back.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.findings import Finding, Rule, nearest
from generator.subject import Subject
from generator.table import Row

RULE = Rule("TAB103", "unknown-peer")


def check(subject: Subject) -> Iterator[Finding]:
    """Directions and forwards without a peer."""
    peers = {peer.name for peer in subject.table.peers}
    known = f"there are {', '.join(sorted(peers))}" if peers else "name the peers under `peers`"
    if not subject.table.whole:
        return  # the peer may be among what could not be read
    for row in subject.table.rows:
        if row.peer not in peers:
            help = nearest(row.peer, peers, known)
            message = f"{row.name} goes {row.direction}, but there is no peer {row.peer!r}"
            yield RULE.at(row.at("direction"), message, help)
        for target in row.forward:
            if target not in peers:
                help = nearest(target, peers, known)
                yield RULE.at(row.at(f"forward.{target}"), f"{row.name} forwards to {target!r}, which is no peer", help)
        yield from _check_forward(row)


def _check_forward(row: Row) -> Iterator[Finding]:
    if row.forward and not row.inbound:
        message = f"{row.name} goes {row.direction}: there is no datagram to forward"
        yield RULE.at(row.at("forward"), message, "remove `forward`")
    elif row.peer in row.forward:
        message = f"{row.name} comes from {row.peer} and would be sent back to it"
        yield RULE.at(row.at(f"forward.{row.peer}"), message, "forward to another peer")
