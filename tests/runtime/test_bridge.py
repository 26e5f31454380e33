"""A whole bridge between real UDP sockets and topics in memory."""

from __future__ import annotations

import contextlib
import dataclasses
import logging
import re
import socket
import threading
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import pytest
from google.protobuf.message import DecodeError
from needs import needs_linux
from polling import PATIENCE_S, wait_until
from tables import unguarded

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Bridge, MiddlewareError, Qos, Registry, SetupError, Translator
from roverlink.runtime.bridge.bridge import Handle, Observer, Send
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.registry import AnyHandler, EndName
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.net import udp
from roverlink.runtime.ros_arguments import parameters

_QUIET = unguarded(REGISTRY)  # what a peer is told by the bridge itself has tests of its own
_INBOUND = [handler for handler in REGISTRY.handlers if handler.route.inbound]
_OUTBOUND = [handler for handler in REGISTRY.handlers if not handler.route.inbound]
_LOGGER = logging.getLogger("test_bridge")


def _envelope(**payloads: Any) -> bytes:
    return REGISTRY.envelope(**payloads).SerializeToString()


def _filled(handler: AnyHandler, seconds: float = 1.0) -> bytes:
    return _envelope(**{handler.route.name: payload_at(handler.payload_type, seconds)})


class _Rig:
    """A bridge, the peers' sockets, a board that sends, and what arrived on each topic."""

    def __init__(
        self, registry: Registry = _QUIET, middleware: Any = None, observers: Sequence[Observer] = (), **given: Any
    ) -> None:
        self.peers = {peer.name: _socket() for peer in registry.peers}
        ports = {peer.port_parameter: self.peers[peer.name].getsockname()[1] for peer in registry.peers}
        values = {"listen_port": 0, "listen_address": "127.0.0.1", **ports, **given}
        self.graph = Graph()
        self.bridge = Bridge(
            registry,
            parameters.read(registry, values),
            middleware or MemoryMiddleware(self.graph),
            lambda topic: f"/{topic}",
            _LOGGER,
            observers,
        )
        self.account = self.bridge.account
        self.on_topic: defaultdict[str, list[bytes]] = defaultdict(list)
        self._board = _socket()
        self._board.connect(("127.0.0.1", self.bridge.port))
        self._nodes = MemoryMiddleware(self.graph)
        for handler in registry.handlers:
            if handler.route.inbound:
                self._nodes.subscribe(
                    f"/{handler.route.topic}", handler.message_type, Qos(), self.on_topic[handler.route.topic].extend
                )
        self.failure: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _run(self) -> None:
        try:
            self.bridge.run()
        except ValueError as failure:
            self.failure = failure

    def __enter__(self) -> _Rig:
        self.bridge.__enter__()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
        self.bridge.__exit__(None, None, None)
        for sock in (*self.peers.values(), self._board):
            sock.close()

    def stop(self) -> None:
        """Stop the bridge and wait until it has."""
        self.bridge.stop()
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()

    def send(self, *datagrams: bytes) -> None:
        """Send as a board."""
        for datagram in datagrams:
            self._board.send(datagram)

    def settle(self, received: int) -> None:
        """Wait until the bridge has handled so many datagrams."""
        wait_until(lambda: self.account.received >= received, f"{received} datagrams")
        self.stop()

    def publish(self, handler: AnyHandler, message: bytes) -> None:
        """Publish as a ROS 2 node."""
        self._nodes.publisher(f"/{handler.route.topic}", handler.message_type, Qos()).publish([message])

    def arrived(self, peer: str, at_least: int = 0) -> list[bytes]:
        """What a peer has got, once it has got so many."""
        datagrams: list[bytes] = []

        def enough() -> bool:
            with contextlib.suppress(BlockingIOError):
                while True:
                    datagrams.append(self.peers[peer].recv(65_536))
            return len(datagrams) >= at_least

        wait_until(enough, f"{at_least} datagrams for {peer}")
        return datagrams


