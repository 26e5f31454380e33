"""The native core as the bridge uses it, beside Python's way: the same arrives, and the same is counted."""

from __future__ import annotations

import contextlib
import copy
import ctypes
import dataclasses
import logging
import math
import re
import socket
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from google.protobuf.message import DecodeError
from needs import needs_native
from polling import PATIENCE_S, wait_until
from repeating import repeated

from generated.interfaces.geometry_msgs import Point, Pose, PoseWithCovariance
from generated.interfaces.nav_msgs import Odometry
from generated.messages import DrivingBoardMotorMessage
from generated.registry import REGISTRY
from roverlink.runtime import Bridge, Qos
from roverlink.runtime.bridge.account import Account
from roverlink.runtime.bridge.bridge import Send
from roverlink.runtime.bridge.handling_times import Handle
from roverlink.runtime.bridge.signed_peers import open_links
from roverlink.runtime.core import cdr
from roverlink.runtime.core.envelope import restore
from roverlink.runtime.core.errors import Reason
from roverlink.runtime.core.handler import UNSTAMPED, SendLimits
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.core.signing import TICKS_PER_SECOND, Key, Signer, SigningClock
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.keys.key_file import make_key_file
from roverlink.runtime.keys.signed_links import SignedLinks
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.middleware.tapping import TappedMiddleware
from roverlink.runtime.net.carrier import Carrier
from roverlink.runtime.net.transports import transport_at
from roverlink.runtime.ros_arguments import parameters

pytestmark = [needs_native, pytest.mark.usefixtures("installed")]

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


class _Case(NamedTuple):
    """What the table and the parameters say, and whether there is an observer."""

    policy: str = "mapping"
    guard: float = 0
    """If not 0, only this computer may send: 32 datagrams and then so many a second. And an address is learned."""
    observed: bool = False
    signed: bool = False
    strips: bool = False
    line: bool = False
    """If true, the hardware is behind TCP, and somebody else on the network sends its rows, too."""
    paced: bool = False
    """If true, one message of a row passes in ten days, on its topic and on its way to the basestation."""


def _handler(handler: Any, paced: bool) -> Any:
    made = copy.copy(handler)
    # Without the stops that a bridge sends by itself, after some time.
    is_slow = paced and handler.route.name in ("pressure_info", "arm_target")
    limits = (("basestation", SendLimits(max_rate=1e-6)),) if is_slow else ()  # type: ignore[arg-type]
    max_rate = 1e-6 if is_slow else None
    made.route = dataclasses.replace(handler.route, deadman=None, max_rate=max_rate, forward_limits=limits)
    return made


_LEARN = {"host": "learn", "host_parameter": "hardware_host"}
_NUMBER = 23
_SIGNATURE = 3 + 15  # bytes of the field
_LOGGER = logging.getLogger("native_way")


def _registry(case: _Case) -> Any:
    peers = []
    for peer in REGISTRY.peers:
        changes: dict[str, Any] = _LEARN if case.guard and peer.name == "hardware" else {}
        if case.guard:
            changes = {**changes, "sources": ("127.0.0.0/8",), "source_rate": case.guard}
        if case.line and peer.name == "hardware":
            changes = {"host": "tcp:127.0.0.1:9", "host_parameter": "hardware_host"}
        peers.append(dataclasses.replace(peer, must_sign=case.signed, strip_trailing_zeros=case.strips, **changes))
    handlers = tuple(_handler(handler, case.paced) for handler in REGISTRY.handlers)
    number = _NUMBER if case.signed else None
    return dataclasses.replace(REGISTRY, peers=tuple(peers), handlers=handlers, signature=number)


def _payload(datagram: bytes) -> str:
    """The name of the payload; empty if there is none, or if the bytes are no envelope."""
    with contextlib.suppress(DecodeError):
        return REGISTRY.envelope.FromString(datagram).WhichOneof("payload") or ""
    return ""


