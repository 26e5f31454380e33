"""A bridge that is safe in the field: stops, rates, and who may speak, between real sockets and topics in memory."""

from __future__ import annotations

import contextlib
import logging
import socket
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from typing import Any

import pytest
from polling import wait_until
from tables import changed, of_peers, unguarded

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Bridge, Qos, Registry
from roverlink.runtime.bridge import timekeeper
from roverlink.runtime.core.handler import Deadman
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware, MemoryPublisher
from roverlink.runtime.ros_arguments import parameters

_LOGGER = logging.getLogger("test_guarding")
_PLAIN = unguarded(REGISTRY)
_DRIVE = REGISTRY.by_name["drive_motor"]
_ARM = REGISTRY.by_name["arm_target"]
_STOP = REGISTRY.envelope(drive_motor={"distance_to_go": 0.0}).SerializeToString()
_DEADMAN = Deadman(after_ms=150, send={"distance_to_go": 0.0}, repeat_ms=400)


def _command(number: float) -> bytes:
    return _DRIVE.to_cdr(_DRIVE.payload_type(distance_to_go=number))


def _datagram(number: float) -> bytes:
    return bytes(REGISTRY.envelope(drive_motor={"distance_to_go": number}).SerializeToString())


class _Board:
    """The peers' socket: what arrived, and when."""

    def __init__(self) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.05)
        self.arrived: list[tuple[float, bytes]] = []
        self._open = True
        self._thread = threading.Thread(target=self._receive, daemon=True)
        self._thread.start()

    def _receive(self) -> None:
        while self._open:
            with contextlib.suppress(TimeoutError):
                datagram = self.socket.recv(65_536)
                self.arrived.append((time.monotonic(), datagram))

    @property
    def datagrams(self) -> list[bytes]:
        """What arrived, in order."""
        return [datagram for _, datagram in self.arrived]

    def close(self) -> None:
        """Listen no more."""
        self._open = False
        self._thread.join()
        self.socket.close()


