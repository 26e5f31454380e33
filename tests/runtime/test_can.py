"""CAN: ISO-TP beside that of scapy, over python-can's buses in memory, between processes and over slcan; with loss."""

from __future__ import annotations

import errno
import itertools
import os
import pty
import select
import socket
import subprocess
import sys
import threading
import tty
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from bridge_rig import QUIET, Rig, end, envelope, of_peers
from hypothesis import given, settings
from hypothesis import strategies as st
from polling import wait_until

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net import transports
from roverlink.runtime.net.carrier import Carrier
from roverlink.runtime.net.transports import Connection, NotTakenError, transport_at
from roverlink.runtime.net.transports import can as kernel_can
from roverlink.transport_addresses import transport_address

can = pytest.importorskip("can", reason="need python-can (pip install python-can)")
pytest.importorskip("isotp", reason="need can-isotp (pip install can-isotp)")
from roverlink.runtime.net.transports import can_bus  # noqa: E402  # needs both

_CLASSIC, _LONG, _MIXED, _FD = "0x101 0x102", "0x18DA00F1 0x00000102", "0x101 0x18DAF100", "0x101 0x102 fd"
_SIZES = (1, 7, 8, 61, 62, 63, 64, 1000, 4095)
"""Sizes around those of a single frame, and the largest one."""
_places = (f"test-{number}" for number in itertools.count())


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine, an answer may come late."""
    for timeout in ("_FLOW_CONTROL_S", "_NEXT_FRAME_S", "_TAKEN_WITHIN_S"):
        monkeypatch.setattr(can_bus, timeout, 60.0)


def _address(place: str, ids: str, bus: str = "virtual") -> str:
    send, receive, *fd = ids.split()
    return f"can:{place}?send={send}&receive={receive}&fd={len(fd)}&bus={bus}"


def _board(place: str, ids: str, bus: str = "virtual") -> str:
    send, receive, *fd = ids.split()
    return _address(place, " ".join([receive, send, *fd]), bus)


@contextmanager
def _ends(ids: str, places: tuple[str, str], bus: str = "virtual") -> Iterator[tuple[Connection, Connection]]:
    one, other = transport_at(_address(places[0], ids, bus)), transport_at(_board(places[1], ids, bus))
    with closing(one.connect()) as ours, closing(other.connect()) as board:
        yield ours, board


def _received(connection: Connection, count: int) -> list[bytes]:
    datagrams: list[bytes] = []

    def is_complete() -> bool:
        datagrams.extend(connection.receive(0.1))
        return len(datagrams) >= count

    wait_until(is_complete, f"{count} datagrams")
    return datagrams


def _datagram(size: int) -> bytes:
    return bytes(place % 251 + 1 for place in range(size))


@pytest.mark.slow
@pytest.mark.parametrize("ids", [_CLASSIC, _LONG, _MIXED, _FD])
@settings(max_examples=10, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 1), st.one_of(st.sampled_from(_SIZES), st.integers(1, 300))), max_size=8))
def test_all_sizes_pass_in_both_directions_at_once(ids: str, sizes: list[tuple[int, int]]) -> None:
    """Datagrams of one to 4,095 bytes come out whole and in order, with identifiers of 11 and 29 bits, and with FD."""
    sent = [[_datagram(size) for end, size in sizes if end == sender] for sender in (0, 1)]
    with _ends(ids, (next(_places),) * 2) as ends:
        threads = [
            threading.Thread(target=lambda end=end, queue=queue: list(map(end.send, queue)))
            for end, queue in zip(ends, sent)
        ]
        for thread in threads:
            thread.start()
        for end, queue in zip(reversed(ends), sent):
            assert _received(end, len(queue)) == queue
        for thread in threads:
            thread.join()
        assert [end.refused for end in ends] == [0, 0]


@pytest.mark.slow
@pytest.mark.parametrize("ids", [_CLASSIC, "0x18DA00F1 0x18DAF100", _FD])  # scapy takes small numbers for 11 bits
@pytest.mark.parametrize("flow", [{}, {"bs": 3, "stmin": 1}, {"padding": True}], ids=["usual", "blocks", "padded"])
def test_scapy_understands_us_and_we_understand_scapy(ids: str, flow: dict[str, Any]) -> None:
    """The ISO-TP of scapy, which shares no code with can-isotp, takes and sends the same datagrams."""
    isotp = pytest.importorskip("scapy.contrib.isotp.isotp_soft_socket", reason="need scapy (pip install scapy)")
    buses: Any = pytest.importorskip("scapy.contrib.cansocket_python_can")
    place = next(_places)
    send, receive, *fd = ids.split()
    with closing(transport_at(_address(place, ids)).connect()) as ours:
        bus = buses.PythonCANSocket(bustype="virtual", channel=place, fd=bool(fd))
        with closing(isotp.ISOTPSoftSocket(bus, int(receive, 16), int(send, 16), fd=bool(fd), **flow)) as scapy:
            scapy.impl.fc_timeout = scapy.impl.cf_timeout = 60.0
            for datagram in map(_datagram, _SIZES):
                scapy.send(datagram)
                assert _received(ours, 1) == [datagram]
                ours.send(datagram)
                assert scapy.recv().data == datagram
        bus.close()


class _LossyBus:
    """Two buses of python-can, and a thread for each direction that copies the frames of one to the other."""

    def __init__(self) -> None:
        self.places = (next(_places), next(_places))
        self.loses = True
        self._random = Random(7)  # noqa: S311  # for chances, not for secrets
        self._buses = [can.Bus(channel=place, interface="virtual") for place in self.places]
        self._threads = [threading.Thread(target=self._copy, args=pair) for pair in itertools.permutations(self._buses)]
        self._ended = False
        for thread in self._threads:
            thread.start()

    def _copy(self, source: Any, target: Any) -> None:
        while not self._ended:
            if (frame := source.recv(0.05)) and not (self.loses and self._random.random() < 0.05):
                target.send(frame)

    def close(self) -> None:
        self._ended = True
        for thread, bus in zip(self._threads, self._buses):
            thread.join()
            bus.shutdown()


def test_a_lossy_bus_loses_whole_datagrams_and_counts_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """With 5 % of all frames lost, what arrives is whole and in order, each loss is known, and the line recovers."""
    monkeypatch.setattr(can_bus, "_FLOW_CONTROL_S", 0.1)
    sent, taken, last = [bytes([number]) + _datagram(20 + 3 * number) for number in range(60)], 0, b"the last datagram"
    with closing(_LossyBus()) as lossy, _ends(_CLASSIC, lossy.places) as (ours, board):
        for datagram in sent:
            taken += _is_taken(ours, datagram)
        lossy.loses = False
        wait_until(lambda: _is_taken(ours, last), "the board, which may be slow")
        arrived: list[bytes] = []
        while last not in arrived:
            arrived += _received(board, 1)
        arrived.remove(last)
        assert arrived == [datagram for datagram in sent if datagram in arrived]
        assert len(sent) > taken >= len(arrived) >= taken - board.refused


def _is_taken(connection: Connection, datagram: bytes) -> bool:
    try:
        connection.send(datagram)
    except NotTakenError:
        return False
    return True


def test_a_board_that_is_switched_off_costs_a_counted_datagram(monkeypatch: pytest.MonkeyPatch) -> None:
    """The carrier stays connected, counts `not_taken`, and reaches the board as soon as it is there."""
    monkeypatch.setattr(can_bus, "_FLOW_CONTROL_S", 0.1)
    place, changes = next(_places), list[str]()
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as program:
        program.bind(("127.0.0.1", 0))
        carrier = Carrier(transport_at(_address(place, _CLASSIC)), program, changes.append)
        carrier.start()
        with closing(carrier):
            wait_until(lambda: carrier.why is None, "the bus")
            program.sendto(_datagram(100), carrier.address)
            wait_until(lambda: carrier.undelivered, "the loss")
            monkeypatch.setattr(can_bus, "_FLOW_CONTROL_S", 30.0)
            with closing(transport_at(_board(place, _CLASSIC)).connect()) as board:
                board.send(_datagram(2000))
                assert program.recv(4096) == _datagram(2000)
            assert (carrier.undelivered, carrier.why, changes) == ({"not_taken": 1}, None, [""])


def test_a_board_on_can_in_a_bridge() -> None:
    """Its datagrams reach topics and other peers, a command reaches it, and nobody on the network speaks for it."""
    place = next(_places)
    imu = envelope(imu_info={"accel_z": 9.81, "is_calibrated": True, "gyro_x": 1.5})
    with (
        closing(transport_at(_board(place, _CLASSIC)).connect()) as board,
        Rig(of_peers(QUIET, hardware=end("hw", _address(place, _CLASSIC)))) as rig,
    ):
        wait_until(lambda: rig.bridge.link_states()[EndName("hardware")].state == "ok", "the bus")
        rig.receive(imu)
        board.send(imu)
        wait_until(lambda: rig.on_topic["imu_data"], "a message")
        assert rig.arrived("basestation", at_least=1) == [imu]
        assert [rig.publish("drive_motor")] == _received(board, 1)
        assert rig.bridge.account.dropped == {"wrong_source": 1}


_ECHO = """
import contextlib, sys
from roverlink.runtime.net.transports import NotTakenError, transport_at
board = transport_at(sys.argv[1]).connect()
print("ready", flush=True)
while True:
    for datagram in board.receive(1.0):
        with contextlib.suppress(NotTakenError):
            board.send(datagram[::-1])