def _signed(signers: Mapping[str, Signer]) -> Iterator[bytes]:
    """The datagrams, signed by the peers of their rows, and what an attacker or a bad network makes of such."""
    hardware, stranger = signers["hardware"], Signer(_NUMBER, Key(99, "x", bytes(32)), SigningClock())
    for datagram in _DATAGRAMS:
        handler = REGISTRY.by_name.get(_payload(datagram))
        yield (signers[handler.route.peer] if handler else hardware).sign(datagram)
    one, early, late, other = (hardware.sign(pressure) for pressure in _PRESSURES[:4])
    yield from (one, one, late, early, _PRESSURES[0], signers["basestation"].sign(_PRESSURES[0]))
    yield from (stranger.sign(_PRESSURES[0]), other[:5] + bytes([other[5] ^ 1]) + other[6:], other[: -_SIGNATURE + 3])
    yield from (other + b"\x08\x01", hardware.sign(other) + bytes(7), hardware.sign(_envelope(drive_motor={})))
    yield next(one for one in map(hardware.sign, [_PRESSURES[0]] * 10_000) if one[-1] == 0).rstrip(b"\0")
    yield from (hardware.sign(pressure + b"\xda\x07\x00") for pressure in _PRESSURES[:2])
    ahead = Signer(_NUMBER, hardware.key, SigningClock(SigningClock().last + 120 * TICKS_PER_SECOND))
    yield from (ahead.sign(pressure) for pressure in _PRESSURES[:3])
    yield Signer(_NUMBER, hardware.key, SigningClock(2**47)).sign(_PRESSURES[0])
    yield ahead.sign(_PRESSURES[0])


def _bare(datagram: bytes) -> bytes:
    """The envelope without what differs in each run: of a signature, the number of the key stays."""
    return re.sub(rb"\xba\x01\x0f(.).{14}", rb"\1", restore(datagram), flags=re.DOTALL)


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


def _keys(registry: Any, folder: Path) -> tuple[SignedLinks | None, dict[str, SignedLinks]]:
    """The keys of a bridge, and those of its peers."""
    folder.mkdir()
    files = {peer.name: folder / f"{peer.name}.keys" for peer in registry.peers}
    for name, file in files.items():
        make_key_file(file, name, datetime.now(timezone.utc))
    ends = {name: SignedLinks(_NUMBER, [file], _LOGGER, name) for name, file in files.items()}
    return open_links(registry, [*files.values()], _LOGGER), ends


def _numbered(kind: Any, number: int) -> dict[str, Any]:
    """Different values, of which the last does not fit into the payload."""
    if kind is Odometry:
        return {"pose": PoseWithCovariance(Pose(Point(1e300 if number == _COMMANDS - 1 else number)))}
    return {"distance_to_go": float(number)} if kind is DrivingBoardMotorMessage else {}


def _waiting(sock: socket.socket, count: int) -> list[bytes]:
    sock.settimeout(PATIENCE_S)
    return [sock.recv(65_536) for _ in range(count)]


def _have_arrived(arrived: Mapping[str, Sequence[bytes]], account: Account) -> bool:
    return [*map(len, arrived.values())] == [account.published["pressure_info"], account.extra_published[_EXTRA]]


def _kept(make: Callable[..., Any], ends: dict[str, Any]) -> Callable[..., Any]:
    return lambda topic, *given, **named: ends.setdefault(topic, make(topic, *given, **named))


