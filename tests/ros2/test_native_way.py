"""The native core as the bridge uses it, beside Python's way: the same arrives, and the same is counted."""

from __future__ import annotations

import copy
import ctypes
import dataclasses
import logging
import socket
from collections import Counter, defaultdict
from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any

import pytest
from needs import NO_DDS, NO_RCLPY, needs_native
from polling import wait_until

from generated.interfaces.geometry_msgs import Point, Pose, PoseWithCovariance
from generated.interfaces.nav_msgs import Odometry
from generated.messages import DrivingBoardMotorMessage
from generated.registry import REGISTRY
from roverlink.runtime import Bridge, Qos
from roverlink.runtime.bridge.bridge import Send
from roverlink.runtime.bridge.handling_times import Handle
from roverlink.runtime.core import cdr
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.middleware.tapping import TappedMiddleware
from roverlink.runtime.ros_arguments import parameters

pytestmark = needs_native

_INBOUND = [handler for handler in REGISTRY.handlers if handler.route.inbound]
_OUTBOUND = [handler for handler in (*REGISTRY.handlers, *REGISTRY.extra_topics) if not handler.route.inbound]
_EXTRA = "pressure/temperature"
_COMMANDS = 5  # on each topic


def _envelope(**payloads: Any) -> bytes:
    return bytes(REGISTRY.envelope(**payloads).SerializeToString())


_PRESSURES = [_envelope(pressure_info={"temperature_c": 20.5 + number}) for number in range(20)]
_DATAGRAMS = [
    *(_envelope(**{handler.route.name: {}}) for handler in _INBOUND),
    *_PRESSURES,
    b"",
    b"\xff",
    _envelope(drive_motor={}),
    _envelope(imu_info={})[:1],
    _PRESSURES[0] + bytes(3),
    _PRESSURES[0] + b"\xf8\x07\x01",  # and field 127, which nobody knows
    _PRESSURES[0] + _envelope(ph_info={}),
    b"\xda\x07\x00",  # payload 123 of no row
    _PRESSURES[0] + bytes(3000),
]
_N_PRESSURES = len(_PRESSURES) + 3  # an empty one, one with zeros, and one with an unknown field


@pytest.fixture(autouse=True)
def _installed(middleware: str, environment: dict[str, str]) -> None:
    """Skip the middlewares that are not installed."""
    package, reason = {"dds": ("cyclonedds", NO_DDS), "rclpy": ("rclpy", NO_RCLPY)}[middleware]
    if not find_spec(package):
        pytest.skip(reason)


def _without_deadman(handler: Any) -> Any:
    made = copy.copy(handler)
    made.route = dataclasses.replace(handler.route, deadman=None)
    return made


# Without the stops that a bridge sends by itself, after some time.
_QUIET = dataclasses.replace(REGISTRY, handlers=tuple(map(_without_deadman, REGISTRY.handlers)))
_LEARN = {"host": "learn", "host_parameter": "hardware_host"}


class _Observer:
    """Keeps the end of each message, whose beginning may have a stamp; and each datagram, one sent by its beginning."""

    def __init__(self) -> None:
        self.seen: defaultdict[str, list[bytes]] = defaultdict(list)
        self.received = self._tap("received", 0)
        self.sent = {peer: self._tap(f"sent to {peer}", 0, 3) for peer in REGISTRY.peers_by_name}

    def _tap(self, name: str, start: int, kind: int = 0) -> Tap:
        def tap(messages: Sequence[bytes], arrived: object = ()) -> None:
            for message in messages:
                self.seen[name + message[:kind].hex()].append(message[start:])

        return tap

    def topic(self, topic: str, *_: object) -> Tap:
        return self._tap(topic, -16)

    def receiving(self, handle: Handle) -> Handle:
        return lambda batch: (self.received(batch), handle(batch))[1]

    def sending(self, peer: str, send: Send) -> Send:
        return lambda datagrams: (self.sent[peer](datagrams), send(datagrams))[1]


def _numbered(kind: Any, number: int) -> dict[str, Any]:
    """Different values, of which the last does not fit into the payload."""
    if kind is Odometry:
        return {"pose": PoseWithCovariance(Pose(Point(1e300 if number == _COMMANDS - 1 else number)))}
    return {"distance_to_go": float(number)} if kind is DrivingBoardMotorMessage else {}


def _waiting(sock: socket.socket, count: int) -> list[bytes]:
    sock.settimeout(30)
    return sorted(sock.recv(65_536) for _ in range(count))


