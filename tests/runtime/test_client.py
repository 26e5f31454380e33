"""The other end in Python: both clients against a real bridge, and against sockets that send them anything."""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import math
import time
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from pathlib import Path
from socket import socket
from typing import Any

import pytest
from bridge_rig import QUIET, Rig, changed, envelope, listener, of_peers, port_of, waiting
from polling import PATIENCE_S, wait_until

from generated.pb2.components.basestation.control_mode_pb2 import MODE_AUTO, BasestationControlMode
from generated.pb2.components.basestation.detected_object_pb2 import BasestationDetectedObject, BoundingBox
from generated.pb2.components.basestation.rover_localization_pb2 import BasestationRoverLocalization
from generated.pb2.components.sensor_board.imu_sensor_pb2 import SensorBoardIMUInfo
from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import DatagramError, Reason, SetupError
from roverlink.runtime.client import BlockingPeer, ClosedError, Frame, Peer
from roverlink.runtime.client.repeating import Repetition, Schedule
from roverlink.runtime.core import cdr

_ROOT = Path(__file__).parents[2]
_MODE = BasestationControlMode(mode=MODE_AUTO)
_AUTO, _MANUAL = envelope(control_mode=_MODE), envelope(control_mode={})
_WHERE, _IMU = payload_at(BasestationRoverLocalization, 1.0), payload_at(SensorBoardIMUInfo, 1.0)


@pytest.fixture
def rig() -> Iterator[Rig]:
    """A bridge that runs."""
    with Rig() as rig:
        yield rig


@contextlib.contextmanager
def _blocking(rig: Rig, name: str = "basestation") -> Iterator[BlockingPeer]:
    """A peer of a bridge, which knows its port."""
    with BlockingPeer.open(name, registry=QUIET, port=rig.bridge.port, local_port=0) as peer:
        rig.live.change({QUIET.peers_by_name[name].port_parameter: peer.port})
        yield peer


@contextlib.asynccontextmanager
async def _asyncio(rig: Rig, name: str = "basestation") -> AsyncIterator[Peer]:
    async with Peer.open(name, registry=QUIET, host="localhost", port=rig.bridge.port, local_port=0) as peer:
        rig.live.change({QUIET.peers_by_name[name].port_parameter: peer.port})
        yield peer


@pytest.fixture
def bridge() -> Iterator[socket]:
    """A socket in place of a bridge."""
    with listener() as sock:
        yield sock


def _options(bridge: socket, **options: Any) -> dict[str, Any]:
    return {"peer": "basestation", "registry": QUIET, "port": port_of(bridge), "local_port": 0, **options}


def _basestation(bridge: socket, **options: Any) -> BlockingPeer:
    return BlockingPeer.open(**_options(bridge, **options))


def _async_basestation(bridge: socket, **options: Any) -> Peer:
    return Peer.open(**_options(bridge, **options))


def _run(main: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(main, PATIENCE_S))


def _modes(rig: Rig) -> list[int]:
    message_type = REGISTRY.by_name["control_mode"].message_type
    return [cdr.decode(message_type, data).mode for data in rig.on_topic["control_mode"]]


# --- against a bridge -------------------------------------------------------------------------------------------


def test_a_blocking_basestation_talks_with_the_rover(rig: Rig) -> None:
    """Its payload becomes a message of a topic; messages of topics and forwarded datagrams become payloads."""
    with _blocking(rig) as basestation, _blocking(rig, "hardware") as hardware:
        basestation.send(_MODE)
        wait_until(lambda: _modes(rig) == [MODE_AUTO], "the mode on its topic")
        rig.publish("rover_localization", _WHERE)
        assert basestation.receive(timeout=PATIENCE_S) == (21, _WHERE)
        hardware.send(_IMU)
        assert basestation.receive(SensorBoardIMUInfo, timeout=PATIENCE_S) == _IMU
        assert (basestation.traffic.sent, basestation.traffic.received, hardware.traffic.received) == (1, 2, 0)