def _bridged(
    middleware: str, native: bool, case: _Case, observers: Sequence[_Observer], folder: Path, port: int
) -> Sequence[Any]:
    """What arrives on two topics and at both peers, and what is counted."""
    peers = {name: socket.socket(type=socket.SOCK_DGRAM) for name in ("hardware", "basestation")}
    ports = {"hardware": "dst_b_port", "basestation": "dst_a_port"}
    for sock in peers.values():
        sock.bind(("127.0.0.1", 0))
    given = {ports[name]: sock.getsockname()[1] for name, sock in peers.items()}
    given |= {"listen_port": 0, "listen_address": "127.0.0.1", "native_core": native, "forward_policy": case.policy}
    registry = _registry(case)
    if case.guard:
        given["dst_b_port"] = 0
    datagrams, keys, ends = _DATAGRAMS, None, {}
    if case.signed:
        keys, ends = _keys(registry, folder / str(native))
        signers = {name: links.signer(["ros"]) for name, links in ends.items()}
        datagrams = [*_signed({name: signer for name, signer in signers.items() if signer})]
    carrier, stranger = None, socket.socket(type=socket.SOCK_DGRAM)
    if case.line:
        line = f"tcp:127.0.0.1:{port}"
        given["hardware_host"] = f"{line}?listen"
        carrier = Carrier(transport_at(line), peers["hardware"])
    settings = parameters.read(registry, given)
    arrived: dict[str, list[bytes]] = {"pressure_info": [], _EXTRA: []}
    types = {handler.route.topic: handler.message_type for handler in (*REGISTRY.handlers, *REGISTRY.extra_topics)}
    with open_middleware("dds", NodeIdentity("observer")) as observer:
        node = open_middleware(middleware, NodeIdentity("bridge"))
        of_bridge: dict[str, Any] = {}  # its publishers and subscriptions
        node.publisher, node.subscribe = _kept(node.publisher, of_bridge), _kept(node.subscribe, of_bridge)  # type: ignore[method-assign]
        tapped = node
        for one in observers:
            tapped = TappedMiddleware(tapped, one)
        bridge = Bridge(registry, settings, tapped, lambda topic: f"/{topic}", _LOGGER, observers, keys)
        with bridge:
            subscriptions = [
                observer.subscribe(f"/{topic}", types[topic], Qos(depth=100), messages.extend)
                for topic, messages in arrived.items()
            ]
            commands = {
                one: observer.publisher(f"/{one.route.topic}", one.message_type, Qos(depth=100)) for one in _OUTBOUND
            }
            # Both ends have to know each other: a reader ignores what comes from an unknown writer.
            known = [
                *(one.has_publishers for one in subscriptions),
                *(of_bridge[f"/{topic}"].has_subscribers for topic in arrived),
            ]
            for handler, command in commands.items():
                known += [command.has_subscribers, of_bridge[f"/{handler.route.topic}"].has_publishers]
            wait_until(lambda: all(one() for one in known), "the ends of all topics")
            board, place = peers["hardware"], ("127.0.0.1", bridge.port)
            if carrier is not None:
                for datagram in _PRESSURES:
                    stranger.sendto(datagram, place)
                wait_until(lambda: bridge.account.dropped["wrong_source"] == len(_PRESSURES), "the refusals")
                carrier.start()
                wait_until(lambda: bridge.link_states()[EndName("hardware")].state == "ok", "the line")
                wait_until(lambda: carrier.why is None, "the line of the board")
                place = carrier.address  # type: ignore[assignment]
            before = bridge.account.received
            for count, datagram in enumerate(datagrams, before + 1):
                board.sendto(datagram, place)
                wait_until(lambda count=count: bridge.account.received >= count, f"{count} datagrams")  # type: ignore[misc]
                # A publisher keeps only the last messages.
                wait_until(lambda: _have_arrived(arrived, bridge.account), "the pressures")
            for number in range(_COMMANDS):
                for handler, command in commands.items():
                    command.publish([cdr.encode(handler.message_type(**_numbered(handler.message_type, number)))])
                # A row with a limit passes on the first message, and of those that then arrive together the newest.
                wait_until(lambda number=number: bridge.account.taken["arm_target"] > number, "a command")  # type: ignore[misc]
            expected = _COMMANDS * len(commands) - 1 - (_COMMANDS - 1 if case.paced else 0)
            wait_until(lambda: bridge.account.sent.total() == expected, "the commands")
            wait_until(lambda: bridge.account.refused.total() == 1, "the command that does not fit")
            bridge.stop()
            bridge.run()
    counted, waiting = bridge.account.as_dict(), Counter(bridge.account.forwarded)
    for name, count in bridge.account.sent.items():
        waiting[REGISTRY.by_name[name].route.peer] += count
    sent = {name: _waiting(peers[name], count) for name, count in waiting.items()}
    if carrier is not None:
        carrier.close()
        counted["link_events"].pop("hardware disconnected", None)  # if the board was long in coming
    for sock in (*peers.values(), stranger):
        sock.close()
    assert not bridge.account.discrepancies()
    assert bridge.way.startswith("the native core handles all") == native, bridge.way
    for name, links in ends.items():
        for datagram in sent[name]:
            if case.policy == "mapping" or datagram not in datagrams:
                links.verifier.verify(datagram, {"ros"})
    sent = {name: sorted(map(_bare, datagrams)) if ends else sorted(datagrams) for name, datagrams in sent.items()}
    ends_of = {topic: [message[-16:] for message in messages] for topic, messages in arrived.items()}
    return counted, dict(bridge.account.dropped_of_row), ends_of, sent