def _socket() -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024 * 1024)
    sock.bind(("127.0.0.1", 0))
    sock.setblocking(False)
    return sock


@pytest.fixture
def rig() -> Iterator[_Rig]:
    """A bridge as it is without any parameters."""
    with _Rig() as rig:
        yield rig


# --- peers to topics --------------------------------------------------------------------------------------------


def test_every_inbound_message_reaches_its_topic(rig: _Rig) -> None:
    """Each of the table's inbound payloads is published once, on its topic, as its handler makes it."""
    rig.send(*map(_filled, _INBOUND))
    rig.settle(len(_INBOUND))
    for handler in _INBOUND:
        expected = handler.to_cdr(payload_at(handler.payload_type, 1.0))
        assert rig.on_topic[handler.route.topic] == [expected], handler.route.name
        assert rig.account.published[handler.route.name] == 1
    assert len(_INBOUND) == 15
    assert not rig.account.dropped.total()


def test_telemetry_is_forwarded_raw_to_the_basestation(rig: _Rig) -> None:
    """What the hardware says goes on to the basestation, byte by byte; what the basestation says goes to nobody."""
    rig.send(*map(_filled, _INBOUND))
    rig.settle(len(_INBOUND))
    telemetry = [_filled(handler) for handler in _INBOUND if handler.route.peer == "hardware"]
    assert len(telemetry) == 12
    assert rig.arrived("basestation", 12) == telemetry
    assert rig.arrived("hardware") == []
    assert rig.account.forwarded == {"basestation": 12}


@pytest.mark.parametrize("change", ["stripped", "padded"])
def test_trailing_zeros_are_understood_and_forwarded_intact(rig: _Rig, change: str) -> None:
    """A stripped or padded envelope is published as the plain one, and a strict decoder gets the plain one as well."""
    plain = _envelope(load_cell_info={"mass_grams": 0.0, "is_calibrated": True, "tare_offset_counts": 256})
    plain += b"\x5a\0"  # number 11, empty: the payload that counts, and its length is a zero byte
    handler = REGISTRY.by_number[11]
    sent = plain.rstrip(b"\0") if change == "stripped" else plain + bytes(50)
    rig.send(sent)
    rig.settle(1)
    assert rig.on_topic[handler.route.topic] == [handler.to_cdr(handler.payload_type())]
    (forwarded,) = rig.arrived("basestation", 1)
    assert forwarded == plain
    with pytest.raises(DecodeError):
        REGISTRY.envelope.FromString(sent)
    assert REGISTRY.envelope.FromString(forwarded) == REGISTRY.envelope.FromString(plain)


def test_many_messages_keep_their_order(rig: _Rig) -> None:
    """Messages of a topic come in the order in which they were sent."""
    handler = REGISTRY.by_name["imu_info"]
    count = 3000
    for number in range(count):
        rig.send(_envelope(imu_info={"accel_x": float(number)}))
        if number % 300 == 0:
            wait_until(lambda number=number: rig.account.received > number, "the datagrams so far")  # type: ignore[misc]
    rig.settle(count)
    seen = [cdr.decode(handler.message_type, data).accel_x for data in rig.on_topic["imu_data"]]
    assert seen == list(range(count))
    assert rig.account.published == {"imu_info": count}


def test_messages_of_remapped_topics_go_where_the_node_has_them() -> None:
    """The bridge publishes and subscribes on the names that it is given for its topics."""
    graph = Graph()
    bridge = Bridge(
        REGISTRY,
        parameters.read(REGISTRY, {"listen_port": 0, "listen_address": "127.0.0.1"}),
        MemoryMiddleware(graph),
        lambda topic: f"/rover/{topic}_remapped",
        _LOGGER,
    )
    with bridge:
        assert "/rover/imu_data_remapped" in graph.callbacks
        assert len(graph.callbacks["/rover/drive_motor_remapped"]) == 1
        bridge.stop()
        bridge.run()