def test_detected_objects_arrive_as_frames(rig: Rig) -> None:
    """Complete frames with both clients; a frame that lacks a part is not among them."""

    def objects(frame_id: int, count: int) -> list[BasestationDetectedObject]:
        given = {"frame_id": frame_id, "total_count": count, "bbox": BoundingBox()}
        return [BasestationDetectedObject(**given, index=n, id=n) for n in range(count)]

    frames = [Frame(number, tuple(objects(number, count))) for number, count in ((1, 2), (2, 3), (4, 1))]
    parts = [*frames[0].parts, *frames[1].parts, objects(3, 2)[0], *frames[2].parts]
    with _blocking(rig) as blocking:
        rig.publish("detected_object", *parts)
        came = blocking.frames(BasestationDetectedObject)
        assert [next(came) for _ in frames] == frames

    async def main() -> None:
        async with _asyncio(rig) as peer:
            rig.publish("detected_object", *parts)
            came = []
            async for frame in peer.frames(BasestationDetectedObject):
                came.append(frame)
                if len(came) == len(frames):
                    peer.close()
            assert came == frames

    _run(main())


# --- sending ----------------------------------------------------------------------------------------------------

_TWO_FRONTS = dataclasses.replace(
    QUIET, handlers=(*QUIET.handlers, changed(QUIET, "control_mode", name="rear", number=99).by_number[99])
)
_NOT_OURS = "basestation cannot send imu_info: the row's direction is hardware_to_ros"


@pytest.mark.parametrize(
    ("payload", "row", "expected"),
    [
        (SensorBoardIMUInfo(), None, _NOT_OURS),
        (BoundingBox(), None, "no row of the table has the payload BoundingBox"),
        (_MODE, None, "several rows have the payload BasestationControlMode: control_mode, rear; name one with row="),
        (_MODE, "reer", "unknown row 'reer'; did you mean 'rear'?"),
        (_MODE, "imu_info", _NOT_OURS),
        (BoundingBox(), "rear", "the row 'rear' has the payload BasestationControlMode, not BoundingBox"),
    ],
)
def test_a_payload_that_no_row_carries_is_an_error_that_names_the_row(
    bridge: socket, payload: Any, row: str | None, expected: str
) -> None:
    """Nothing is sent, neither once nor repeatedly."""
    with _basestation(bridge, registry=_TWO_FRONTS) as peer:
        for send in (lambda: peer.send(payload, row), lambda: peer.repeat(payload, row, rate=10)):
            with pytest.raises(SetupError) as caught:
                send()
            assert str(caught.value) == expected
        assert peer.traffic.sent == 0


def test_datagrams_come_from_the_port_on_which_the_peer_listens(bridge: socket) -> None:
    """So a bridge can learn the address; the peer may be told another bridge; a name decides between rows."""
    with _basestation(bridge, port=1, registry=_TWO_FRONTS) as peer:
        peer.direct_to("localhost", port_of(bridge))
        assert peer.remote == f"127.0.0.1:{port_of(bridge)}"
        peer.send(_MODE, "control_mode")
        datagram, sender = bridge.recvfrom(100)
        assert (datagram, sender[1]) == (_AUTO, peer.port)


def test_a_network_that_refuses_is_an_error_of_send_and_a_count_of_repeat(bridge: socket) -> None:
    """A repeated payload may get through later."""
    with _basestation(bridge, host="255.255.255.255") as peer:
        with pytest.raises(OSError, match="Permission denied"):
            peer.send(_MODE)
        peer.repeat(_MODE, rate=10)
        assert (peer.traffic.sent, peer.traffic.unsent) == (0, 1)


# --- repeating --------------------------------------------------------------------------------------------------


def test_repetitions_are_due_at_their_rate_and_make_no_burst() -> None:
    """A program that was busy sends each datagram once, and goes on from there."""
    schedule, first, second = Schedule(), Repetition(lambda: b"a", 0.5, 1.0), Repetition(lambda: b"b", 2.0, 1.25)
    assert schedule.next_due == math.inf
    for repetition in (first, second):
        schedule.add(repetition)
    times = (0.9, 1.0, 1.25, 1.4, 1.75, 2.0, 6.0, 6.25, 6.5)
    assert [b"".join(schedule.take_due(now)) for now in times] == [b"", b"a", b"b", b"", b"a", b"a", b"ab", b"", b"a"]
    assert schedule.next_due == 7.0
    first.stop()
    assert schedule.next_due == 8.0