@pytest.mark.slow
@pytest.mark.parametrize(
    "case",
    [
        _Case(),
        _Case("all"),
        _Case(guard=math.inf, strips=True),
        _Case(guard=math.inf, observed=True),
        _Case(guard=1e-6),
        _Case(paced=True, observed=True),
        _Case(line=True),
        _Case(signed=True),
        _Case("all", signed=True),
        _Case(guard=math.inf, observed=True, signed=True, strips=True),
        _Case(guard=1e-6, signed=True, paced=True),
    ],
)
def test_both_ways_do_the_same(middleware: str, case: _Case, tmp_path: Path, free_port: int) -> None:
    """Rows, extra topics, forwards and commands; datagrams that the core hands over; and what observers get."""
    observers = [[_Observer()] if case.observed else [] for _ in range(2)]
    found = [
        _bridged(middleware, way, case, given, tmp_path, free_port) for way, given in zip((False, True), observers)
    ]
    if case.observed:
        seen = [dict(one.seen) for (one,) in observers]
        if case.signed:  # signatures are of the moment
            seen = [one | {"received": [*map(_bare, one["received"])]} for one in seen]
        assert seen[0] == seen[1]
        assert len(seen[0]) > len(_INBOUND)
    for counted, *_ in found:
        del counted["qos_mismatches"]  # of the moment
        assert bool(counted["withheld"]) == case.paced
    assert found[0] == found[1]


