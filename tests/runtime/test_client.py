"""The other end in Python: both clients against a real bridge, and against sockets that send them anything."""

from __future__ import annotations

import asyncio
import contextlib
import dataclasses
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Coroutine, Iterator
from pathlib import Path
from typing import Any

import pytest
from polling import PATIENCE_S, wait_until
from rig import changed, unguarded

from generated.pb2.components.basestation.control_mode_pb2 import MODE_AUTO, BasestationControlMode
from generated.pb2.components.basestation.detected_object_pb2 import BasestationDetectedObject, BoundingBox
from generated.pb2.components.basestation.rover_localization_pb2 import BasestationRoverLocalization
from generated.pb2.components.sensor_board.imu_sensor_pb2 import SensorBoardIMUInfo
from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import DatagramError, Reason, Registry, SetupError
from roverlink.runtime.client import BlockingPeer, ClosedError, Frame, Peer
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware import Middleware, NodeIdentity
from roverlink.runtime.net import udp
from roverlink.simulation.bridge_host import BridgeThread

_QUIET = unguarded(REGISTRY)  # the bridge's own stops have tests of their own
_ROOT = Path(__file__).parents[2]
_MODE = BasestationControlMode(mode=MODE_AUTO)


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        port: int = sock.getsockname()[1]
        return port


class _Rover:
    """A bridge with topics in memory, and what its peers need to reach it."""

    def __init__(self, stack: contextlib.ExitStack) -> None:
        self.peer_ports = {peer.name: _free_port() for peer in _QUIET.peers}
        ports = {peer.port_parameter: self.peer_ports[peer.name] for peer in _QUIET.peers}
        self.host = stack.enter_context(BridgeThread(_QUIET, ports, "error"))
        self._nodes: Middleware = self.host.middleware(NodeIdentity("test"))

    def options(self, peer: str) -> dict[str, Any]:
        """The options of `Peer.open` for a peer of this bridge."""
        return {"registry": _QUIET, "port": self.host.port, "local_port": self.peer_ports[peer]}

    def publish(self, name: str, *payloads: Any) -> None:
        """Publish as a node of ROS 2 does."""
        handler = _QUIET.by_name[name]
        publisher = self._nodes.publisher(f"/{handler.route.topic}", handler.message_type, handler.route.qos)
        publisher.publish([handler.to_cdr(payload) for payload in payloads])

    def heard(self, name: str) -> list[Message]:
        """The messages on a topic, which grow."""
        handler, messages = _QUIET.by_name[name], list[Message]()
        self._nodes.subscribe(
            f"/{handler.route.topic}",
            handler.message_type,
            handler.route.qos,
            lambda batch: messages.extend(cdr.decode(handler.message_type, data) for data in batch),
        )
        return messages


@pytest.fixture
def rover() -> Iterator[_Rover]:
    """A bridge that runs."""
    with contextlib.ExitStack() as stack:
        yield _Rover(stack)


