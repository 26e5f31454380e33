"""ROS 2 at both ends of a link that loses datagrams: each message has the same values at the rover and at its peer."""

from __future__ import annotations

import copy
import dataclasses
import socket
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from random import Random
from typing import Any

import pytest
from both_ends import BothEnds, copied_keys
from payloads import random_payload
from polling import wait_until

from generated.registry import REGISTRY
from roverlink.runtime import ConversionError, Qos, SetupError
from roverlink.runtime.bridge.bridge import NODE
from roverlink.runtime.core import cdr
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware
from roverlink.runtime.text.values import message_to_values

_DEEP = Qos(depth=100)
_VALUES = 3
Comes = list[tuple[str, dict[str, Any]]]


def _quiet(handler: Any) -> Any:
    made = copy.copy(handler)
    made.route = dataclasses.replace(handler.route, deadman=None)
    return made


_QUIET = dataclasses.replace(REGISTRY, handlers=tuple(map(_quiet, REGISTRY.handlers)))


class _Judge:
    """A node over DDS that hears what both bridges publish, and publishes what they take; and the boards."""

    def __init__(self, node: Middleware, board: socket.socket, ends: BothEnds) -> None:
        self._node, self._board, self._ends = node, board, ends
        both = (("rover", ends.registry), ("base", ends.mirror))
        self._published = {
            f"/{where}/{one.route.topic}": one
            for where, registry in both
            for one in (*registry.handlers, *registry.extra_topics)
            if one.route.inbound
        }
        self.heard: dict[str, list[dict[str, Any]]] = {topic: [] for topic in self._published}
        for topic, one in self._published.items():
            node.subscribe(topic, one.message_type, _DEEP, self._taker(self.heard[topic], one.message_type))

    @staticmethod
    def _taker(heard: list[dict[str, Any]], message_type: Any) -> Callable[[Sequence[bytes]], None]:
        return lambda messages: heard.extend(_values(cdr.decode(message_type, message)) for message in messages)

    def say(self, topic: Any, random: Random) -> tuple[Callable[[], object], Comes]:
        """Return a function that says a random payload where it comes from, and where it then has to come."""
        route, payload = topic.route, random_payload(topic.payload_type, random)
        message = topic.to_cdr(payload)
        if route.peer == self._ends.base_end.peer:
            payload = topic.from_cdr(message)
            name = f"/{'base' if route.inbound else 'rover'}/{route.topic}"
            publish = self._node.publisher(name, topic.message_type, _DEEP).publish
            return lambda: publish([message]), [*self._comes(route.name, payload)]
        datagram, bridge = REGISTRY.datagram(route.name, payload), ("127.0.0.1", self._ends.rover.port)
        return lambda: self._board.sendto(datagram, bridge), [*self._comes(route.name, payload)]

    def _comes(self, row: str, payload: Any) -> Iterator[tuple[str, dict[str, Any]]]:
        for name, one in self._published.items():
            if one.route.name == row:
                yield name, _values(one.to_ros(payload))


def _opening(middleware: str, namespace: str) -> Callable[[str], Middleware]:
    return lambda name: open_middleware(middleware, NodeIdentity(NODE, namespace.format(name)))


def _values(message: Any) -> dict[str, Any]:
    values: dict[str, Any] = message_to_values(message)
    values.get("header", {}).pop("stamp", None)  # each end has its own clock
    return values


@pytest.mark.slow
@pytest.mark.parametrize("native", [True, False])
@pytest.mark.parametrize(("peer", "signs"), [("basestation", False), ("basestation", True), ("hardware", False)])
def test_every_row_has_the_same_values_at_both_ends(
    installed: str, peer: str, signs: bool, native: bool, tmp_path: Path
) -> None:
    """Rows to the peer, from it and forwarded to it, and extra topics: all that is sent comes; nothing else does."""
    random, registry = Random(41), _QUIET  # noqa: S311  # repeatable, not secret
    if signs:
        peers = tuple(dataclasses.replace(one, must_sign=one.name == peer) for one in _QUIET.peers)
        registry = dataclasses.replace(_QUIET, signature=23, peers=peers)
    links = copied_keys(tmp_path, peer)
    ends = BothEnds(registry, _opening(installed, "/{}"), EndName(peer), links=links, loss=0.3, native_core=native)
    wanted: defaultdict[str, list[dict[str, Any]]] = defaultdict(list)
    with open_middleware("dds", NodeIdentity("judge")) as node, socket.socket(type=socket.SOCK_DGRAM) as board, ends:
        assert ["native core handles" in bridge.way for bridge in ends.bridges] == [native] * 2
        judge = _Judge(node, board, ends)
        for topic in (*_QUIET.handlers, *_QUIET.extra_topics):
            is_own, is_row = topic.route.peer == peer, topic in _QUIET.handlers
            for _ in range(_VALUES if topic.route.name in ends.mirror.by_name and (is_own or is_row) else 0):
                with suppress(ConversionError):  # gps/fix does not determine a payload
                    say, comes = judge.say(topic, random)
                    for name, values in comes:
                        wanted[name].append(values)

                    def has_come(say: Any = say, comes: Comes = comes) -> bool:
                        say()
                        return all(values in judge.heard[name] for name, values in comes)

                    wait_until(has_come, f"{topic.route.topic} at both ends")
        for name, heard in judge.heard.items():
            assert [values for values in heard if values not in wanted[name]] == [], name
            assert heard or name.removeprefix("/rover/") in ("control_mode", "object_selection", "rock_measure_request")
        ends.settle()
        assert ends.to_base.handed_on < ends.to_base.taken
        assert ends.to_rover.handed_on < ends.to_rover.taken


def test_a_bridge_in_the_graph_of_the_rovers_bridge_ends(installed: str) -> None:
    """Otherwise each command would go round for ever."""
    named = pytest.raises(SetupError, match="the bridge /udp_forwarder publishes /control_mode, which this")
    with BothEnds(REGISTRY, _opening(installed, "/"), topic="/{}") as ends, named:
        ends.base.run()
