"""Principals: who has sent a datagram, as far as that is proven, and for which ends of the link this sender may speak.

A link message does not name its sender. These rules tell who may have sent it:

- A signature proves its signer. A board speaks for itself alone. A peer also speaks for its boards, because boards
  without a key of their own sign with the key of their peer.
- A sender without a signature may be any end that need not sign.
- If the table has ``sources``, a sender speaks only for the peers that have its address.

The rows that the message lists say which of these ends it is: the board or the peer that sends or receives all of them,
or to which they are forwarded. If several ends fit, the one that has most of the rows itself is the sender. A program
that speaks the rows of several boards is the whole peer.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from collections.abc import Set as AbstractSet
from typing import NamedTuple

from roverlink.runtime.core import link_message
from roverlink.runtime.core.registry import EndName, Registry


class Principal(NamedTuple):
    """Sender of a datagram, as far as it is proven."""

    signer: EndName | None
    """End that has signed the datagram; None if nobody has."""
    ends: tuple[EndName, ...]
    """Ends for which the sender may speak. A peer comes after its boards."""


class EndRows:
    """Rows of all ends of the link, by the rows' names. A peer comes after its boards."""

    def __init__(self, registry: Registry) -> None:
        boards: dict[EndName, set[str]] = {end: set() for end in registry.ends if end.board}
        peers: dict[EndName, set[str]] = {EndName(peer.name): set() for peer in registry.peers}
        for handler in registry.handlers:
            route = handler.route
            peers[EndName(route.peer)].add(route.name)
            if route.board:
                boards.setdefault(EndName(route.peer, route.board), set()).add(route.name)
        self.own = boards | peers
        """Rows that each end sends or receives."""
        self.in_turn = {end: link_message.rows_in_turn(registry, end) for end in self.own}
        """Numbers of the rows that each end speaks, in the order in which its link messages tell them."""
        self.spoken = {end: {registry.by_number[n].route.name for n in rows} for end, rows in self.in_turn.items()}
        """Rows that each end speaks: its own, and those that are forwarded to it."""

    def fitting(self, rows: AbstractSet[str], ends: Sequence[EndName]) -> list[EndName]:
        """Return those of ``ends`` that speak all of ``rows``."""
        return [end for end in ends if rows <= self.spoken[end]]

    def end_of(self, rows: AbstractSet[str], principal: Principal) -> EndName | None:
        """Return the end for which a principal speaks that has told ``rows``; None if they do not tell it."""
        fitting = self.fitting(rows, principal.ends)
        if not rows and len(fitting) > 1:
            return None
        # `max` returns the first of several ends, and boards stand before their peer.
        return max(fitting, key=lambda end: len(rows & self.own[end]), default=None)


class Speakers:
    """Principals of the link messages of a table."""

    def __init__(self, registry: Registry, peers: frozenset[str] | None, must_sign: Collection[str] = ()) -> None:
        """Let the principals speak only for ``peers``; None is all peers. Those in ``must_sign`` need a signature."""
        self.rows = EndRows(registry)
        ends = [end for end in self.rows.own if peers is None or end.peer in peers]
        self.unsigned = Principal(None, tuple(end for end in ends if end.peer not in must_sign))
        """Principal of a link message without a signature."""
        self.signed = {
            signer.board
            or signer.peer: Principal(
                signer, tuple(end for end in ends if end.peer == signer.peer and signer.board in ("", end.board))
            )
            for signer in self.rows.own
        }
        """Principal of each peer and board that may have a key, by the name in its key file."""

    def may_speak(self, principal: Principal, rows: AbstractSet[str]) -> bool:
        """Return true if one of the principal's ends speaks all of ``rows``."""
        return bool(self.rows.fitting(rows, principal.ends))