# --- topics to peers --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("handler", _OUTBOUND, ids=lambda handler: handler.route.name)
def test_every_outbound_message_reaches_its_peer(rig: _Rig, handler: AnyHandler) -> None:
    """A message on an outbound row's topic is sent to the row's peer, to it alone, as the plain envelope."""
    payload = payload_at(handler.payload_type, 2.0)
    rig.publish(handler, handler.to_cdr(payload))
    others = set(rig.peers) - {handler.route.peer}
    assert rig.arrived(handler.route.peer, 1) == [_envelope(**{handler.route.name: payload})]
    assert not any(rig.arrived(other) for other in others)
    assert rig.account.sent == {handler.route.name: 1}


def test_there_are_six_outbound_rows() -> None:
    """The tests above and before cover all of the table."""
    assert len(_OUTBOUND) + len(_INBOUND) == len(REGISTRY.handlers) == 21


def test_a_link_that_strips_zeros_gets_stripped_datagrams() -> None:
    """Where the table says so of a peer, trailing zeros are not sent to it."""
    peers = tuple(dataclasses.replace(peer, strip_trailing_zeros=True) for peer in _QUIET.peers)
    handler = REGISTRY.by_name["drive_motor"]
    with _Rig(dataclasses.replace(_QUIET, peers=peers)) as rig:
        rig.publish(handler, cdr.encode(handler.message_type()))
        assert rig.arrived("hardware", 1) == [b"\x4a"]


def test_a_message_that_cannot_be_read_is_counted_and_warned_of(rig: _Rig, caplog: pytest.LogCaptureFixture) -> None:
    """Rubbish on a topic is refused by name; the next good message is sent."""
    handler = REGISTRY.by_name["drive_motor"]
    rig.publish(handler, b"rubbish")
    rig.publish(handler, cdr.encode(handler.message_type()))
    assert rig.account.refused == {"drive_motor": 1}
    assert rig.account.sent == {"drive_motor": 1}
    assert any(message.startswith("not sent: drive_motor: not plain CDR") for message in caplog.messages)


# --- forwarding everything --------------------------------------------------------------------------------------


def test_the_policy_all_forwards_everything_to_everyone() -> None:
    """Every datagram, understood or not, goes raw and once to each peer, as it came."""
    datagrams = [
        _filled(REGISTRY.by_name["imu_info"]),
        _filled(REGISTRY.by_name["control_mode"]),
        _filled(REGISTRY.by_name["drive_motor"]),
        bytes.fromhex("ca01"),
        _envelope(imu_info={}) + bytes(100),
        b"\xff\xff\xff",
        b"",
    ]
    with _Rig(forward_policy="all") as rig:
        rig.send(*datagrams)
        rig.settle(len(datagrams))
        for peer in rig.peers:
            assert rig.arrived(peer, len(datagrams)) == datagrams
        assert rig.account.forwarded == dict.fromkeys(rig.peers, len(datagrams))
        assert rig.account.published == {"imu_info": 2, "control_mode": 1}


# --- being observed ---------------------------------------------------------------------------------------------


class _Observer:
    """Notes what passes a bridge."""

    def __init__(self, name: str, notes: list[Any]) -> None:
        self._name, self._notes = name, notes

    def receiving(self, handle: Handle) -> Handle:
        def received(batch: list[bytes]) -> None:
            self._notes.append((self._name, "received", list(batch)))
            handle(batch)

        return received

    def sending(self, peer: str, send: Send) -> Send:
        def sent(datagrams: Sequence[bytes]) -> int:
            self._notes.append((self._name, peer, list(datagrams)))
            return send(datagrams)

        return sent


def test_observers_hear_what_is_received_and_what_is_made_for_peers() -> None:
    """Each in turn, the last one first, before it is handled; raw forwards are not heard a second time."""
    notes: list[Any] = []
    motor = REGISTRY.by_name["drive_motor"]
    imu, command = _envelope(imu_info={}), _envelope(drive_motor={})
    with _Rig(observers=[_Observer("first", notes), _Observer("second", notes)]) as rig:
        rig.send(imu)
        rig.settle(1)
        rig.publish(motor, cdr.encode(motor.message_type()))
        assert rig.arrived("hardware", 1) == [command]
        assert rig.arrived("basestation", 1) == [imu]
    assert notes == [
        *[(name, "received", [imu]) for name in ("second", "first")],
        *[(name, "hardware", [command]) for name in ("second", "first")],
    ]


