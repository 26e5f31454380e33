"""Section `lines`: a serial line, TCP and CAN beside UDP, from a board to the topic, and what a datagram costs."""

import contextlib
import dataclasses
import logging
import os
import pty
import socket
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from typing import Any

from bench.errors import BenchError
from bench.lab import Lab
from bench.result import Group, SectionResult, Table
from bench.rig import free_port
from generated.registry import REGISTRY
from roverlink.runtime import Bridge
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.net.transports import transport_at
from roverlink.runtime.net.transports.framing import delimited, encode_frame
from roverlink.runtime.ros_arguments import parameters

_WINDOW = 64
"""Largest number of datagrams on their way: none gets lost, and the bridge always has work."""
_MBAUD = 100_000
"""Bytes a second of a serial line with 1 Mbaud: ten bits are a byte."""
_START_S = 10.0
_PAUSE_S = 0.0005
_AXES = ("accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z")
_SAMPLE: bytes = REGISTRY.envelope(imu_info=dict.fromkeys(_AXES, 1.5)).SerializeToString()

Write = Callable[[], object]
"""Function that sends one sample as a board does."""
Line = Callable[[], AbstractContextManager[tuple[str, Callable[[int], Write]]]]
"""Line of a board: its host in the table, empty for UDP, and a function that connects to a bridge, given its port."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Rate and cost of a line; the CPU is that of the bridge's threads, without the board's."""

    line: str
    per_second: float
    cpu_us: float


def measure(lab: Lab) -> SectionResult:
    """Flood the bridge over each kind of line, and send at the rate of a real serial line."""
    costs = []
    lines: list[tuple[str, Line, int | None]] = [
        ("UDP", _udp, None),
        ("TCP", _tcp, None),
        ("serial (pseudo-terminal)", _serial, None),
        ("serial at 1 Mbaud", _serial, _MBAUD),
    ]
    lines += [("CAN (in memory), with the board", _can, None)] if find_spec("isotp") else []
    for name, line, limit in lines:
        costs.append(_cost(name, line, limit, lab.seconds))
        lab.say(f"{name}: {costs[-1].per_second:,.0f}/s, {costs[-1].cpu_us:.1f} us of CPU each")
    rows = [
        (one.line, f"{one.per_second:,.0f}", f"{one.cpu_us:.1f}", f"{one.per_second * one.cpu_us / 1e4:.0f} %")
        for one in costs
    ]
    notes = [
        f"A sample of the IMU ({len(_SAMPLE)} bytes) on its topic, without ROS 2 and without the native core.",
        "CAN is ISO-TP of can-isotp on a bus of python-can in memory. The CPU is that of both ends.",
    ]
    table = Table("Lines of boards", ("line", "datagrams/s", "CPU us each", "of a core"), [Group("", rows)], notes)
    return SectionResult([table], data={"costs": [*map(asdict, costs)]})


@contextlib.contextmanager
def _udp() -> Iterator[tuple[str, Callable[[int], Write]]]:
    with socket.socket(type=socket.SOCK_DGRAM) as sock:
        yield "", lambda port: lambda: sock.sendto(_SAMPLE, ("127.0.0.1", port))


@contextlib.contextmanager
def _tcp() -> Iterator[tuple[str, Callable[[int], Write]]]:
    with socket.socket() as sock:
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        port, message = free_port(), delimited(_SAMPLE)

        def connect(_: int) -> Write:
            _wait_until(lambda: sock.connect_ex(("127.0.0.1", port)) == 0)
            return lambda: sock.sendall(message)

        yield f"tcp:127.0.0.1:{port}?listen", connect


@contextlib.contextmanager
def _serial() -> Iterator[tuple[str, Callable[[int], Write]]]:
    board, device = pty.openpty()
    tty.setraw(device)
    frame = encode_frame(_SAMPLE)
    yield f"serial:{os.ttyname(device)}?baud=1000000", lambda _: lambda: os.write(board, frame)
    os.close(board)
    os.close(device)


@contextlib.contextmanager
def _can() -> Iterator[tuple[str, Callable[[int], Write]]]:
    with contextlib.closing(transport_at("can:bench?bus=virtual&send=0x102&receive=0x101").connect()) as board:
        yield "can:bench?bus=virtual&send=0x101&receive=0x102", lambda _: lambda: board.send(_SAMPLE)


def _cost(name: str, line: Line, limit: int | None, seconds: float) -> Cost:
    with line() as (host, connect):
        change: dict[str, Any] = {"host": host, "host_parameter": "hardware_host"} if host else {}
        peers = [dataclasses.replace(one, **change) if one.name == "hardware" else one for one in REGISTRY.peers]
        registry = dataclasses.replace(REGISTRY, peers=tuple(peers))
        settings = parameters.read(registry, {"listen_port": 0, "listen_address": "127.0.0.1"})
        with Bridge(
            registry, settings, MemoryMiddleware(Graph()), "/{}".format, logging.Logger("bench", logging.CRITICAL)
        ) as bridge:
            write = connect(bridge.port)
            # What a board sends before the bridge has opened the device is lost.
            _wait_until(lambda: (write(), bridge.account.received > 0)[1])
            first, cpu_of_board, began, cpu = (
                bridge.account.received,
                list[float](),
                time.perf_counter(),
                time.process_time(),
            )
            board = threading.Thread(target=lambda: cpu_of_board.append(_send(write, bridge, limit, began + seconds)))
            board.start()
            board.join()
            took, cpu = time.perf_counter() - began, time.process_time() - cpu - cpu_of_board[0]
            count = bridge.account.received - first
            bridge.stop()
            bridge.run()
    return Cost(name, count / took, cpu / count * 1e6)


def _send(write: Write, bridge: Bridge, limit: int | None, end: float) -> float:
    """Send samples until a time, and until one has arrived; return the CPU time of this thread in seconds.

    ``limit`` is the number of bytes that the line carries in a second.
    """
    cpu, began, sent, first = time.thread_time(), time.perf_counter(), 0, bridge.account.received
    interval = len(encode_frame(_SAMPLE)) / limit if limit else 0.0
    while (now := time.perf_counter()) < end or bridge.account.received == first:
        if now < began + sent * interval or sent - (bridge.account.received - first) >= _WINDOW:
            time.sleep(_PAUSE_S)
        else:
            write()
            sent += 1
    return time.thread_time() - cpu


def _wait_until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + _START_S
    while not condition():
        if time.monotonic() > deadline:
            raise BenchError(f"the line did not work within {_START_S:g} s")
        time.sleep(0.01)
