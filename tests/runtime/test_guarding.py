"""A bridge that is safe in the field: stops, rates, and who may speak, between real sockets and topics in memory."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import pytest
from bridge_rig import QUIET, Rig, changed, envelope, listener, of_peers

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Qos
from roverlink.runtime.bridge.bridge import Send
from roverlink.runtime.bridge.handling_times import Handle
from roverlink.runtime.core.handler import Deadman
from roverlink.runtime.middleware.memory import MemoryMiddleware, MemorySubscription
from roverlink.runtime.net import udp

_DRIVE = REGISTRY.by_name["drive_motor"]
_STOP = envelope(drive_motor={"distance_to_go": 0.0})
_NEVER_MS = 3_600_000


def _command(number: float) -> Any:
    return _DRIVE.payload_type(distance_to_go=number)


def _datagram(number: float) -> bytes:
    return envelope(drive_motor={"distance_to_go": number})


def _guarded(after_ms: int = 60, repeat_ms: int = 160, **more: Any) -> Any:
    """The registry with a stop of the drive."""
    return changed(QUIET, "drive_motor", deadman=Deadman(after_ms, {"distance_to_go": 0.0}, repeat_ms), **more)


@pytest.fixture
def guarded() -> Iterator[Rig]:
    """A bridge that stops the drive after 60 ms, and again every 160 ms."""
    with Rig(_guarded()) as rig:
        yield rig


def _next(rig: Rig) -> bytes:
    return rig.peers["hardware"].recv(100)


def _until(rig: Rig, wanted: bytes) -> list[bytes]:
    """What the board gets before a datagram comes."""
    return list(iter(lambda: _next(rig), wanted))


# --- stops ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_stop_is_sent_when_the_topic_falls_silent_and_repeated(guarded: Rig) -> None:
    """After 60 ms once, then every 160 ms; at the start nobody has to publish first."""
    assert _next(guarded) == _STOP
    for number in range(1, 41):
        spoke = time.monotonic()
        guarded.publish("drive_motor", _command(number))
    assert len(_until(guarded, _datagram(40))) >= 39
    stops = [(_next(guarded), time.monotonic() - spoke) for _ in range(3)]
    # The time is what is tested here. A busy machine makes a stop late; nothing makes it early.
    assert all(since >= 0.06 + 0.16 * count for count, (_, since) in enumerate(stops))
    assert {datagram for datagram, _ in stops} == {_STOP}
    assert guarded.account.sent == {"drive_motor": 40}


@pytest.mark.slow
def test_silence_is_warned_of_once(guarded: Rig, caplog: pytest.LogCaptureFixture) -> None:
    """Not with every repetition, and not where nobody has spoken yet; a clock that is set changes nothing."""
    assert [_next(guarded) for _ in range(2)] == [_STOP] * 2
    assert not caplog.messages
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(time, "time", lambda: -1e9)
        guarded.publish("drive_motor", _command(1))
        assert set(_until(guarded, _datagram(1))) <= {_STOP}
        assert [_next(guarded) for _ in range(3)] == [_STOP] * 3
    assert [message for message in caplog.messages if "silent" in message] == [
        "drive_motor: the topic is silent, so the bridge sends the stop payload (table key deadman) to the peer"
    ]


def test_a_publisher_that_leaves_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its peer is told at once, not after the hour of this row."""
    looked, has_publishers = threading.Event(), MemorySubscription.has_publishers

    def noted(subscription: MemorySubscription) -> bool:
        if found := has_publishers(subscription):
            looked.set()
        return found

    monkeypatch.setattr(MemorySubscription, "has_publishers", noted)
    with Rig(_guarded(_NEVER_MS)) as rig:
        other = MemoryMiddleware(rig.graph)
        other.publisher("/drive_motor", _DRIVE.message_type, Qos()).publish([_DRIVE.to_cdr(_command(1))])
        assert _next(rig) == _datagram(1)
        looked.wait()
        other.close()
        assert _next(rig) == _STOP


def test_the_stop_is_the_last_word_at_shutdown() -> None:
    """More than once, since nobody will repeat it; a command that waits is dropped, without a stop it is sent."""
    for registry, last in (
        (_guarded(_NEVER_MS, max_rate=1), [_STOP] * 3),
        (changed(QUIET, "drive_motor", max_rate=1), [_datagram(2)]),
    ):
        rig = Rig(registry)
        with rig.peers["hardware"].dup() as board:
            with rig:
                rig.publish("drive_motor", _command(1))
                rig.publish("drive_motor", _command(2))
            assert [board.recv(100) for _ in range(1 + len(last))] == [_datagram(1), *last]


class _Interferes:
    """An observer that does something before a datagram is sent."""

    def __init__(self, act: Callable[[Sequence[bytes]], None]) -> None:
        self._act = act

    def receiving(self, handle: Handle) -> Handle:
        return handle

    def sending(self, peer: str, send: Send) -> Send:
        def sent(datagrams: Sequence[bytes]) -> int:
            self._act(datagrams)
            return send(datagrams)

        return sent