@pytest.fixture
def bridge() -> Iterator[socket.socket]:
    """A socket in place of a bridge."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(PATIENCE_S)
        yield sock


def _basestation(bridge: socket.socket, **options: Any) -> BlockingPeer:
    given = {"registry": _QUIET, "port": bridge.getsockname()[1], "local_port": 0, **options}
    return BlockingPeer.open("basestation", **given)


def _async_basestation(bridge: socket.socket, **options: Any) -> Peer:
    given = {"registry": _QUIET, "port": bridge.getsockname()[1], "local_port": 0, **options}
    return Peer.open("basestation", **given)


def _run(main: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(main, PATIENCE_S))


def _envelope(**payloads: Any) -> bytes:
    return REGISTRY.envelope(**payloads).SerializeToString()


def _objects(frame_id: int, count: int) -> list[BasestationDetectedObject]:
    given = {"frame_id": frame_id, "total_count": count, "bbox": BoundingBox()}
    return [BasestationDetectedObject(**given, index=n, id=n) for n in range(count)]


# --- against a bridge -------------------------------------------------------------------------------------------


def test_a_blocking_basestation_talks_with_the_rover(rover: _Rover) -> None:
    """Its payload becomes a message of a topic; messages of topics and forwarded datagrams become payloads."""
    modes = rover.heard("control_mode")
    where = payload_at(BasestationRoverLocalization, 1.0)
    imu = payload_at(SensorBoardIMUInfo, 1.0)
    with (
        BlockingPeer.open("basestation", **rover.options("basestation")) as basestation,
        BlockingPeer.open("hardware", **rover.options("hardware")) as hardware,
    ):
        basestation.send(_MODE)
        wait_until(lambda: modes, "the mode on its topic")
        assert [message.mode for message in modes] == [MODE_AUTO]  # type: ignore[attr-defined]
        rover.publish("rover_localization", where)
        assert basestation.receive(timeout=PATIENCE_S) == (21, where)
        hardware.send(imu)
        assert basestation.receive(SensorBoardIMUInfo, timeout=PATIENCE_S) == imu
        assert (basestation.traffic.sent, basestation.traffic.received, hardware.traffic.received) == (1, 2, 0)


def test_a_bridge_may_have_an_ipv6_address(registry: Registry) -> None:
    """Both clients send to it, and hear it on the same port."""
    with udp.bind("::1", 0, 65_536) as bridge:
        options: dict[str, Any] = {
            "registry": registry,
            "host": "::1",
            "port": bridge.getsockname()[1],
            "local_port": 0,
        }

        def answer() -> None:
            datagram, sender = bridge.recvfrom(65_536)
            bridge.sendto(datagram, sender)

        async def main() -> None:
            async with Peer.open("basestation", **options) as peer:
                peer.send(_MODE)
                answer()
                assert (await peer.receive()).payload == _MODE

        with BlockingPeer.open("basestation", **options) as peer:
            peer.send(_MODE)
            answer()
            assert peer.receive(timeout=PATIENCE_S).payload == _MODE
        _run(main())


def test_an_asyncio_basestation_talks_with_the_rover(rover: _Rover) -> None:
    """In the same ways."""
    modes = rover.heard("control_mode")
    where = payload_at(BasestationRoverLocalization, 1.0)
    imu = payload_at(SensorBoardIMUInfo, 1.0)

    async def main() -> None:
        async with (
            Peer.open("basestation", host="localhost", **rover.options("basestation")) as basestation,
            Peer.open("hardware", **rover.options("hardware")) as hardware,
        ):
            basestation.send(_MODE)
            while not modes:
                await asyncio.sleep(0.01)
            rover.publish("rover_localization", where)
            hardware.send(imu)
            assert await basestation.receive(SensorBoardIMUInfo) == imu
            async for number, payload in basestation:
                assert (number, payload) == (21, where)
                break

    _run(main())
    assert [message.mode for message in modes] == [MODE_AUTO]  # type: ignore[attr-defined]


def test_detected_objects_arrive_as_frames(rover: _Rover) -> None:
    """Complete frames with both clients; a frame that lacks a part is not among them."""
    frames = [_objects(1, 2), _objects(2, 3), _objects(4, 1)]
    wanted = [Frame(1, tuple(frames[0])), Frame(2, tuple(frames[1])), Frame(4, tuple(frames[2]))]

    def publish() -> None:
        for objects in [*frames[:2], _objects(3, 2)[:1], *frames[2:]]:
            rover.publish("detected_object", *objects)

    with BlockingPeer.open("basestation", **rover.options("basestation")) as blocking:
        publish()
        came = blocking.frames(BasestationDetectedObject)
        assert [next(came) for _ in wanted] == wanted

    async def main() -> None:
        async with Peer.open("basestation", **rover.options("basestation")) as peer:
            publish()
            came = []
            async for frame in peer.frames(BasestationDetectedObject):
                came.append(frame)
                if len(came) == len(wanted):
                    peer.close()
            assert came == wanted

    _run(main())


# --- sending ----------------------------------------------------------------------------------------------------

_TWO_FRONTS = dataclasses.replace(
    _QUIET,
    handlers=(*_QUIET.handlers, changed(_QUIET, "control_mode", name="rear", number=99).by_number[99]),
)


@pytest.mark.parametrize(
    ("payload", "row", "expected"),
    [
        (SensorBoardIMUInfo(), None, "basestation cannot send imu_info: the row's direction is hardware_to_ros"),
        (
            BasestationDetectedObject(),
            None,
            "basestation cannot send detected_object: the row's direction is ros_to_basestation",
        ),
        (BoundingBox(), None, "no row of the table has the payload BoundingBox"),
        (_MODE, None, "several rows have the payload BasestationControlMode: control_mode, rear; name one with row="),
        (_MODE, "reer", "unknown row 'reer'; did you mean 'rear'?"),
        (_MODE, "imu_info", "basestation cannot send imu_info: the row's direction is hardware_to_ros"),
        (BoundingBox(), "rear", "the row 'rear' has the payload BasestationControlMode, not BoundingBox"),
    ],
)
def test_a_payload_that_no_row_carries_is_an_error_that_names_the_row(
    bridge: socket.socket, payload: Any, row: str | None, expected: str
) -> None:
    """Nothing is sent, neither once nor repeatedly."""
    with _basestation(bridge, registry=_TWO_FRONTS) as peer:
        for send in (lambda: peer.send(payload, row), lambda: peer.repeat(payload, 10, row)):
            with pytest.raises(SetupError) as caught:
                send()
            assert str(caught.value) == expected
        assert peer.traffic.sent == 0


def test_a_name_decides_between_rows_of_one_type(bridge: socket.socket) -> None:
    """The row that is named carries the payload."""
    with _basestation(bridge, registry=_TWO_FRONTS) as peer:
        peer.send(_MODE, "control_mode")
    assert bridge.recv(100) == _envelope(control_mode=_MODE)


def test_datagrams_come_from_the_port_on_which_the_peer_listens(bridge: socket.socket) -> None:
    """So a bridge that learns an address can answer there, and the peer may be told another bridge while it is open."""
    with _basestation(bridge, port=1) as peer:
        peer.direct_to("localhost", bridge.getsockname()[1])
        assert peer.remote == f"127.0.0.1:{bridge.getsockname()[1]}"
        peer.send(_MODE)
        _, sender = bridge.recvfrom(100)
        assert sender[1] == peer.port


def test_a_network_that_refuses_is_an_error_of_send_and_a_count_of_repeat(bridge: socket.socket) -> None:
    """A repeated payload may get through later."""
    with _basestation(bridge, host="255.255.255.255") as peer:
        with pytest.raises(OSError, match="Permission denied"):
            peer.send(_MODE)
        peer.repeat(_MODE, 10)
        assert (peer.traffic.sent, peer.traffic.unsent) == (0, 1)


# --- repeating --------------------------------------------------------------------------------------------------


def _waiting(sock: socket.socket) -> list[bytes]:
    """The datagrams that have arrived at a socket."""
    found: list[bytes] = []
    sock.setblocking(False)
    with contextlib.suppress(BlockingIOError):
        while True:
            found.append(sock.recv(65_536))
    sock.settimeout(PATIENCE_S)
    return found


def _nap(peer: BlockingPeer, seconds: float) -> None:
    with contextlib.suppress(TimeoutError):
        peer.receive(timeout=seconds)


def test_a_blocking_peer_repeats_while_it_waits(bridge: socket.socket) -> None:
    """At the rate; the last payload that was sent; until it is stopped or the peer is closed."""
    auto, manual = _envelope(control_mode=_MODE), _envelope(control_mode=BasestationControlMode())
    with _basestation(bridge) as peer:
        repetition = peer.repeat(_MODE, 50)
        assert bridge.recv(100) == auto
        _nap(peer, 0.5)
        arrived = _waiting(bridge)
        assert 5 <= len(arrived) <= 26
        assert set(arrived) == {auto}
        peer.send(BasestationControlMode())
        _nap(peer, 0.1)
        assert set(_waiting(bridge)) == {manual}
        assert peer.repeat(_MODE, 50) is not repetition
        _nap(peer, 0.1)
        assert set(_waiting(bridge)) == {auto}
        time.sleep(0.2)  # not in a method of the peer: a program that hangs sends no commands
        assert _waiting(bridge) == []
        peer.arrived()
        assert _waiting(bridge) == [auto]  # and no burst afterwards
        peer.repeat(_MODE, 50).stop()
        _waiting(bridge)
        _nap(peer, 0.1)
        assert _waiting(bridge) == []


def test_an_asyncio_peer_repeats_while_the_loop_runs(bridge: socket.socket) -> None:
    """Also while no task waits for a payload; a closed peer sends no more."""

    async def main() -> None:
        async with _async_basestation(bridge) as peer:
            repetition = peer.repeat(_MODE, 50)
            await asyncio.sleep(0.3)
            assert 3 <= len(_waiting(bridge)) <= 16
            peer.send(BasestationControlMode())
            await asyncio.sleep(0.1)
            assert set(_waiting(bridge)) == {_envelope(control_mode=BasestationControlMode())}
            repetition.stop()
            await asyncio.sleep(0.1)
            _waiting(bridge)
            await asyncio.sleep(0.1)
            assert _waiting(bridge) == []
            peer.repeat(_MODE, 50)
        _waiting(bridge)
        await asyncio.sleep(0.1)
        assert _waiting(bridge) == []

    _run(main())


# --- receiving --------------------------------------------------------------------------------------------------


def _tell(peer: BlockingPeer | Peer, *datagrams: bytes) -> None:
    """Send datagrams to a peer, as the bridge does."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for datagram in datagrams:
            sock.sendto(datagram, ("127.0.0.1", peer.port))