class _Rig:
    """A bridge over memory with one board behind both peers' ports, and a ROS 2 node."""

    def __init__(self, registry: Registry, middleware: Any = None, **given: Any) -> None:
        self.board = _Board()
        ports = {peer.port_parameter: self.board.socket.getsockname()[1] for peer in registry.peers}
        values = {"listen_port": 0, "listen_address": "127.0.0.1", **ports, **given}
        self.graph = Graph()
        self.bridge = Bridge(
            registry,
            parameters.read(registry, values),
            middleware(self.graph) if middleware else MemoryMiddleware(self.graph),
            lambda topic: f"/{topic}",
            _LOGGER,
        )
        self.node = MemoryMiddleware(self.graph)
        self.on_topic: defaultdict[str, list[bytes]] = defaultdict(list)
        for handler in registry.handlers:
            if handler.route.inbound:
                topic = f"/{handler.route.topic}"
                self.node.subscribe(topic, handler.message_type, Qos(), self.on_topic[handler.route.name].extend)
        self._sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def publisher(self, name: str = "drive_motor") -> MemoryPublisher:
        """A publisher on a row's topic."""
        handler = REGISTRY.by_name[name]
        return self.node.publisher(f"/{handler.route.topic}", handler.message_type, Qos())

    def send(self, *datagrams: bytes, source: str = "127.0.0.1") -> None:
        """Send as a peer with some address of this host's."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind((source, 0))
            for datagram in datagrams:
                sock.sendto(datagram, ("127.0.0.1", self.bridge.port))

    def settle(self, received: int) -> None:
        """Wait until the bridge has received so many datagrams, and has handled them."""
        wait_until(lambda: self.bridge.account.received >= received, f"{received} datagrams")
        self.bridge.stop()
        self.bridge.run()

    def __enter__(self) -> _Rig:
        self.bridge.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self.bridge.__exit__(None, None, None)
        out = self.bridge.account.sent.total() + self.bridge.account.stops.total()
        wait_until(lambda: len(self.board.arrived) >= out, "what was sent last")
        self.board.close()
        self._sender.close()
        assert self.bridge.account.discrepancies() == []


@pytest.fixture
def guarded() -> Iterator[_Rig]:
    """A bridge that stops the drive after 150 ms."""
    with _Rig(changed(_PLAIN, "drive_motor", deadman=_DEADMAN)) as rig:
        yield rig


# --- stops ------------------------------------------------------------------------------------------------------


def test_the_stop_is_sent_when_the_topic_falls_silent_and_repeated(guarded: _Rig) -> None:
    """After 150 ms once, then every 400 ms."""
    wait_until(lambda: _STOP in guarded.board.datagrams, "the stop of the start, with 400 ms until the next one")
    publisher = guarded.publisher()
    for number in range(1, 41):
        spoke = time.monotonic()
        publisher.publish([_command(number)])

    def stops() -> list[float]:
        return [at - spoke for at, datagram in guarded.board.arrived if datagram == _STOP and at > spoke]

    wait_until(lambda: len(stops()) >= 3, "three stops")
    # The time is what is tested here. A busy machine makes a stop late; nothing makes it early.
    assert all(since >= 0.15 + 0.4 * count for count, since in enumerate(stops()))
    assert guarded.bridge.account.sent == {"drive_motor": 40}


def test_the_first_message_ends_the_stops(guarded: _Rig) -> None:
    """From then on the topic is watched as before."""
    wait_until(lambda: _STOP in guarded.board.datagrams, "a stop")
    publisher = guarded.publisher()
    publisher.publish([_command(7)])
    wait_until(lambda: _datagram(7) in guarded.board.datagrams, "the command")
    at = {datagram: at for at, datagram in guarded.board.arrived}[_datagram(7)]
    wait_until(lambda: guarded.board.arrived[-1][1] == _STOP and guarded.board.arrived[-1][0] > at, "the next stop")


def test_a_bridge_that_starts_beside_a_moving_rover_stops_it(guarded: _Rig) -> None:
    """What commanded it before is not known; nobody has to publish first."""
    wait_until(lambda: guarded.board.datagrams == [_STOP], "the stop")


def test_a_publisher_that_leaves_is_not_waited_for() -> None:
    """Its peer is told at once, not after the hour of this row."""
    deadman = Deadman(after_ms=3_600_000, send={"distance_to_go": 0.0})
    with _Rig(changed(_PLAIN, "drive_motor", deadman=deadman)) as rig:
        other = MemoryMiddleware(rig.graph)
        publisher = other.publisher("/drive_motor", _DRIVE.message_type, Qos())
        publisher.publish([_command(1)])
        wait_until(lambda: rig.board.datagrams == [_datagram(1)], "the command")
        time.sleep(3 * timekeeper._LOOK_S)  # nothing tells that the bridge has looked who publishes
        other.close()
        wait_until(lambda: rig.board.datagrams == [_datagram(1), _STOP], "the stop")


def test_the_stop_is_the_last_word_at_shutdown() -> None:
    """More than once, since nobody will repeat it; also where the topic spoke a moment ago."""
    with _Rig(changed(_PLAIN, "drive_motor", deadman=Deadman(10_000, {"distance_to_go": 0.0}))) as rig:
        rig.publisher().publish([_command(3)])
    assert rig.board.datagrams == [_datagram(3), _STOP, _STOP, _STOP]


def test_a_taking_thread_that_stands_still_counts_as_silent(monkeypatch: pytest.MonkeyPatch) -> None:
    """The stop does not wait for the thread, even while that holds on to a message it is about to send."""
    with _Rig(changed(_PLAIN, "drive_motor", deadman=_DEADMAN, max_rate=100)) as rig:
        publisher = rig.publisher()
        publisher.publish([_command(1)])
        standing, go_on = threading.Event(), threading.Event()
        (outlet,) = (one for one in rig.bridge._outbound_rows if one.is_timed)
        translator = outlet._translator
        send = translator.send

        def stall(*arguments: Any) -> bytes:
            standing.set()
            go_on.wait()
            return send(*arguments)

        monkeypatch.setattr(translator, "send", stall)
        time.sleep(0.05)  # the rate lets the next message pass after 10 ms, and this thread shall send it
        talker = threading.Thread(target=lambda: publisher.publish([_command(2)]))
        talker.start()
        standing.wait()
        before = len(rig.board.datagrams)
        wait_until(lambda: rig.board.datagrams[before:].count(_STOP) >= 2, "stops")
        assert _datagram(2) not in rig.board.datagrams
        go_on.set()
        talker.join()
        wait_until(lambda: _datagram(2) in rig.board.datagrams, "what was held")
        at = rig.board.datagrams.index(_datagram(2))
        wait_until(lambda: _STOP in rig.board.datagrams[at:], "the stop behind it")


def test_messages_that_cannot_be_sent_do_not_keep_a_peer_going(guarded: _Rig) -> None:
    """A publisher of nonsense is as good as none."""
    publisher = guarded.publisher()
    published = 0

    def stopped_twice() -> bool:
        nonlocal published
        publisher.publish([b"nonsense"])
        published += 1
        return guarded.board.datagrams.count(_STOP) >= 2

    wait_until(stopped_twice, "two stops")
    wait_until(lambda: guarded.bridge.account.refused == {"drive_motor": published}, "the account of the nonsense")


def test_silence_is_warned_of_once(guarded: _Rig, caplog: pytest.LogCaptureFixture) -> None:
    """Not with every repetition, and not where nobody has spoken yet."""
    wait_until(lambda: guarded.board.datagrams.count(_STOP) >= 2, "two stops")
    assert not caplog.messages
    guarded.publisher().publish([_command(1)])
    wait_until(lambda: guarded.board.datagrams.count(_STOP) >= 5, "three more stops")
    assert [message for message in caplog.messages if "silent" in message] == [
        "drive_motor: the topic is silent, so the bridge sends the stop payload (table key deadman) to the peer"
    ]


def test_a_clock_that_is_set_changes_nothing(guarded: _Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    """No time of the bridge's is a time of day."""
    wait_until(lambda: _STOP in guarded.board.datagrams, "the stop of the start")
    monkeypatch.setattr(time, "time", lambda: -1e9)
    guarded.publisher().publish([_command(1)])
    wait_until(lambda: _datagram(1) in guarded.board.datagrams, "the command")
    wait_until(lambda: guarded.board.datagrams[-1] == _STOP, "the stop")