"""


@pytest.mark.slow
@pytest.mark.parametrize("ids", [_CLASSIC, _FD])
def test_two_processes_on_one_bus(ids: str) -> None:
    """Over python-can's bus of multicast datagrams, which loses frames under load, another process answers."""
    pytest.importorskip("msgpack", reason="need msgpack (pip install msgpack)")
    group = f"239.{os.getpid() >> 16 & 255}.{os.getpid() >> 8 & 255}.{os.getpid() & 255}"
    board = subprocess.Popen([sys.executable, "-c", _ECHO, _board(group, ids, "udp_multicast")], stdout=subprocess.PIPE)
    try:
        assert board.stdout is not None
        assert board.stdout.readline() == b"ready\n"
        with closing(transport_at(_address(group, ids, "udp_multicast")).connect()) as ours:
            for datagram in map(_datagram, _SIZES):

                def is_answered(datagram: bytes = datagram) -> bool:
                    return _is_taken(ours, datagram) and datagram[::-1] in ours.receive(2.0)

                wait_until(is_answered, f"an answer of {len(datagram)} bytes")
    finally:
        board.kill()
        board.communicate()


def _copy_until(cut: threading.Event, source: int, target: int) -> None:
    while not cut.is_set():
        if select.select([source], [], [], 0.05)[0]:
            os.write(target, os.read(source, 4096))