def test_what_is_no_payload_is_counted_and_disturbs_nothing(bridge: socket.socket) -> None:
    """By reason; trailing zeros, stripped or appended, are understood."""
    mode = _envelope(control_mode=_MODE)
    datagrams = [b"\xff" * 5, b"", bytes.fromhex("ca01"), mode + bytes(9), bytes.fromhex("6a"), mode]
    with _basestation(bridge) as peer:
        _tell(peer, *datagrams)
        assert [peer.receive(timeout=PATIENCE_S) for _ in range(3)] == [
            (16, _MODE),
            (13, SensorBoardIMUInfo()),
            (16, _MODE),
        ]
        assert peer.traffic.dropped == {"malformed": 1, "empty": 1, "unknown_payload": 1}
        assert peer.traffic.received == 6


def test_a_program_that_is_too_slow_gets_the_newest_payloads(bridge: socket.socket) -> None:
    """The oldest are dropped and counted."""
    with _basestation(bridge, queue=10) as peer:
        _tell(peer, *(_envelope(imu_info={"accel_x": float(number)}) for number in range(200)))
        payloads = [received.payload for received in peer.arrived()]
        assert [payload.accel_x for payload in payloads] == list(range(190, 200))  # type: ignore[attr-defined]
        assert (peer.traffic.received, peer.traffic.overflowed) == (200, 190)
        assert peer.arrived() == []


