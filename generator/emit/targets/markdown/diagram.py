"""Diagram of senders and receivers: groups of rows, from senders on the left to receivers on the right."""

from __future__ import annotations

import re
from dataclasses import dataclass

from roverlink.generator import ir

_SHOWN = 12  # rows of a group; more would make the diagram too high


@dataclass(frozen=True, slots=True)
class End:
    """Board, peer or ROS 2, as a sender or as a receiver."""

    id: str
    label: str


@dataclass(frozen=True, slots=True)
class Group:
    """Rows with the same sender and the same receivers."""

    id: str
    rows: tuple[ir.Route, ...]
    """Rows that are shown."""
    more: int
    """Number of rows that are not shown."""
    sender: End
    receiver: End
    """Receiver. All receivers of forwarded rows are one `End`, because arrows to each of them would cross."""


@dataclass(frozen=True, slots=True)
class Diagram:
    """Content of the diagram."""

    senders: tuple[End, ...]
    groups: tuple[Group, ...]
    receivers: tuple[End, ...]


def peer_of(route: ir.Route) -> str:
    """Return the peer of a row."""
    return route.direction.removesuffix("_to_ros") if route.inbound else route.direction.removeprefix("ros_to_")


def diagram(bridge: ir.Bridge) -> Diagram:
    """Group the rows, so that the diagram has a few arrows instead of one for each row."""
    peers = {peer.name: peer for peer in bridge.peers}
    grouped: dict[tuple[bool, End, tuple[str, ...]], list[ir.Route]] = {}
    for route in sorted(bridge.routes, key=lambda route: not route.inbound):
        end = _end(peers[peer_of(route)], route)
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


def _end(peer: ir.Peer, route: ir.Route) -> End:
    """Return the board of a row, or the peer if it does not consist of several boards."""
    name = route.proto.rpartition(".")[2]
    prefix = next((prefix for prefix in peer.prefixes if name.startswith(prefix)), "")
    if len(peer.prefixes) < 2 or not prefix:
        return _whole(peer.name)
    return End(f"{peer.name}_{re.sub(r'[^A-Za-z0-9]', '_', prefix)}", f"{peer.name}: {prefix}")


def _whole(peer: str) -> End:
    return End(peer, peer)
