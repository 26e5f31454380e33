"""What moves the rover, as processes over ROS 2's wire: publishers that die, hang or leave, floods, slow readers."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from needs import needs_dds
from polling import wait_until
from programs import Start
from running import Bridge

from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.middleware import NodeIdentity, open_middleware

pytestmark = needs_dds

_DRIVE = REGISTRY.by_name["drive_motor"]
_STOP = REGISTRY.envelope(drive_motor={"distance_to_go": 0.0}).SerializeToString()
_AFTER_S = 0.5  # as mapping.yaml says


class _Board:
    """The drive board: which distances it was told, and when."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 * 1024 * 1024)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.settimeout(0.1)
        self.parameter = f"dst_b_port:={self._socket.getsockname()[1]}"
        self.told: list[tuple[float, float]] = []
        self._open = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while self._open:
            with contextlib.suppress(TimeoutError):
                datagram = self._socket.recv(2048)
                now = time.monotonic()
                if datagram[0] == _STOP[0]:
                    envelope: Any = REGISTRY.envelope.FromString(datagram)
                    self.told.append((now, envelope.drive_motor.distance_to_go))

    def wait_for(self, what: Callable[[float], bool], since: float = 0.0) -> float:
        """When it was told something, after a moment."""

        def told() -> float | None:
            return next((at for at, distance in list(self.told) if at > since and what(distance)), None)

        return wait_until(told, "what the board is to be told") or 0.0

    def wait_for_commands(self, count: int) -> None:
        """Wait until it was told so many distances more."""
        before = len(self.told)
        wait_until(lambda: len(self.told) >= before + count, f"{count} commands")

    def close(self) -> None:
        """Listen no more."""
        self._open = False
        self._thread.join()
        self._socket.close()


@pytest.fixture
def board() -> Iterator[_Board]:
    """A drive board."""
    board = _Board()
    yield board
    board.close()


def _is_stop(distance: float) -> bool:
    return distance == 0.0


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(signal.SIGKILL, id="killed"),
        pytest.param(signal.SIGSTOP, id="paused", marks=pytest.mark.slow),
        pytest.param(signal.SIGTERM, id="leaves", marks=pytest.mark.slow),
    ],
)
def test_a_rover_whose_commander_is_gone_stops(
    start: Start, bridge: Bridge, board: _Board, number: signal.Signals
) -> None:
    """Half a second after the last command where its publisher was killed or hangs; at once where it left."""
    bridge(parameters=[board.parameter], middleware="dds")
    commander = start("pub", "drive_motor", "{distance_to_go: 1.5}", "--rate", 50)
    first = board.wait_for(lambda distance: distance == 1.5)
    board.wait_for_commands(50)  # a second of them
    assert not [at for at, distance in board.told if at > first and _is_stop(distance)]
    commander.send_signal(number)
    gone = time.monotonic()
    stopped = board.wait_for(_is_stop, gone)
    last = max(at for at, distance in board.told if distance == 1.5)
    assert stopped - last < 10 * _AFTER_S  # the time is what is tested, on a machine that may be busy
    board.wait_for(_is_stop, stopped)  # and again
    if number == signal.SIGSTOP:
        commander.send_signal(signal.SIGCONT)
        board.wait_for(lambda distance: distance == 1.5, time.monotonic())


@pytest.mark.slow
def test_a_bridge_that_is_stopped_stops_the_rover(start: Start, bridge: Bridge, board: _Board) -> None:
    """Its last word to the board is the stop, though the commander still commands."""
    program, _ = bridge("--json", parameters=[board.parameter], middleware="dds")
    start("pub", "drive_motor", "{distance_to_go: 1.5}", "--rate", 50)
    board.wait_for(lambda distance: distance == 1.5)
    assert program.interrupt() == 0
    wait_until(lambda: [distance for _, distance in board.told[-3:]] == [0.0, 0.0, 0.0], "three stops at the end")
    account = json.loads(program.output[-1])
    assert account["stops"]["drive_motor"] >= 3


_FLOOD = """
import sys
from generated.registry import REGISTRY
from roverlink import topics
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime.middleware import open_middleware
middleware = open_middleware("dds", topics.identity("flood"))
rows = [h for h in REGISTRY.handlers if not h.route.inbound and not h.route.priority]
publishers = [(middleware.publisher("/" + h.route.topic, h.message_type, h.route.qos),
               [h.to_cdr(payload_at(h.payload_type, 1.0))] * 8) for h in rows]
print("flooding", flush=True)
while True:
    for publisher, messages in publishers:
        publisher.publish(messages)
"""