def test_commands_keep_their_order_alone_and_in_bursts(middleware: str) -> None:
    """A message of seven does not fit, so that Python refuses it between those that the core sends."""
    with open_middleware("dds", NodeIdentity("node")) as node, socket.socket(type=socket.SOCK_DGRAM) as base:
        base.bind(("127.0.0.1", 0))
        given = {"listen_port": 0, "listen_address": "127.0.0.1", "dst_a_port": base.getsockname()[1]}
        made = open_middleware(middleware, NodeIdentity("bridge"))
        settings = parameters.read(REGISTRY, given)
        with Bridge(REGISTRY, settings, made, lambda topic: f"/{topic}", _LOGGER) as bridge:
            publisher = node.publisher("/odometry/global", Odometry, Qos(depth=100))

            def publish(number: int) -> None:
                value = 1e300 if number % 7 == 6 else number
                publisher.publish([cdr.encode(Odometry(pose=PoseWithCovariance(Pose(Point(value)))))])

            with repeated(lambda _: publish(0)):
                first = _waiting(base, 1)
            last = 0
            for size in (1, 2, 8, 1, 1, 5) * 8:
                for number in range(last + 1, last + size + 1):
                    publish(number)
                last += size
                wait_until(lambda last=last: bridge.account.refused.total() == (last + 1) // 7, "refusals")  # type: ignore[misc]
                while _position(first[-1]) < last - (last % 7 == 6):
                    first += _waiting(base, 1)
            bridge.stop()
            bridge.run()
    found = [_position(one) for one in first]
    assert found[found.count(0) :] == [number for number in range(1, last + 1) if number % 7 != 6]
    assert not bridge.account.discrepancies()


def _position(datagram: bytes) -> float:
    return float(REGISTRY.envelope.FromString(datagram).rover_localization.x)


def test_of_a_burst_the_newest_message_passes(middleware: str) -> None:
    """On both ways, if a row has a limit: the datagrams wait in the socket before the bridge runs."""
    registry, found = _registry(_Case(paced=True)), []
    for native in (False, True):
        observer = _Observer()
        node = TappedMiddleware(open_middleware(middleware, NodeIdentity("bridge")), observer)
        settings = parameters.read(registry, {"listen_port": 0, "listen_address": "127.0.0.1", "native_core": native})
        bridge = Bridge(registry, settings, node, lambda topic: f"/{topic}", _LOGGER)
        with socket.socket(type=socket.SOCK_DGRAM) as board:
            for pressure in _PRESSURES[:4]:
                board.sendto(pressure, ("127.0.0.1", bridge.port))
        with bridge:
            wait_until(lambda bridge=bridge: bridge.account.received == 4, "the burst")  # type: ignore[misc]
            bridge.stop()
            bridge.run()
        found.append((dict(observer.seen), bridge.account.dropped))
    assert found[0] == found[1]
    assert found[0][1] == {Reason.SUPERSEDED.value: 3}


@pytest.mark.slow
def test_what_two_threads_sign_for_a_peer_arrives_in_the_order_of_its_timestamps(
    middleware: str, tmp_path: Path
) -> None:
    """Messages of a topic, and forwards at the same time: the peer would refuse a datagram that was overtaken."""
    registry, handler = _registry(_Case(signed=True)), REGISTRY.by_name["detected_object"]
    keys, ends = _keys(registry, tmp_path / "keys")
    signer = ends["hardware"].signer(["ros"])
    arrived: list[bytes] = []
    with open_middleware("dds", NodeIdentity("node")) as node, socket.socket(type=socket.SOCK_DGRAM) as base:
        base.bind(("127.0.0.1", 0))
        base.settimeout(0.5)
        reading = threading.Thread(target=lambda: arrived.extend(iter(partial(_received, base), b"")))
        given = {"listen_port": 0, "listen_address": "127.0.0.1", "dst_a_port": base.getsockname()[1]}
        made = open_middleware(middleware, NodeIdentity("bridge"))
        settings = parameters.read(registry, given)
        with Bridge(registry, settings, made, lambda topic: f"/{topic}", _LOGGER, (), keys) as bridge:
            publisher = node.publisher(f"/{handler.route.topic}", handler.message_type, Qos(depth=100))
            wait_until(publisher.has_subscribers, "the bridge")
            reading.start()
            message, end = handler.to_cdr(handler.payload_type(), UNSTAMPED), time.monotonic() + 1.5
            while time.monotonic() < end:
                publisher.publish([message] * 2)
                for _ in range(4):
                    base.sendto(signer.sign(_envelope(ph_info={})), ("127.0.0.1", bridge.port))  # type: ignore[union-attr]
                time.sleep(0.0005)
            bridge.stop()
            bridge.run()
        reading.join()
    for datagram in arrived:
        ends["basestation"].verifier.verify(datagram, {"ros"})
    assert set(map(_payload, arrived)) == {"ph_info", "detected_object"}


def _received(sock: socket.socket) -> bytes:
    try:
        return sock.recv(65_536)
    except TimeoutError:
        return b""


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
