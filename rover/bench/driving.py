"""Benchmarks of driving: from a velocity to the datagram at the board, and how fast the rover stops.

The bridge and `roverlink drive` are processes of their own. This process is the controller, the basestation and the
board. The floor is the bridge alone, to which this process publishes drive commands itself.
"""

from __future__ import annotations

import argparse
import random
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any, cast

from rich.console import Console

from bench.contestants import ROOT
from bench.errors import BenchError
from bench.report import report
from bench.result import Group, SectionResult, Table
from generated.messages import DrivingBoardMotorMessage
from generated.registry import REGISTRY
from rover.bench.video.radio_link import HOST, RadioLink
from roverlink.console import isolate_ros
from roverlink.dds_domain import UNTIL_EXIT
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.geometry_msgs import Twist, Vector3
from roverlink.runtime.middleware import Middleware, NodeIdentity
from roverlink.simulation.bridge_host import BridgeProcess

_PERIOD_S = 0.05
_START_S = 30.0
_SPEED = 0.3
_NEAREST, _STEP = 2.0, 0.001
"""Radius in metres of the first command, and its change from one command to the next, by which they are told apart.

Every other arc is to the right: `roverlink drive` sends a velocity at once only if it differs from the last one."""
_LOSS = 0.05


class _Board:
    """Socket of the driving board: the commands that arrive, with the times of their arrival in seconds."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind((HOST, 0))
        self.port: int = self._socket.getsockname()[1]
        self.arrivals: list[tuple[float, float, float]] = []
        """Time, distance_to_go and turning_radius of each command."""
        threading.Thread(target=self._receive, daemon=True).start()

    def _receive(self) -> None:
        while True:
            data = self._socket.recv(65_536)
            now = time.perf_counter()
            envelope: Any = REGISTRY.envelope.FromString(data)
            if envelope.WhichOneof("payload") == "drive_motor":
                command = envelope.drive_motor
                self.arrivals.append((now, command.distance_to_go, command.turning_radius))

    def last_moving(self) -> float:
        """Time of the last command that moves the rover."""
        return next((at for at, distance, _ in reversed(self.arrivals) if distance), 0.0)

    def wait_for_moving(self, since: float) -> None:
        """Wait for a command that moves the rover, after a time."""
        _wait_for("command", lambda: self.last_moving() > since)


class _Basestation:
    """Sender of the mode, again and again."""

    def __init__(self, port: int) -> None:
        self._socket, self._to = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), (HOST, port)
        self._mode: int | None = 1
        threading.Thread(target=self._repeat, daemon=True).start()

    def set_mode(self, mode: int | None) -> float:
        """Send another mode from now on, or nothing; return the time in seconds."""
        self._mode, now = mode, time.perf_counter()
        self._send()
        return now

    def _send(self) -> None:
        if self._mode is not None:
            self._socket.sendto(REGISTRY.envelope(control_mode={"mode": self._mode}).SerializeToString(), self._to)

    def _repeat(self) -> None:
        while True:
            time.sleep(_PERIOD_S)
            self._send()


@contextmanager
def _rover(middleware: str, *, drives: bool, loss: float = 0.0) -> Iterator[tuple[_Board, _Basestation, Middleware]]:
    """Start the bridge and, if it drives, `roverlink drive`. Yields the board, the basestation and a node."""
    with ExitStack() as held:
        board = _Board()
        out = held.enter_context(RadioLink([board.port], loss=loss)).ports[0] if loss else board.port
        bridge = held.enter_context(BridgeProcess(ROOT, middleware, {"dst_b_port": out}, "error"))
        back = held.enter_context(RadioLink([bridge.port], loss=loss)).ports[0] if loss else bridge.port
        if drives:
            command = [sys.executable, "-m", "roverlink", "drive", "--middleware", middleware]
            process = held.enter_context(
                subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)  # noqa: S603  # our own program
            )
            held.callback(process.terminate)
            log = cast("IO[str]", process.stderr)  # a pipe
            if not any("driving as" in line for line in log):
                raise BenchError("roverlink drive did not start")
            threading.Thread(target=log.read, daemon=True).start()
        yield board, _Basestation(back), held.enter_context(bridge.middleware(NodeIdentity("controller")))


def _wait_for(what: str, is_so: Callable[[], object]) -> None:
    until = time.monotonic() + _START_S
    while not is_so():
        if time.monotonic() > until:
            raise BenchError(f"no {what} came for {_START_S:.0f} s")
        time.sleep(0.01)


def _latencies(middleware: str, seconds: float, *, drives: bool) -> list[float]:
    """Return the times in milliseconds from the publication of a command to its datagram, sorted."""
    with _rover(middleware, drives=drives) as (board, _, node):
        kind = Twist if drives else DrivingBoardMotorMessage
        publisher = node.publisher("/cmd_vel" if drives else "/drive_motor", kind, Qos())
        sent: list[float] = []

        def publish() -> None:
            radius = (_NEAREST + _STEP * len(sent)) * (-1) ** len(sent)
            message = (
                Twist(Vector3(_SPEED), Vector3(0, 0, _SPEED / radius))
                if drives
                else DrivingBoardMotorMessage(_SPEED, radius)
            )
            data = [cdr.encode(message)]
            sent.append(time.perf_counter())
            publisher.publish(data)
            time.sleep(_PERIOD_S * random.uniform(0.8, 1.2))  # noqa: S311  # not in step with the commands

        def arrived() -> bool:
            publish()
            return bool(board.last_moving())

        _wait_for("command", arrived)
        first = len(sent)
        while len(sent) - first < seconds / _PERIOD_S:
            publish()
        time.sleep(1.0)
        times: dict[int, float] = {}
        for at, distance, radius in board.arrivals:
            if distance:
                times.setdefault(round((abs(radius) - _NEAREST) / _STEP), at)
        # On a busy machine, a newer velocity may replace one that was not taken yet.
        return sorted(1e3 * (times[number] - sent[number]) for number in range(first, len(sent)) if number in times)


def latency(middleware: str, seconds: float) -> list[Sequence[str]]:
    """Measure the latency of the bridge alone, and that from a velocity."""
    rows: list[Sequence[str]] = []
    for name, drives in (("drive_motor, the bridge alone", False), ("cmd_vel, drive and the bridge", True)):
        times = _latencies(middleware, seconds, drives=drives)
        parts = [times[min(int(part * len(times)), len(times) - 1)] for part in (0.5, 0.99, 1.0)]
        rows.append((f"{name}, {middleware}", str(len(times)), *(f"{one:.2f}" for one in parts)))
    return rows


def stopping(middleware: str, times: int) -> list[Sequence[str]]:
    """Measure the time to the last command that moves the rover: after MANUAL, and after the link is cut."""
    with _rover(middleware, drives=True, loss=_LOSS) as (board, basestation, node):
        velocities = node.publisher("/cmd_vel", Twist, Qos())
        going = True

        def drive() -> None:
            while going:
                velocities.publish([cdr.encode(Twist(Vector3(_SPEED)))])
                time.sleep(_PERIOD_S)

        threading.Thread(target=drive, daemon=True).start()
        rows: list[Sequence[str]] = []
        for name, mode, wait in (("MANUAL", 0, 0.8), ("the link is cut", None, 1.8)):
            delays = []
            for _ in range(times):
                board.wait_for_moving(basestation.set_mode(1))
                time.sleep(0.3 + random.uniform(0, _PERIOD_S))  # noqa: S311  # not in step with the mode
                at = basestation.set_mode(mode)
                time.sleep(wait)
                delays.append(max(board.last_moving() - at, 0.0))
            delays.sort()
            shown = (1e3 * delays[len(delays) // 2], 1e3 * delays[min(int(0.99 * times), times - 1)], 1e3 * delays[-1])
            rows.append((f"{name}, {middleware}", str(times), *(f"{value:.0f}" for value in shown)))
        basestation.set_mode(1)
        board.wait_for_moving(time.perf_counter())
        begun, seconds = time.perf_counter(), times * 0.5
        time.sleep(seconds)
        stops = sum(1 for at, distance, _ in board.arrivals if at > begun + 0.5 and distance == 0)
        going = False
    rows.append((f"stops in {seconds:.0f} s of driving, {middleware}", str(stops), "", "", ""))
    return rows


def main(words: Sequence[str]) -> int:
    """Measure, print the tables, and return the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m rover.bench.driving",
        description="Measure roverlink drive on this computer, beside the bridge alone.",
        epilog="example: python -m rover.bench.driving --middleware dds --seconds 10",
    )
    choices = ("dds", "rclpy")
    parser.add_argument("--middleware", nargs="+", choices=choices, help="default: those that are installed")
    parser.add_argument("--seconds", type=float, default=50.0, help="seconds of each latency (default: 50)")
    parser.add_argument("--times", type=int, default=100, help="stops of each kind (default: 100)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the tables to FILE")
    options = parser.parse_args(words)
    found = [name for name, package in (("dds", "cyclonedds"), ("rclpy", "rclpy")) if find_spec(package)]
    isolate_ros(UNTIL_EXIT)
    progress = Console(stderr=True, highlight=False, markup=False)
    of_latency, of_stops = list[Sequence[str]](), list[Sequence[str]]()
    try:
        for middleware in options.middleware or found:
            progress.print(f"latency: {middleware}")
            of_latency += latency(middleware, options.seconds)
            progress.print(f"stopping: {middleware}")
            of_stops += stopping(middleware, options.times)
    except (BenchError, SetupError) as error:
        print(f"rover.bench.driving: {error}", file=sys.stderr)
        return 2
    columns = ("", "count", "median\nms", "p99\nms", "longest\nms")
    heading = f"{_LOSS:.0%} of the datagrams lost, mode and velocities at {1 / _PERIOD_S:.0f} Hz"
    tables = [
        Table("From the publication to the datagram at the board", columns, [Group("20 Hz", of_latency)]),
        Table("From the change to the last command that moves the rover", columns, [Group(heading, of_stops)]),
    ]
    data = {"latency": of_latency, "stopping": of_stops}
    results = {"driving": SectionResult(tables, data=data)}
    report(results, options.json)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
