"""Principals: who has sent a datagram, as far as that is proven, and for which ends of the link this sender may speak.

A link message does not name its sender. These rules tell who may have sent it:

- A signature proves its signer. A board speaks for itself alone. A peer also speaks for its boards, because boards
  without a key of their own sign with the key of their peer.
- A sender without a signature may be any end that need not sign.
- If the table has ``sources``, a sender speaks only for the peers that have its address.
- What comes over the line of an end, such as a serial one, speaks for this end alone, and nothing else speaks for it.

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


class Origin(NamedTuple):
    """Origin of a datagram: an address that belongs to some peers, or the line of an end."""

    peers: frozenset[str]
    """Peers that have the address."""
    line: EndName | None = None
    """End whose line it is; None for a datagram from the network."""
    lines: frozenset[EndName] = frozenset()
    """Ends that have lines, so that nothing from the network speaks for them."""

    def may_carry(self, peer: str, board: str) -> bool:
        """Return true if a row of a board of a peer may have this origin; the board is empty if the row has none."""
        if self.line is not None:
            return self.line.peer == peer and (self.line.board in ("", board) or not board)
        return peer in self.peers and not self.lines & {EndName(peer), EndName(peer, board)}

    def may_be(self, end: EndName) -> bool:
        """Return true if a link message of an end may have this origin. A whole peer is all its boards."""
        if self.line is not None:
            return self.line.peer == end.peer and self.line.board in ("", end.board)
        return self.may_carry(*end) and bool(end.board or all(line.peer != end.peer for line in self.lines))

    def __str__(self) -> str:
        if self.line is not None:
            return f"the line of {self.line}"
        return "the network" if self.lines else f"an address of {', '.join(sorted(self.peers))}"


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

    def __init__(self, registry: Registry, origin: Origin | None, must_sign: Collection[str] = ()) -> None:
        """Let principals speak only for ends of ``origin``; None is all. Peers in ``must_sign`` need a signature."""
        self.rows = EndRows(registry)
        ends = [end for end in self.rows.own if origin is None or origin.may_be(end)]
        self.unsigned = Principal(None, tuple(end for end in ends if end.peer not in must_sign))
        """Principal of a link message without a signature."""
        self.signed = {
            signer.board or signer.peer: Principal(
                signer, tuple(end for end in ends if end.peer == signer.peer and signer.board in ("", end.board))
            )
            for signer in self.rows.own
        }
        """Principal of each peer and board that may have a key, by the name in its key file."""

    def may_speak(self, principal: Principal, rows: AbstractSet[str]) -> bool:
        """Return true if one of the principal's ends speaks all of ``rows``."""
        return bool(self.rows.fitting(rows, principal.ends))