def test_waiting_for_a_class_leaves_the_others_where_they_are(bridge: socket.socket) -> None:
    """In their order, for other calls and, with asyncio, for other tasks."""
    datagrams = [
        _envelope(imu_info={"accel_x": 1.0}),
        _envelope(control_mode=_MODE),
        _envelope(imu_info={"accel_x": 2.0}),
    ]
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


def test_a_timeout_ends_the_waiting(bridge: socket.socket) -> None:
    """With the error of Python, and with asyncio's own means; the peer goes on."""
    with _basestation(bridge) as peer, pytest.raises(TimeoutError, match=r"no payload has arrived for 0\.01 s"):
        peer.receive(timeout=0.01)

    async def main() -> None:
        async with _async_basestation(bridge) as peer:
            with pytest.raises(asyncio.TimeoutError):
                await asyncio.wait_for(peer.receive(), 0.01)
            _tell(peer, _envelope(control_mode=_MODE))
            assert await peer.receive() == (16, _MODE)

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


def test_hooks_see_every_datagram(bridge: socket.socket) -> None:
    """The last hook is the nearest one to the network; refused and consumed datagrams are counted."""
    mode = _envelope(control_mode=_MODE)
    with _basestation(bridge, hooks=[_Mark(b"a"), _Mark(b"b")]) as peer:
        peer.send(_MODE)
        peer.send_every(60, lambda: b"own")
        assert [bridge.recv(100) for _ in range(2)] == [mode + b"ab", b"ownab"]
        _tell(peer, mode, mode + b"ba", b"for the hook", mode + b"ab")
        assert peer.receive(timeout=PATIENCE_S) == (16, _MODE)
        assert peer.traffic.dropped == {"wrong_source": 2}
        assert peer.traffic.consumed == 1