@pytest.mark.slow
def test_a_flood_delays_no_command(start: Start, bridge: Bridge, board: _Board, environment: dict[str, str]) -> None:
    """Drive commands, while boards and every other topic send as fast as the machine can."""
    _, port = bridge(parameters=[board.parameter], middleware="dds")
    with contextlib.ExitStack() as stack:
        commander = stack.enter_context(open_middleware("dds", NodeIdentity("commander")))
        publisher = commander.publisher("/drive_motor", _DRIVE.message_type, Qos())
        wait_until(publisher.has_subscribers, "the bridge as a subscriber")
        start("simulate", "--to", f"127.0.0.1:{port}", "--rate", 1e6, "--seconds", 60)
        flood = subprocess.Popen([sys.executable, "-c", _FLOOD], env=environment, stdout=subprocess.PIPE, text=True)
        stack.callback(flood.wait)
        stack.callback(flood.kill)
        assert flood.stdout is not None
        stack.callback(flood.stdout.close)
        flood.stdout.readline()
        time.sleep(2)  # nothing tells that every queue on the way is full
        sent: dict[float, float] = {}
        for number in range(1, 301):
            sent[float(number)] = time.monotonic()
            publisher.publish([_DRIVE.to_cdr(_DRIVE.payload_type(distance_to_go=number))])
            time.sleep(0.01)  # a hundred commands a second

        def arrived() -> dict[float, float]:
            return {distance: at for at, distance in list(board.told) if distance in sent}

        wait_until(lambda: len(arrived()) >= 297, "297 of 300 commands")
    delays = sorted(at - sent[number] for number, at in arrived().items())
    assert delays[int(0.99 * len(delays))] < 0.25  # half of what makes the topic silent, on a machine with two cores


@pytest.mark.slow
def test_a_slow_reader_stops_nobody(start: Start, bridge: Bridge, board: _Board) -> None:
    """A subscriber that hangs costs its own topic some messages, which are counted; memory stays as it is."""
    program, port = bridge("--json", parameters=[board.parameter], middleware="dds")
    reader = start("echo", "imu_data", "--json")
    start("simulate", "--to", f"127.0.0.1:{port}", "--rate", 3000, "--seconds", 60)
    reader.wait_for("accel_x", reader.output)
    reader.send_signal(signal.SIGSTOP)
    start("pub", "drive_motor", "{distance_to_go: 2.5}", "--rate", 50)
    board.wait_for(lambda distance: distance == 2.5)
    board.wait_for_commands(50)
    statm = Path(f"/proc/{program.pid}/statm")
    before = int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    board.wait_for_commands(200)
    grown = int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") - before
    reader.send_signal(signal.SIGCONT)
    assert program.interrupt() == 0
    account = json.loads(program.output[-1])
    assert account["received"] == account["published"] + sum(account["dropped"].values())
    assert grown < 8 * 1024 * 1024


_SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

/* The time of day, which jumps by an hour where the file that JUMP names exists. */
int clock_gettime(clockid_t clock, struct timespec *now) {
  static int (*real)(clockid_t, struct timespec *);
  if (!real) real = (int (*)(clockid_t, struct timespec *))dlsym(RTLD_NEXT, "clock_gettime");
  int code = real(clock, now);
  if (clock == CLOCK_REALTIME && access(getenv("JUMP"), F_OK) == 0) now->tv_sec += atoi(getenv("JUMP_BY"));
  return code;
}
"""


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("gcc"), reason="need gcc (apt-get install gcc)")
@pytest.mark.parametrize("by", [3600, -3600])
def test_a_clock_that_jumps_stops_nobody_and_keeps_nobody_going(
    start: Start, bridge: Bridge, board: _Board, tmp_path: Path, by: int
) -> None:
    """An hour ahead or back: commands pass, and the stop comes when it has to."""
    (tmp_path / "shim.c").write_text(_SHIM)
    library = tmp_path / "shim.so"
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", library, tmp_path / "shim.c", "-ldl"], check=True)
    jump = tmp_path / "jump"
    moved = {"LD_PRELOAD": str(library), "JUMP": str(jump), "JUMP_BY": str(by)}
    bridge(parameters=[board.parameter], middleware="dds", **moved)
    commander = start("pub", "drive_motor", "{distance_to_go: 1.5}", "--rate", 50)
    board.wait_for(lambda distance: distance == 1.5)
    jump.touch()
    jumped = time.monotonic()
    board.wait_for(lambda distance: distance == 1.5, jumped + 1.0)
    assert not [at for at, distance in board.told if at > jumped and _is_stop(distance)]
    commander.send_signal(signal.SIGKILL)
    gone = time.monotonic()
    assert board.wait_for(_is_stop, gone) - gone < 10 * _AFTER_S
