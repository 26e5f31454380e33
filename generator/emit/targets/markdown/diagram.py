"""Content of the diagram in docs/messages.md.

Senders are on the left, receivers on the right, and groups of rows between them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from roverlink.generator import ir

_SHOWN = 12  # rows of a group; more would make the diagram too high


@dataclass(frozen=True, slots=True)
class End:
    """Sender or receiver in the diagram: a board, a whole peer, or ROS 2."""

    id: str
    label: str


@dataclass(frozen=True, slots=True)
class Group:
    """Rows with the same sender and the same receivers."""

    id: str
    rows: tuple[ir.Route, ...]
    """Rows that the diagram shows; the others are only counted in `more`."""
    more: int
    """Number of further rows in the group, which the diagram does not show."""
    sender: End
    receiver: End
    """Box of the diagram for all receivers of the rows. Forwarded rows get one box, because several arrows would cross.
    """


@dataclass(frozen=True, slots=True)
class Diagram:
    """Content of the diagram from left to right."""

    senders: tuple[End, ...]
    groups: tuple[Group, ...]
    receivers: tuple[End, ...]


def diagram(bridge: ir.Bridge) -> Diagram:
    """Return the diagram. Rows with the same sender and receivers share a group, so that the diagram has few arrows."""
    grouped: dict[tuple[bool, End, tuple[str, ...]], list[ir.Route]] = {}
    for route in sorted(bridge.routes, key=lambda route: not route.inbound):
        end = _end(route)
        grouped.setdefault((route.inbound, end, route.forward), []).append(route)
    groups = []
    for index, ((inbound, end, forward), rows) in enumerate(grouped.items()):
        sender, receiver = (end, _forwarded(_ROS, forward)) if inbound else (_ROS, end)
        ends = _as("from", sender), _as("to", receiver)
        groups.append(Group(f"rows_{index}", tuple(rows[:_SHOWN]), max(0, len(rows) - _SHOWN), *ends))
    senders = dict.fromkeys(group.sender for group in groups)
    return Diagram(tuple(senders), tuple(groups), tuple(dict.fromkeys(group.receiver for group in groups)))


_ROS = End("ros", "ROS 2")


def _forwarded(end: End, forward: tuple[str, ...]) -> End:
    if not forward:
        return end
    return End("_".join((end.id, *forward)), f"{end.label}<br>forwarded to {', '.join(forward)}")


def _as(role: str, end: End) -> End:
    return End(f"{role}_{end.id}", end.label)


def _end(route: ir.Route) -> End:
    """Return the diagram's box for the peer's end of a row: its board, or the whole peer if the row has no board."""
    peer = route.peer
    if not route.board:
        return End(peer, peer)
    return End(f"{peer}_{re.sub(r'[^A-Za-z0-9]', '_', route.board)}", f"{peer}: {route.board}")