# --- rates ------------------------------------------------------------------------------------------------------


def test_a_limited_topic_passes_its_newest(caplog: pytest.LogCaptureFixture) -> None:
    """Of a flood, 50 a second, in order, the last one included; all others are counted."""
    with _Rig(changed(_PLAIN, "drive_motor", max_rate=50)) as rig:
        publisher = rig.publisher()
        start, number = time.monotonic(), 0
        while len(rig.board.arrived) < 5:
            number += 1
            publisher.publish([_command(number), _command(number + 0.5)])
        wait_until(lambda: _datagram(number + 0.5) in rig.board.datagrams, "the last one")
        took = time.monotonic() - start
        said = [REGISTRY.envelope.FromString(d).drive_motor.distance_to_go for d in rig.board.datagrams]  # type: ignore[attr-defined]
        assert said == sorted(set(said))
        assert len(said) <= took * 50 + 2  # the rate is what is tested; a busy machine only makes it lower
        account = rig.bridge.account
        assert account.taken["drive_motor"] == 2 * number
        ends = (account.sent, account.superseded)
        wait_until(lambda: sum(end["drive_motor"] for end in ends) == 2 * number, "the account of all")


def test_a_limited_payload_is_published_at_its_rate() -> None:
    """The other way; what is forwarded raw is not limited."""
    with _Rig(changed(_PLAIN, "imu_info", max_rate=50)) as rig:
        envelopes = [REGISTRY.envelope(imu_info={"accel_x": float(n)}).SerializeToString() for n in range(1, 201)]
        start = time.monotonic()
        for envelope in envelopes:
            rig.send(envelope)
        rig.settle(200)
        wait_until(lambda: len(rig.board.datagrams) == 200, "what is forwarded")
    took = time.monotonic() - start
    account = rig.bridge.account
    assert len(rig.on_topic["imu_info"]) == account.published["imu_info"] <= took * 50 + 2  # the rate is what is tested
    assert account.published["imu_info"] + account.dropped["superseded"] == 200
    last = REGISTRY.by_name["imu_info"]
    assert rig.on_topic["imu_info"][-1] == last.to_cdr(last.payload_type(accel_x=200.0))


def test_what_waits_at_the_end_is_sent() -> None:
    """A topic without a stop has its last word."""
    with _Rig(changed(_PLAIN, "drive_motor", max_rate=1)) as rig:
        rig.publisher().publish([_command(1)])
        rig.publisher().publish([_command(2)])
    assert rig.board.datagrams == [_datagram(1), _datagram(2)]


def test_many_superseded_messages_need_no_memory() -> None:
    """Only the newest is kept."""
    with _Rig(changed(_PLAIN, "drive_motor", max_rate=1)) as rig:
        publisher = rig.publisher()
        for _ in range(50):
            publisher.publish([_command(1)] * 1000)
        (outlet,) = (one for one in rig.bridge._outbound_rows if one.is_timed)
        assert isinstance(outlet._pacer._waiting, bytes)  # type: ignore[union-attr]