def _bridged(
    middleware: str,
    native: bool,
    policy: str,
    guarded: bool,
    observers: Sequence[_Observer],
) -> Sequence[Any]:
    """What arrives on two topics and at both peers, and what is counted."""
    peers = {name: socket.socket(type=socket.SOCK_DGRAM) for name in ("hardware", "basestation")}
    ports = {"hardware": "dst_b_port", "basestation": "dst_a_port"}
    for sock in peers.values():
        sock.bind(("127.0.0.1", 0))
    given = {ports[name]: sock.getsockname()[1] for name, sock in peers.items()}
    given |= {"listen_port": 0, "listen_address": "127.0.0.1", "native_core": native, "forward_policy": policy}
    registry = _QUIET
    if guarded:
        guards = [dataclasses.replace(peer, sources=("127.0.0.0/8",)) for peer in REGISTRY.peers]
        guards = [dataclasses.replace(one, **(_LEARN if one.name == "hardware" else {})) for one in guards]
        registry = dataclasses.replace(_QUIET, peers=tuple(guards))
        given["dst_b_port"] = 0
    settings = parameters.read(registry, given)
    arrived: dict[str, list[bytes]] = {"pressure_info": [], _EXTRA: []}
    types = {handler.route.topic: handler.message_type for handler in (*REGISTRY.handlers, *REGISTRY.extra_topics)}
    with open_middleware("dds", NodeIdentity("observer")) as observer:
        node = open_middleware(middleware, NodeIdentity("bridge"))
        tapped = node
        for one in observers:
            tapped = TappedMiddleware(tapped, one)
        logger = logging.getLogger("native_way")
        bridge = Bridge(registry, settings, tapped, lambda topic: f"/{topic}", logger, observers)
        with bridge:
            for topic, messages in arrived.items():
                observer.subscribe(f"/{topic}", types[topic], Qos(depth=100), messages.extend)
            commands = {
                one: observer.publisher(f"/{one.route.topic}", one.message_type, Qos(depth=100)) for one in _OUTBOUND
            }
            for topic in arrived:
                wait_until(lambda topic=topic: node.endpoints(f"/{topic}", publishing=False), topic)  # type: ignore[misc]
            wait_until(lambda: all(command.has_subscribers() for command in commands.values()), "the bridge")
            board = peers["hardware"]
            for count, datagram in enumerate(_DATAGRAMS, 1):
                board.sendto(datagram, ("127.0.0.1", bridge.port))
                wait_until(lambda count=count: bridge.account.received >= count, f"{count} datagrams")  # type: ignore[misc]
            for number in range(_COMMANDS):
                for handler, command in commands.items():
                    command.publish([cdr.encode(handler.message_type(**_numbered(handler.message_type, number)))])
            wait_until(lambda: bridge.account.sent.total() == _COMMANDS * len(commands) - 1, "the commands")
            wait_until(lambda: bridge.account.refused.total() == 1, "the command that does not fit")
            wait_until(lambda: all(len(found) == _N_PRESSURES for found in arrived.values()), "all pressures")
            counted = bridge.account.as_dict()
            sent = Counter(bridge.account.forwarded)
            for name, count in bridge.account.sent.items():
                sent[REGISTRY.by_name[name].route.peer] += count
            forwarded = {name: _waiting(peers[name], count) for name, count in sent.items()}
            bridge.stop()
            bridge.run()
    for sock in peers.values():
        sock.close()
    assert not bridge.account.discrepancies()
    assert bridge.way.startswith("the native core handles all") == native, bridge.way
    return counted, {topic: [message[-16:] for message in messages] for topic, messages in arrived.items()}, forwarded


@pytest.mark.parametrize(
    ("policy", "guarded", "observed"),
    [("mapping", False, False), ("all", False, False), ("mapping", True, False), ("mapping", True, True)],
)
def test_both_ways_do_the_same(middleware: str, policy: str, guarded: bool, observed: bool) -> None:
    """Rows, extra topics, forwards and commands; datagrams that the core hands over; and what observers get.

    With a guard, only this computer may send, and the address of the hardware is learned.
    """
    observers = [[_Observer()] if observed else [] for _ in range(2)]
    found = [_bridged(middleware, native, policy, guarded, given) for native, given in zip((False, True), observers)]
    if observed:
        assert observers[0][0].seen == observers[1][0].seen
        assert len(observers[0][0].seen) > len(_INBOUND)
    for counted, _, _ in found:
        del counted["qos_mismatches"]  # of the moment
    assert found[0] == found[1]


@pytest.mark.parametrize("middleware", ["rclpy"])
def test_a_function_that_rcl_lacks_leaves_the_messages_to_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """The rest stays native, and the log says why."""
    absent, where = ctypes.CDLL(None), "roverlink.runtime.middleware.rcl_loop.rcl_function"
    monkeypatch.setattr(where, lambda name: getattr(absent, f"no_{name}"))
    settings = parameters.read(REGISTRY, {"listen_port": 0, "listen_address": "127.0.0.1"})
    node = open_middleware("rclpy", NodeIdentity("bridge"))
    with Bridge(REGISTRY, settings, node, lambda topic: f"/{topic}", logging.getLogger("native_way")) as bridge:
        assert "handles 15 of 21 messages" in bridge.way
        assert "undefined symbol: no_rcl_take_serialized_message: arm_ctrl, arm_target, drive_motor" in bridge.way
        bridge.stop()
        bridge.run()
