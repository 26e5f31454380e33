"""Mirrored registry: the table as a peer sees it, for a bridge that is this peer, with ROS 2 at both ends of the link.

What the peer sends goes from topics to the rover. What the peer receives, forwarded rows included, comes from the rover
and goes to topics, extra topics included. Rows of other peers are left out.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from roverlink.runtime.core import link_message
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.core.handler import Handler
from roverlink.runtime.core.registry import EndName, OwnEnd, Peer, Registry

ROVER = "rover"
"""Name of the only peer of a mirrored registry: the bridge at the other end."""

H = TypeVar("H", bound=Handler)  # type: ignore[type-arg]  # of any payload and message


def mirrored(registry: Registry, end: EndName, port: int) -> Registry:
    """Return the registry of a bridge that is the peer or board ``end``.

    ``port`` is the UDP port on which the rover's bridge listens, if the parameter is not given. Raises `SetupError` if
    the peer has boards with addresses of their own, which one bridge cannot all be.
    """
    peer = registry.peers_by_name[end.peer]
    if peer.boards and not end.board:
        boards = ", ".join(board.name for board in peer.boards)
        raise SetupError(f"the boards of {end.peer} have addresses of their own; name one of them: {boards}")
    # In this order the link messages tell the rows, and the first ones have to tell who we are.
    numbers = link_message.rows_in_turn(registry, end)
    handlers = tuple(_mirrored(registry.by_number[number], end) for number in numbers)
    names = {handler.route.name for handler in handlers}
    return replace(
        registry,
        peers=(Peer(ROVER, f"{ROVER}_port", port, must_sign=peer.must_sign),),
        handlers=handlers,
        extra_topics=tuple(_mirrored(one, end) for one in registry.extra_topics if one.route.name in names),
        link=registry.link and replace(registry.link, hashes={one: registry.link.hashes[one] for one in numbers}),
        own=OwnEnd(
            end, registry.ends.get(end, peer).port, tuple(name for name in registry.by_name if name not in names)
        ),
    )


def _mirrored(handler: H, end: EndName) -> H:
    """Return a handler of the same messages for the mirrored row."""
    kind, route = type(handler), handler.route
    is_ours = route.peer == end.peer and end.board in ("", route.board)
    mirror = replace(
        route,
        direction=f"ros_to_{ROVER}" if is_ours and route.inbound else f"{ROVER}_to_ros",
        forward=(),
        forward_limits=(),
        send=None,
        deadman=None,  # the rover sends the stop itself
        # The rover limits what it sends. A second limit would only delay what the link's jitter has pushed together.
        max_rate=None if is_ours and not route.inbound else route.max_rate,
        board="",
        request=route.request if is_ours else None,  # a forwarded one is answered on the rover
    )
    # The native core finds the package by the module. The link to the rover does not measure the clock of a board.
    members = {"route": mirror, "__module__": kind.__module__, "board_stamp": None}
    made: H = type(kind.__name__, (kind,), members)()
    return made


def end_named(registry: Registry, name: str) -> EndName:
    """Return the peer or board of a name. Raises `SetupError` if the table has none."""
    ends = {board: EndName(peer.name, board) for peer in registry.peers for board in registry.boards_of(peer.name)}
    ends |= {peer.name: EndName(peer.name) for peer in registry.peers}
    if name not in ends:
        raise SetupError(f"unknown peer or board {name!r}; {nearest(name, sorted(ends))}")
    return ends[name]