# --- who may speak ----------------------------------------------------------------------------------------------

_SOURCES = of_peers(
    _PLAIN, hardware={"sources": ("127.0.0.2", "127.0.1.0/24")}, basestation={"sources": ("127.0.0.3",)}
)
_IMU = REGISTRY.envelope(imu_info={"accel_x": 1.0}).SerializeToString()
_MODE = REGISTRY.envelope(
    control_mode=payload_at(REGISTRY.by_name["control_mode"].payload_type, 1.0)
).SerializeToString()


@pytest.mark.parametrize(
    ("source", "datagram", "outcome"),
    [
        ("127.0.0.2", _IMU, "published"),
        ("127.0.1.77", _IMU, "published"),
        ("127.0.0.3", _MODE, "published"),
        ("127.0.0.3", _IMU, "wrong_source"),
        ("127.0.0.2", _MODE, "wrong_source"),
        ("127.0.0.1", _IMU, "unknown_source"),
        ("127.0.2.1", b"\xff", "unknown_source"),
        ("127.0.0.2", b"\xff", "malformed"),
        ("127.0.0.2", REGISTRY.envelope(drive_motor={"distance_to_go": 1}).SerializeToString(), "wrong_direction"),
    ],
)
@pytest.mark.parametrize("kind", ["batch", "one by one"])
def test_only_who_may_say_something_is_heard(
    source: str, datagram: bytes, outcome: str, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A stranger is not, nor is a board that speaks for the basestation; both are counted, and handed on to nobody."""
    from roverlink.runtime.net import mmsg

    monkeypatch.setattr(mmsg, "AVAILABLE", kind == "batch" and mmsg.AVAILABLE)
    with _Rig(_SOURCES) as rig:
        rig.send(datagram, source=source)
        rig.settle(1)
        account = rig.bridge.account
        published = {"published": account.published.total()} if account.published.total() else {}
        assert {**published, **{reason: n for reason, n in account.dropped.items() if n}} == {outcome: 1}
        assert account.forwarded.total() == (outcome == "published" and datagram == _IMU)


def test_a_flood_of_one_board_does_not_use_up_the_others() -> None:
    """Each address has its allowance; what is beyond it is dropped before it is read."""
    registry = of_peers(_PLAIN, hardware={"sources": ("127.0.0.0/8",), "source_rate": 100})
    with _Rig(registry) as rig:
        rig.send(*[_IMU] * 500, source="127.0.0.2")
        rig.send(*[_IMU] * 10, source="127.0.0.9")
        rig.settle(510)
        account = rig.bridge.account
        assert account.published["imu_info"] + account.dropped["over_rate"] == 510
        assert 42 <= account.published["imu_info"] < 200


def test_sources_can_be_left_alone_for_a_bench() -> None:
    """With the parameter, everybody is heard."""
    with _Rig(_SOURCES, source_policy="any") as rig:
        rig.send(_IMU)
        rig.settle(1)
        assert rig.bridge.account.published == {"imu_info": 1}


def test_a_table_that_restricts_nobody_reads_no_addresses() -> None:
    """The hot path is the one without."""
    with _Rig(_PLAIN) as rig:
        assert rig.bridge._receiver._path[1] == rig.bridge._handle
    with _Rig(_SOURCES) as rig:
        assert rig.bridge._receiver._path[1] == rig.bridge._handle_with_sources


# --- the timekeeper ---------------------------------------------------------------------------------------------


def test_without_guards_nobody_keeps_the_time() -> None:
    """No thread for a table that asks for none."""
    before = Counter(thread.name for thread in threading.enumerate())
    with _Rig(_PLAIN):
        assert Counter(thread.name for thread in threading.enumerate())["timekeeper"] == before["timekeeper"]


def test_what_ends_the_timekeeper_ends_the_bridge(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rover without its watchdog must not go on."""
    with _Rig(changed(_PLAIN, "drive_motor", deadman=_DEADMAN)) as rig:
        (outlet,) = (one for one in rig.bridge._outbound_rows if one.is_timed)

        def broken(_: float) -> None:
            raise ValueError("the guard is broken")

        monkeypatch.setattr(outlet, "run_due", broken)
        with pytest.raises(ValueError, match="the guard is broken"):
            rig.bridge.run()