def test_a_blocking_peer_repeats_in_its_methods_only(bridge: socket, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program that hangs sends no commands; the last payload counts, until it is stopped or the peer is closed."""
    now = 100.0
    with _basestation(bridge) as peer:
        monkeypatch.setattr(time, "monotonic", lambda: now)

        def after(seconds: float) -> list[bytes]:
            nonlocal now
            now += seconds
            assert waiting(bridge) == []
            peer.arrived()
            return waiting(bridge)

        repetition = peer.repeat(_MODE, rate=50)
        assert waiting(bridge) == [_AUTO]
        assert [after(0.011), after(0.011), after(0.011), after(5)] == [[], [_AUTO], [], [_AUTO]]
        peer.send(BasestationControlMode())
        assert [waiting(bridge), after(0.021)] == [[_MANUAL]] * 2
        assert peer.repeat(_MODE, rate=50) is not repetition
        assert [waiting(bridge), after(0.021)] == [[_AUTO]] * 2
        peer.repeat(_MODE, rate=50).stop()
        assert [waiting(bridge), after(0.021)] == [[_AUTO], []]


@pytest.mark.slow
def test_peers_repeat_while_they_wait(bridge: socket) -> None:
    """In `receive`, or with asyncio whatever the tasks do; a closed peer sends no more."""
    with _basestation(bridge) as peer:
        peer.repeat(_MODE, rate=50)
        with pytest.raises(TimeoutError):
            peer.receive(timeout=0.4)
        assert 2 <= len(waiting(bridge)) <= 21

    async def main() -> None:
        async with _async_basestation(bridge) as peer:
            repetition = peer.repeat(_MODE, rate=50)
            assert [await asyncio.to_thread(bridge.recv, 100) for _ in range(3)] == [_AUTO] * 3
            peer.send(BasestationControlMode())
            while await asyncio.to_thread(bridge.recv, 100) != _MANUAL:
                pass
            assert [await asyncio.to_thread(bridge.recv, 100) for _ in range(3)] == [_MANUAL] * 3
            repetition.stop()
            waiting(bridge)
            await asyncio.sleep(0.05)
            assert waiting(bridge) == []
            peer.repeat(_MODE, rate=50)
        waiting(bridge)
        await asyncio.sleep(0.05)
        assert waiting(bridge) == []

    _run(main())


# --- receiving --------------------------------------------------------------------------------------------------


def _tell(peer: BlockingPeer | Peer, *datagrams: bytes) -> None:
    """Send datagrams to a peer, as the bridge does."""
    with listener() as sock:
        for datagram in datagrams:
            sock.sendto(datagram, ("127.0.0.1", peer.port))


def test_what_is_no_payload_is_counted_and_disturbs_nothing(bridge: socket) -> None:
    """By reason; trailing zeros, stripped or appended, are understood."""
    with _basestation(bridge) as peer:
        _tell(peer, b"\xff" * 5, b"", bytes.fromhex("ca01"), _AUTO + bytes(9), bytes.fromhex("6a"), _AUTO)
        payloads = [peer.receive(timeout=PATIENCE_S) for _ in range(3)]
        assert payloads == [(16, _MODE), (13, SensorBoardIMUInfo()), (16, _MODE)]
        assert peer.traffic.dropped == {"malformed": 1, "empty": 1, "unknown_payload": 1}
        assert peer.traffic.received == 6


def test_a_program_that_is_too_slow_gets_the_newest_payloads(bridge: socket) -> None:
    """The oldest are dropped and counted."""
    with _basestation(bridge, queue=10) as peer:
        _tell(peer, *(envelope(imu_info={"accel_x": float(number)}) for number in range(200)))
        payloads = [received.payload for received in peer.arrived()]
        assert [payload.accel_x for payload in payloads] == list(range(190, 200))  # type: ignore[attr-defined]
        assert (peer.traffic.received, peer.traffic.overflowed) == (200, 190)
        assert peer.arrived() == []


def test_waiting_for_a_class_leaves_the_others_where_they_are(bridge: socket) -> None:
    """In their order, for other calls and, with asyncio, for other tasks."""
    datagrams = [envelope(imu_info={"accel_x": 1.0}), _AUTO, envelope(imu_info={"accel_x": 2.0})]
    with _basestation(bridge) as peer:
        _tell(peer, *datagrams)
        assert peer.receive(BasestationControlMode, PATIENCE_S) == _MODE
        assert [peer.receive(SensorBoardIMUInfo).accel_x for _ in range(2)] == [1.0, 2.0]

    async def main() -> None:
        async with _async_basestation(bridge) as peer:
            waiting = [
                asyncio.create_task(peer.receive(kind))  # type: ignore[arg-type]
                for kind in (BasestationControlMode, SensorBoardIMUInfo, SensorBoardIMUInfo)
            ]
            await asyncio.sleep(0)
            _tell(peer, *datagrams)
            mode, first, second = await asyncio.gather(*waiting)
            assert mode == _MODE
            assert {first.accel_x, second.accel_x} == {1.0, 2.0}

    _run(main())


# --- hooks ------------------------------------------------------------------------------------------------------


class _Mark:
    """A hook that appends a letter, and wants it back."""

    def __init__(self, letter: bytes) -> None:
        self._letter = letter

    def outgoing(self, datagram: bytes) -> bytes:
        return datagram + self._letter

    def incoming(self, datagram: bytes) -> bytes | None:
        if datagram == b"for the hook":
            return None
        if not datagram.endswith(self._letter):
            raise DatagramError(Reason.WRONG_SOURCE, "no mark")
        return datagram[:-1]


def test_hooks_see_every_datagram(bridge: socket) -> None:
    """The last hook is the nearest one to the network; refused and consumed datagrams are counted."""
    with _basestation(bridge, hooks=[_Mark(b"a"), _Mark(b"b")]) as peer:
        peer.send(_MODE)
        peer.send_every(60, lambda: b"own")
        assert [bridge.recv(100) for _ in range(2)] == [_AUTO + b"ab", b"ownab"]
        _tell(peer, _AUTO, _AUTO + b"ba", b"for the hook", _AUTO + b"ab")
        assert peer.receive(timeout=PATIENCE_S) == (16, _MODE)
        assert peer.traffic.dropped == {"wrong_source": 2}
        assert peer.traffic.consumed == 1


# --- opening and closing ----------------------------------------------------------------------------------------


def test_iteration_ends_when_the_peer_is_closed(bridge: socket) -> None:
    """In the loop's body, and with asyncio by another task, too."""
    with _basestation(bridge) as peer:
        _tell(peer, _AUTO, _AUTO)
        for _ in peer:
            peer.close()

    async def main() -> None:
        async with _async_basestation(bridge) as peer:
            asyncio.get_running_loop().call_later(0.05, peer.close)
            async for _ in peer:
                raise AssertionError
            with pytest.raises(ClosedError):
                await peer.receive()

    _run(main())


@pytest.mark.parametrize("was_open", [False, True])
def test_a_peer_that_is_not_open_says_so(bridge: socket, was_open: bool) -> None:
    """Before its block and behind it."""
    peer = _basestation(bridge)
    peer.close()
    _async_basestation(bridge).close()
    if was_open:
        with peer:
            peer.close()
    uses: list[Callable[[], object]] = [lambda: peer.send(_MODE), lambda: peer.repeat(_MODE, rate=1), peer.receive]
    for use in (*uses, lambda: next(iter(peer))):
        with pytest.raises(ClosedError, match="basestation is not open; use it inside its `with` block"):
            use()


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"peer": "basestaton"}, "unknown peer 'basestaton'; did you mean 'basestation'?"),
        ({"host": "rover.invalid"}, "the destination 'rover.invalid' does not resolve"),
        ({"local_port": "in use"}, "in use by another program; stop that program or choose another port"),
    ],
)
def test_what_cannot_be_opened_is_one_clear_error(bridge: socket, options: dict[str, Any], expected: str) -> None:
    """The same with both clients."""
    given = _options(bridge, local_address="127.0.0.1", **options)
    if given["local_port"] == "in use":
        given["local_port"] = port_of(bridge)

    async def main() -> None:
        async with Peer.open(**given):
            pass

    with pytest.raises(SetupError) as caught, BlockingPeer.open(**given):
        pass
    assert expected in str(caught.value)
    with pytest.raises(SetupError) as caught:
        _run(main())
    assert expected in str(caught.value)


def test_without_options_the_table_and_the_bridge_s_defaults_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """The registry on the import path, the port of the bridge, and the peer's own port of the table."""
    monkeypatch.chdir("/")
    assert BlockingPeer.open("basestation").remote == "127.0.0.1:5000"
    with listener("0.0.0.0") as held:  # noqa: S104
        peer = BlockingPeer.open("basestation", registry=of_peers(QUIET, basestation={"port": port_of(held)}))
        with pytest.raises(SetupError, match=rf"UDP port {port_of(held)} on 0\.0\.0\.0 is in use"), peer:
            pass
