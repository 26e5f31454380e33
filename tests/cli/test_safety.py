"""What moves the rover, as processes over ROS 2's wire: publishers that die, hang or leave."""

from __future__ import annotations

import itertools
import signal
import socket
import time
from collections.abc import Iterator
from typing import Any

import pytest
from needs import needs_dds
from programs import Start
from running import Bridge

from generated.registry import REGISTRY

pytestmark = [needs_dds, pytest.mark.slow]

_COMMAND = 1.5
_AFTER_S = 0.5  # as mapping.yaml says


def _heard(board: socket.socket) -> Iterator[tuple[float, float]]:
    """Yield each distance that the drive board is told, behind the time at which it was told."""
    while True:
        envelope: Any = REGISTRY.envelope.FromString(board.recv(2048))
        if envelope.WhichOneof(REGISTRY.oneof) == "drive_motor":
            yield time.monotonic(), envelope.drive_motor.distance_to_go


@pytest.mark.parametrize(
    "number",
    [signal.SIGKILL, signal.SIGSTOP, signal.SIGTERM],
    ids=["killed", "paused", "leaves"],
)
def test_a_rover_whose_commander_is_gone_stops(
    start: Start, bridge: Bridge, peer: socket.socket, number: signal.Signals
) -> None:
    """Half a second after the last command where its publisher was killed or hangs; at once where it left."""
    bridge(parameters=[f"dst_b_port:={peer.getsockname()[1]}"], middleware="dds")
    commander = start("pub", "drive_motor", f"{{distance_to_go: {_COMMAND}}}", "--rate", 50)
    heard = _heard(peer)
    assert _COMMAND in (distance for _, distance in heard)
    commands = [*itertools.islice(heard, 50)]  # a second of them
    assert {distance for _, distance in commands} == {_COMMAND}
    commander.send_signal(number)
    commands += itertools.takewhile(lambda one: one[1] == _COMMAND, heard)
    # The time is what is tested, on a machine that may be busy.
    assert time.monotonic() - commands[-1][0] < 10 * _AFTER_S
    assert 0.0 in (distance for _, distance in heard)  # and again
    if number == signal.SIGSTOP:
        commander.send_signal(signal.SIGCONT)
        assert _COMMAND in (distance for _, distance in heard)