@pytest.mark.parametrize("max_rate", [None, 100])
def test_a_taking_thread_that_stands_still_counts_as_silent(max_rate: int | None) -> None:
    """The stop does not wait for the thread, even while that holds on to a message it is about to send."""
    standing, go_on = threading.Event(), threading.Event()

    def stall(datagrams: Sequence[bytes]) -> None:
        if _datagram(2) in datagrams:
            standing.set()
            go_on.wait()

    with Rig(_guarded(max_rate=max_rate), observers=[_Interferes(stall)]) as rig:
        talker = threading.Thread(target=lambda: rig.publish("drive_motor", _command(2)))
        talker.start()
        standing.wait()
        rig.arrived("hardware")
        assert [_next(rig) for _ in range(2)] == [_STOP] * 2
        go_on.set()
        talker.join()
        assert set(_until(rig, _datagram(2))) <= {_STOP}
        assert _next(rig) == _STOP


def test_messages_that_cannot_be_sent_do_not_keep_a_peer_going(guarded: Rig) -> None:
    """A publisher of nonsense is as good as none."""
    stops = published = 0
    while stops < 2:
        guarded.publish("drive_motor", b"nonsense")
        published += 1
        stops += guarded.arrived("hardware").count(_STOP)
    assert guarded.account.refused == {"drive_motor": published}


# --- rates ------------------------------------------------------------------------------------------------------


def test_a_limited_payload_is_published_at_its_rate() -> None:
    """The other way; what is forwarded raw is not limited, and the last one comes at the end."""
    with Rig(changed(QUIET, "imu_info", max_rate=50)) as rig:
        start = time.monotonic()
        rig.receive(*(envelope(imu_info={"accel_x": float(number)}) for number in range(1, 201)))
        assert len(rig.arrived("basestation", 200)) == 200
    took = time.monotonic() - start
    account, imu = rig.account, REGISTRY.by_name["imu_info"]
    assert len(rig.on_topic["imu_data"]) == account.published["imu_info"] <= took * 50 + 2  # the rate is what is tested
    assert account.published["imu_info"] + account.dropped["superseded"] == 200
    assert rig.on_topic["imu_data"][-1] == imu.to_cdr(imu.payload_type(accel_x=200.0))


# --- who may speak ----------------------------------------------------------------------------------------------

_SOURCES = of_peers(QUIET, hardware={"sources": ("127.0.0.2", "127.0.1.0/24")}, basestation={"sources": ("127.0.0.3",)})
_IMU = envelope(imu_info={"accel_x": 1.0})
_MODE = envelope(control_mode=payload_at(REGISTRY.by_name["control_mode"].payload_type, 1.0))


def _receive(rig: Rig, source: str, *datagrams: bytes) -> None:
    with listener(source) as sock:
        rig.receive(*datagrams, via=sock)


def test_only_who_may_say_something_is_heard() -> None:
    """A stranger is not, nor is a board that speaks for the basestation; both are counted, and handed on to nobody."""
    with Rig(_SOURCES) as rig:
        for source, datagram, outcome in (
            ("127.0.0.2", _IMU, "imu_info"),
            ("127.0.1.77", _IMU, "imu_info"),
            ("127.0.0.3", _MODE, "control_mode"),
            ("127.0.0.3", _IMU, "wrong_source"),
            ("127.0.0.2", _MODE, "wrong_source"),
            ("127.0.0.1", _IMU, "unknown_source"),
            ("127.0.2.1", b"\xff", "unknown_source"),
            ("127.0.0.2", b"\xff", "malformed"),
            ("127.0.0.2", _datagram(1), "wrong_direction"),
        ):
            before = rig.account.published + rig.account.dropped
            _receive(rig, source, datagram)
            assert rig.account.published + rig.account.dropped - before == {outcome: 1}
        assert rig.account.forwarded == {"basestation": 2}


def test_a_flood_of_one_board_does_not_use_up_the_others() -> None:
    """Each address has its allowance; what is beyond it is dropped before it is read."""
    with Rig(of_peers(QUIET, hardware={"sources": ("127.0.0.0/8",), "source_rate": 100})) as rig:
        _receive(rig, "127.0.0.2", *[_IMU] * 500)
        _receive(rig, "127.0.0.9", *[_IMU] * 10)
        account = rig.account
        assert account.published["imu_info"] + account.dropped["over_rate"] == 510
        assert 42 <= account.published["imu_info"] < 200


# --- the timekeeper ---------------------------------------------------------------------------------------------


def test_a_table_without_guards_costs_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """No thread keeps the time, and the hot path reads no addresses."""
    monkeypatch.setattr(udp, "sender_reader", lambda *_: pytest.fail("addresses are read"))
    before = [thread.name for thread in threading.enumerate()].count("timekeeper")
    with Rig() as rig:
        rig.receive(_IMU)
        assert [thread.name for thread in threading.enumerate()].count("timekeeper") == before
