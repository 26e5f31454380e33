"""What moves the rover, as processes over ROS 2's wire: publishers that die, hang or leave, floods, slow readers."""

from __future__ import annotations

import contextlib
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from needs import needs_dds
from polling import wait_until
from programs import Start
from running import Bridge

from generated.registry import REGISTRY

pytestmark = needs_dds

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