# --- what is not bridged ----------------------------------------------------------------------------------------


def test_each_reason_is_counted_and_warned_of(rig: _Rig, caplog: pytest.LogCaptureFixture) -> None:
    """Whatever cannot be bridged is counted by its reason, warned of with number and name, and nothing stops."""
    bad = {
        "empty": (b"", r"dropped: the PBEnvelope has no payload \(0 bytes\)"),
        "malformed": (b"\xff" * 9, r"dropped: not a valid PBEnvelope: 9 bytes that start with ff ff"),
        "unknown_payload": (bytes.fromhex("ca0100"), r"dropped: no row of the table has payload 25$"),
        "wrong_direction": (
            _envelope(arm_ctrl={}),
            r"dropped: 'arm_ctrl' \(2\) is a message to a peer \(ros_to_hardware\)",
        ),
        "conversion": (_envelope(imu_info={"error_code": 300}), r"dropped: payload 13: imu_info\.error_code: 300"),
        "oversized": (bytes(1473), r"dropped: a datagram of more than 1472 bytes"),
    }
    good = _filled(REGISTRY.by_name["imu_info"])
    for datagram, _ in bad.values():
        rig.send(datagram, good, datagram)
    rig.settle(3 * len(bad))
    assert rig.account.dropped == dict.fromkeys(bad, 2)
    assert rig.account.published == {"imu_info": len(bad)}
    for _, expected in bad.values():
        found = [message for message in caplog.messages if re.match(expected, message)]
        assert len(found) == 1, (expected, caplog.messages)  # the second one came within two seconds


def test_nothing_that_is_refused_is_forwarded(rig: _Rig) -> None:
    """With the table's own policy, only what was bridged goes on."""
    rig.send(_envelope(imu_info={"error_code": 300}), b"\xff", bytes(1473), bytes.fromhex("ca01"))
    rig.settle(4)
    assert rig.arrived("basestation") == rig.arrived("hardware") == []


@pytest.mark.parametrize("policy", ["mapping", "all"])
def test_the_longest_datagram_passes_and_a_longer_one_does_not(policy: str) -> None:
    """`max_datagram` is the longest that is taken; what is longer is not even forwarded, cut as it would be."""
    longest = _envelope(imu_info={"accel_x": 1.0})
    longest += bytes(60 - len(longest))
    with _Rig(max_datagram=60, forward_policy=policy) as rig:
        rig.send(longest, longest + b"\0", bytes(5000))
        rig.settle(3)
        assert rig.account.published == {"imu_info": 1}
        assert rig.account.dropped == {"oversized": 2}
        assert rig.arrived("basestation", 1) == [longest if policy == "all" else longest.rstrip(b"\0")]


class _SlowSubscribers(MemoryMiddleware):
    """A middleware that accepts the first message and no more."""

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Any:
        accepted: list[bytes] = []

        def publish(messages: Sequence[bytes]) -> int:
            room = 1 - len(accepted)
            accepted.extend(messages[:room])
            return min(room, len(messages))

        return type("Publisher", (), {"publish": staticmethod(publish), "has_subscribers": staticmethod(lambda: True)})


def test_what_the_middleware_does_not_accept_is_counted(caplog: pytest.LogCaptureFixture) -> None:
    """A message for which the bridge would have had to wait is counted and told by name, and not as published."""
    with _Rig(middleware=_SlowSubscribers()) as rig:
        rig.send(*[_envelope(imu_info={})] * 20, _envelope(gps_info={}))
        rig.settle(21)
        assert rig.account.published == {"imu_info": 1, "gps_info": 1}
        assert rig.account.dropped == {"not_published": 19}
        assert len(rig.arrived("basestation", 21)) == 21
    assert "dropped: imu_info (13): a subscriber is too slow" in caplog.text