# --- opening and closing ----------------------------------------------------------------------------------------


def test_iteration_ends_when_the_peer_is_closed(bridge: socket.socket) -> None:
    """In the loop's body, and with asyncio by another task, too."""
    with _basestation(bridge) as peer:
        _tell(peer, _envelope(control_mode=_MODE), _envelope(control_mode=_MODE))
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
def test_a_peer_that_is_not_open_says_so(bridge: socket.socket, was_open: bool) -> None:
    """Before its block and behind it."""
    peer = _basestation(bridge)
    peer.close()
    _async_basestation(bridge).close()
    if was_open:
        with peer:
            peer.close()
    uses: list[Callable[[], object]] = [lambda: peer.send(_MODE), lambda: peer.repeat(_MODE, 1), peer.receive]
    for use in (*uses, lambda: next(iter(peer))):
        with pytest.raises(ClosedError, match="basestation is not open; use it inside its `with` block"):
            use()


def test_a_closed_peer_leaves_its_port_free(bridge: socket.socket) -> None:
    """At once, so that the next one can have it."""
    port = _free_port()

    async def main() -> None:
        for _ in range(3):
            async with _async_basestation(bridge, local_port=port) as peer:
                assert peer.port == port

    _run(main())
    with _basestation(bridge, local_port=port):
        pass


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"peer": "basestaton"}, "unknown peer 'basestaton'; did you mean 'basestation'?"),
        ({"host": "rover.invalid"}, "the destination 'rover.invalid' does not resolve"),
        ({"local_port": "in use"}, "in use by another program; stop that program or choose another port"),
    ],
)
def test_what_cannot_be_opened_is_one_clear_error(
    bridge: socket.socket, options: dict[str, Any], expected: str
) -> None:
    """The same with both clients."""
    given = {"peer": "basestation", "registry": _QUIET, "local_address": "127.0.0.1", "local_port": 0, **options}
    if given["local_port"] == "in use":
        given["local_port"] = bridge.getsockname()[1]

    async def main() -> None:
        async with Peer.open(**given):
            pass

    with pytest.raises(SetupError) as caught, BlockingPeer.open(**given):
        pass
    assert expected in str(caught.value)
    with pytest.raises(SetupError) as caught:
        _run(main())
    assert expected in str(caught.value)


def test_without_options_the_table_and_the_bridge_s_defaults_count(
    registry: Registry, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The registry on the import path, the port of the bridge, and the peer's own port of the table."""
    monkeypatch.chdir("/")
    peer = BlockingPeer.open("basestation")
    assert (peer.remote, peer._local) == ("127.0.0.1:5000", ("0.0.0.0", 6000))  # noqa: S104


_MODULES = """
import sys
from roverlink.runtime.client import BlockingPeer, Peer
from roverlink.runtime import load_registry
with BlockingPeer.open("basestation", registry=load_registry("."), local_port=0) as peer:
    peer.arrived()
print(*sorted(name for name in sys.modules if name.split(".")[0] in {"rclpy", "cyclonedds", "rosbags"}))
print(*sorted({".".join(name.split(".")[:3]) for name in sys.modules if name.startswith("roverlink.")}))
"""


def test_the_client_imports_neither_ros_nor_the_generator() -> None:
    """Only the parts of the runtime that it needs, although ROS 2 may be installed."""
    done = subprocess.run([sys.executable, "-c", _MODULES], cwd=_ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    others, ours = done.stdout.splitlines()
    assert others == ""
    parts = {"atomic_files", "client", "core", "interfaces", "keys", "net", "private_files", "ros_arguments", "text"}
    assert set(ours.split()) == {"roverlink.runtime", *(f"roverlink.runtime.{part}" for part in parts)}
