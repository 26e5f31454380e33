"""`roverlink run`, as an operator and a launch file use it, and beside publishers that die, hang or leave."""

from __future__ import annotations

import itertools
import json
import re
import signal
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from needs import needs_dds
from polling import wait_until
from programs import Start
from running import Bridge

from generated.registry import REGISTRY


def _send(port: int, *datagrams: bytes) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for datagram in datagrams:
            sock.sendto(datagram, ("127.0.0.1", port))


def _imu(number: float = 1.0) -> bytes:
    return REGISTRY.envelope(imu_info={"accel_x": number}).SerializeToString()


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
@pytest.mark.parametrize("middleware", ["memory", pytest.param("dds", marks=needs_dds)])
def test_a_signal_stops_it_well(bridge: Bridge, peer: socket.socket, middleware: str, number: signal.Signals) -> None:
    """Many SIGINT or SIGTERM end it with exit code 0 and the account, after what had arrived was handled."""
    basestation = f"dst_a_port:={peer.getsockname()[1]}"
    program, port = bridge("--json", parameters=[basestation], ros=["-r", "__ns:=/rover"], middleware=middleware)
    sent = [_imu(), b"\xff", REGISTRY.envelope(arm_ctrl={}).SerializeToString(), bytes.fromhex("ca01"), _imu(2.0)]
    _send(port, *sent)
    assert [peer.recv(2000), peer.recv(2000)] == [sent[0], sent[4]]
    # whoever presses Ctrl-C many times gets the same clean end
    wait_until(lambda: program.send_signal(number) or "received 5" in str(program), "the account")
    assert program.end() == 0
    ready, account = map(json.loads, program.output)
    fingerprint = REGISTRY.fingerprint
    assert ready == {"node": "/rover/udp_forwarder", "port": port, "messages": 21, "fingerprint": fingerprint}
    assert account["received"] == 5
    assert account["by_payload"]["published"] == {"imu_info": 2}
    assert account["dropped"] == {"malformed": 1, "unknown_payload": 1, "wrong_direction": 1}
    assert account["forwarded"] == 2
    assert program.wait_for("received 5, published 2").startswith("[INFO]")


@pytest.mark.slow
def test_the_log_goes_to_standard_error(bridge: Bridge) -> None:
    """In the form in which ROS 2 nodes log; a datagram that cannot be bridged is a warning, with number and name."""
    program, port = bridge(ros=["-r", "__node:=bridge"])
    ready = r"\[INFO\] \[\d+\.\d{6}\] \[bridge\]: /bridge bridges 21 messages on UDP port \d+"
    assert re.fullmatch(ready, program.wait_for("on UDP port "))
    _send(port, REGISTRY.envelope(drive_motor={}).SerializeToString())
    line = program.wait_for("'drive_motor' (9) is a message to a peer (ros_to_hardware)")
    assert re.match(r"\[WARN\] \[\d+\.\d{6}\] \[bridge\]: dropped: ", line)
    assert program.interrupt() == 0
    assert program.output == []


@pytest.mark.slow
def test_a_params_file_and_the_log_level_are_obeyed(start: Start, peer: socket.socket, tmp_path: Path) -> None:
    """With `--log-level error`, neither what it does nor what it drops is told. Parameters of others are ignored."""
    path = tmp_path / "params.yaml"
    of_others = {"robot_radius": 0.3, "qos_overrides./parameter_events.publisher.depth": 100}
    given = {"listen_port": 0, "forward_policy": "all", "dst_a_port": peer.getsockname()[1], **of_others}
    path.write_text(json.dumps({"/**": {"ros__parameters": given}}))
    words = ("--params-file", path, "--log-level", "error")
    program = start("run", "--middleware", "memory", "--json", "--ros-args", *words)
    _send(json.loads(program.wait_for("port", program.output))["port"], b"\xff")
    assert peer.recv(2000) == b"\xff"
    assert program.interrupt() == 0
    assert program.errors == []


_COMMAND = 1.5
_AFTER_S = 0.5  # as mapping.yaml says


def _heard(board: socket.socket) -> Iterator[tuple[float, float]]:
    """Yield each distance that the drive board is told, behind the time at which it was told."""
    while True:
        envelope: Any = REGISTRY.envelope.FromString(board.recv(2048))
        if envelope.WhichOneof(REGISTRY.oneof) == "drive_motor":
            yield time.monotonic(), envelope.drive_motor.distance_to_go


@pytest.mark.slow
@needs_dds
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP, signal.SIGTERM], ids=["killed", "paused", "leaves"])
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