# --- starting and stopping --------------------------------------------------------------------------------------


def test_stopping_handles_what_had_arrived() -> None:
    """Everything that arrived before the stop is bridged."""
    rig = _Rig()
    count = 2000
    rig.send(*[_filled(REGISTRY.by_name["imu_info"])] * count)
    rig.bridge.stop()
    with rig:
        rig.stop()
        assert rig.account.received == rig.account.published["imu_info"] == count
        assert len(rig.arrived("basestation", count)) == count


def test_an_idle_bridge_stops_at_once(rig: _Rig) -> None:
    """A bridge to which nobody sends stops without waiting for a datagram."""
    rig.stop()


def test_stopping_again_does_no_harm() -> None:
    """A second signal while the bridge is being left, or after it, is no error."""
    with _Rig() as rig:
        rig.bridge.stop()
        rig.bridge.stop()
    rig.bridge.stop()


def test_a_port_in_use_is_told(rig: _Rig) -> None:
    """A second bridge on the same port says which port it is."""
    with pytest.raises(SetupError, match=f"UDP port {rig.bridge.port} on 127.0.0.1 is in use"):
        _Rig(listen_port=rig.bridge.port)


def test_a_host_that_does_not_resolve_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    """A board may boot later, so the bridge starts, and tells the name once for each peer."""
    with _Rig(dst_ip="rover.invalid") as rig:
        wait_until(lambda: rig.account.link_events.total() == 2, "two failed look-ups")
        rig.send(_envelope(imu_info={}))
        rig.settle(1)
        assert rig.account.unsent == {"basestation": 1}
    assert rig.account.link_events == {("basestation", "", "not_resolved"): 1, ("hardware", "", "not_resolved"): 1}
    assert len(re.findall(r"hardware: rover\.invalid cannot be resolved: ", caplog.text)) == 1


class _Stale(MemoryMiddleware):
    """A ROS 2 with other message types; it has no topics before that is known."""

    def check_types(self, message_types: Iterable[type[Message]]) -> None:
        raise MiddlewareError(f"{len(list(message_types))} message types are not the generated ones")

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Any:
        pytest.fail("a publisher was opened")

    subscribe = publisher  # type: ignore[assignment]  # neither is called


def test_message_types_are_checked_before_any_topic_is_open() -> None:
    """All rows and extra topics are checked; the bridge does not start, and passes nothing on."""
    count = len(REGISTRY.handlers) + len(REGISTRY.extra_topics)
    with pytest.raises(MiddlewareError, match=rf"^{count} message types"), _Rig(middleware=_Stale()):
        pass


class _Broken(MemoryMiddleware):
    """A middleware with a defect."""

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Any:
        def publish(_: Sequence[bytes]) -> int:
            raise ValueError("a defect")

        return type("Publisher", (), {"publish": staticmethod(publish), "has_subscribers": staticmethod(lambda: True)})


def test_a_defect_ends_the_bridge_and_is_not_swallowed() -> None:
    """What nobody foresaw comes out of `run`, instead of a bridge that lives on half dead."""
    with _Rig(middleware=_Broken()) as rig:
        rig.send(_envelope(imu_info={}))
        wait_until(lambda: rig.failure, "the defect")
    assert str(rig.failure) == "a defect"


# --- the network ------------------------------------------------------------------------------------------------


def test_a_network_that_refuses_is_counted_and_does_not_stop_the_bridge(caplog: pytest.LogCaptureFixture) -> None:
    """Where sending fails, messages are published all the same; each datagram is counted and the reason told."""
    motor = REGISTRY.by_name["drive_motor"]
    with _Rig(dst_ip="255.255.255.255") as rig:  # a broadcast, which nobody allowed
        rig.send(*[_envelope(imu_info={})] * 5)
        rig.publish(motor, cdr.encode(motor.message_type()))
        rig.settle(5)
        assert rig.account.published == {"imu_info": 5}
        assert rig.account.unsent == {"basestation": 5, "hardware": 1}
        assert rig.account.forwarded == rig.account.sent == {}
    assert "cannot send to basestation at 255.255.255.255:" in caplog.text
    assert "Permission denied" in caplog.text