@pytest.mark.slow
def test_an_adapter_on_a_serial_line_that_is_pulled_out() -> None:
    """Two adapters of the kind slcan, whose lines are crossed, carry datagrams; a cable that is gone is an error."""
    masters, slaves = zip(*(pty.openpty() for _ in range(2)))
    cut = threading.Event()
    threads = [threading.Thread(target=_copy_until, args=(cut, *pair)) for pair in itertools.permutations(masters)]
    places = (os.ttyname(slaves[0]), os.ttyname(slaves[1]))
    for slave in slaves:
        tty.setraw(slave)
    for thread in threads:
        thread.start()
    with _ends(_LONG, places, "slcan&bitrate=500000") as (ours, board):
        for datagram in map(_datagram, _SIZES[:-1]):
            ours.send(datagram)
            assert _received(board, 1) == [datagram]
        cut.set()
        for thread in threads:
            thread.join()
        for end in (*slaves, *masters):
            os.close(end)
        with pytest.raises(OSError, match=r"serial device|disconnected|Input/output|not open"):
            wait_until(lambda: ours.receive(0.1), "the cut")
        with pytest.raises(OSError, match=r"serial device|disconnected|Input/output|not open"):
            ours.send(b"to nobody")


class _KernelSocket(socket.socket):
    """Stands in for an ISO-TP socket of the kernel, which this machine may not have."""

    def __init__(self, *_: int) -> None:
        near, self.far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        super().__init__(fileno=near.detach())
        self.faults: list[int] = []
        self.told: list[object] = []

    def setsockopt(self, *arguments: Any) -> None:
        self.told.append(arguments)

    def bind(self, address: Any) -> None:
        self.told.append(address)

    def recv(self, *arguments: int) -> bytes:
        if self.faults:
            raise OSError(self.faults.pop(), "said by the test")
        return super().recv(*arguments)


def test_the_kernels_isotp_is_used_where_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against the kernel's interface (linux/can/isotp.h) played by a stand-in: options, identifiers and errors."""
    made: list[_KernelSocket] = []
    constants = {name: getattr(socket, name) for name in ("SOCK_DGRAM", "SOL_SOCKET", "SO_ERROR", "MSG_DONTWAIT")}
    make = lambda *arguments: made.append(_KernelSocket(*arguments)) or made[-1]  # type: ignore[func-returns-value]  # noqa: E731
    monkeypatch.setattr(kernel_can, "socket", SimpleNamespace(socket=make, AF_CAN=29, **constants))
    with closing(transport_at("can:can0?send=0x101&receive=0x00000102&fd=1").connect()) as line:
        kernel = made[-1]
        options = (106, 1, bytes.fromhex("00040000 00000000 00cccc00"))
        assert kernel.told == [options, (106, 5, bytes((72, 64, 1))), ("can0", 0x8000_0102, 0x101)]
        line.send(_datagram(100))
        assert kernel.far.recv(200) == _datagram(100)
        kernel.faults += [errno.ECOMM, errno.EILSEQ]
        kernel.far.send(_datagram(4095))
        assert line.receive(1.0) == [_datagram(4095)]
        assert line.refused == 1
        with pytest.raises(NotTakenError):
            line.send(b"after a datagram that the board did not take")
        kernel.faults.append(errno.ENETDOWN)
        kernel.far.send(b"x")
        with pytest.raises(OSError, match="said by the test"):
            line.receive(1.0)


def test_what_is_missing_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An adapter that is not there is an error of the connection, and a missing bus or package one of the set-up."""
    with pytest.raises(SetupError, match=r"no bus 'vritual'; did you mean 'virtual'\?"):
        transport_at(_address("any", _CLASSIC, "vritual"))
    with pytest.raises(OSError, match="nothing"):
        transport_at(_address(str(tmp_path / "nothing"), _CLASSIC, "slcan")).connect()
    monkeypatch.setitem(sys.modules, "can", None)
    monkeypatch.delitem(sys.modules, can_bus.__name__)
    monkeypatch.delattr(transports, "can_bus")
    with pytest.raises(SetupError, match="install them with `pip install python-can"):
        transport_at(_address("any", _CLASSIC))
    assert transport_address("can:can0?send=0x1&receive=0x2").options == {"send": "0x1", "receive": "0x2"}