def test_a_network_that_comes_back_is_used_again(rig: _Rig) -> None:
    """After the network has changed, and an old way no longer works, datagrams find the new one."""

    class _Gone:
        def sendmsg(self, *_: object) -> int:
            raise OSError(101, "Network is unreachable")

        send = sendmsg  # for a datagram that comes alone

    rig.bridge._ends.destinations[EndName("basestation")]._ways[0]._route = _Gone(), None  # type: ignore[assignment]  # a socket that has lost it
    rig.send(*[_envelope(imu_info={"accel_x": float(number)}) for number in range(3)])
    rig.settle(3)
    assert rig.account.unsent == {"basestation": 1}
    assert rig.account.forwarded == {"basestation": 2}
    assert len(rig.arrived("basestation", 2)) == 2


def test_a_peer_that_is_not_there_is_no_trouble() -> None:
    """Where nobody listens on a peer's port, which the network reports with the next datagram, the bridge goes on."""
    with _Rig() as rig:
        for sock in rig.peers.values():
            sock.close()
        for number in range(1, 101):
            rig.send(_envelope(imu_info={}))
            wait_until(lambda number=number: rig.account.received >= number, "the datagram")  # type: ignore[misc]
        rig.settle(100)
        assert rig.account.published == {"imu_info": 100}
        assert rig.account.forwarded["basestation"] + rig.account.unsent["basestation"] == 100


def test_a_peer_that_comes_back_gets_every_datagram_from_then_on() -> None:
    """The report that a peer was not there costs none of the datagrams that are sent once it is."""
    with _Rig() as rig:
        address = rig.peers["basestation"].getsockname()
        rig.peers["basestation"].close()
        rig.send(_envelope(imu_info={}))
        wait_until(lambda: rig.account.forwarded or rig.account.unsent, "the first datagram")
        rig.peers["basestation"] = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        rig.peers["basestation"].bind(address)
        rig.peers["basestation"].setblocking(False)
        datagrams = [_envelope(imu_info={"accel_x": float(number)}) for number in range(20)]
        rig.send(*datagrams)
        rig.settle(21)
        assert rig.arrived("basestation", 20) == datagrams


@needs_linux  # whose kernel counts them
def test_what_the_kernel_dropped_is_in_the_account(caplog: pytest.LogCaptureFixture) -> None:
    """Datagrams that came faster than they were read are counted and warned of: nothing is lost in silence."""
    rig = _Rig(receive_buffer=4096)
    rig.send(*[_envelope(imu_info={})] * 1000)
    with rig:
        rig.stop()
    assert 0 < rig.account.received < 1000
    assert rig.account.received + rig.account.kernel_drops == 1000
    assert f"the kernel dropped {rig.account.kernel_drops} datagrams" in caplog.text


def test_a_receive_buffer_that_is_not_given_is_told(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Where the system gives a smaller buffer than was asked for, the operator is told how to raise it."""
    monkeypatch.setattr(udp, "receive_buffer", lambda sock: 212_992)
    with _Rig(receive_buffer=4_000_000):
        pass
    assert "the UDP receive buffer has 212992 bytes instead of 4000000" in caplog.text
    assert "sysctl -w net.core.rmem_max=4000000" in caplog.text


def test_a_bridge_speaks_with_itself_over_the_core_alone(translator: Translator) -> None:
    """What one bridge sends to a peer, another would receive as the same payload: the two directions are inverse."""
    for handler in _OUTBOUND:
        payload = payload_at(handler.payload_type, 3.0)
        envelope = translator.parse(translator.send(handler, handler.to_cdr(payload)))
        assert getattr(envelope, handler.route.name) == payload
