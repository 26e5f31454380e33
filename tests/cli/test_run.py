"""`roverlink run`, as an operator and a launch file use it."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from needs import needs_dds
from polling import wait_until
from programs import Start
from running import Bridge

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.generator.example_payloads import payload_at


def _send(port: int, *datagrams: bytes) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for datagram in datagrams:
            sock.sendto(datagram, ("127.0.0.1", port))


def _send_until(port: int, datagram: bytes, condition: Callable[[], object]) -> None:
    def holds() -> object:
        _send(port, datagram)
        return condition()

    wait_until(holds, "what the datagram causes")


def _imu(number: float = 1.0) -> bytes:
    return REGISTRY.envelope(imu_info={"accel_x": number}).SerializeToString()


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


@needs_dds
@pytest.mark.slow
def test_it_ends_whatever_the_middleware_still_has_to_free(bridge: Bridge) -> None:
    """Stopped in the middle of traffic over DDS, it does not hang in what Python tears down last."""
    for _ in range(4):
        program, port = bridge(middleware="dds")
        _send(port, *[_imu()] * 2000)
        assert program.interrupt(signal.SIGINT) == 0


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


def test_the_log_level_silences_it(start: Start, peer: socket.socket) -> None:
    """With `--log-level error`, neither what it does nor what it drops is told."""
    words = ["-p", "listen_port:=0", "-p", f"dst_a_port:={peer.getsockname()[1]}", "--log-level", "error"]
    program = start("run", "--middleware", "memory", "--json", "--ros-args", *words)
    port = json.loads(program.wait_for("port", program.output))["port"]
    _send(port, b"\xff", _imu())
    assert peer.recv(2000) == _imu()
    assert program.interrupt() == 0
    assert program.errors == []


@needs_dds
@pytest.mark.slow
def test_names_are_remapped_on_the_wire(bridge: Bridge, start: Start) -> None:
    """Namespace, node name and topics are those of the command line, as another program sees them."""
    program, port = bridge(ros=["-r", "__ns:=/rover", "-r", "imu_data:=imu"], middleware="dds")
    assert "/rover/udp_forwarder bridges" in program.wait_for("on UDP port ")
    echo = start("echo", "/rover/imu", "--type", "comms/msg/ImuSensorInformation", "--count", 1, "--json")
    _send_until(port, _imu(0.5), lambda: echo.output)
    assert json.loads(echo.wait_for("accel_x", echo.output))["accel_x"] == 0.5
    assert echo.end() == 0
    assert program.interrupt() == 0


_HUNG = """
import sys
from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.middleware import NodeIdentity, open_middleware
with open_middleware("dds", NodeIdentity("hung")) as middleware:
    for handler in REGISTRY.handlers:
        if handler.route.inbound:
            topic = "/" + handler.route.topic
            middleware.subscribe(topic, handler.message_type, Qos(), lambda data: print("got", flush=True))
    sys.stdin.readline()
"""


@needs_dds
def test_a_subscriber_that_hangs_does_not_keep_it_from_stopping(bridge: Bridge, environment: dict[str, str]) -> None:
    """Where a reliable subscriber does not acknowledge, stopping takes no longer."""
    program, port = bridge(middleware="dds")
    everything = [
        REGISTRY.envelope(**{h.route.name: payload_at(h.payload_type, 1.0)}).SerializeToString()
        for h in REGISTRY.handlers
        if h.route.inbound
    ]
    with subprocess.Popen(
        [sys.executable, "-c", _HUNG],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment,
        cwd=Path(__file__).parents[2],
    ) as hung:
        try:
            assert hung.stdout is not None
            os.set_blocking(hung.stdout.fileno(), False)
            got = 0

            def all_crossed() -> bool:
                nonlocal got
                _send(port, *everything)
                got += (hung.stdout.read() or b"").count(b"got")  # type: ignore[union-attr]  # a pipe, as it was asked for
                return got >= 30

            wait_until(all_crossed, "a message on every topic")
            hung.send_signal(signal.SIGSTOP)
            _send(port, *everything * 10)
            start_of_stop = time.monotonic()
            assert program.interrupt() == 0
            took = time.monotonic() - start_of_stop
        finally:
            hung.kill()
    assert took < 6  # it was 10 s, the time after which a silent subscriber counts as gone


def test_a_params_file_is_obeyed(start: Start, peer: socket.socket, tmp_path: Path) -> None:
    """What a parameter file says is what the node does."""
    path = tmp_path / "params.yaml"
    given = {"listen_port": 0, "forward_policy": "all", "dst_a_port": peer.getsockname()[1]}
    path.write_text(json.dumps({"/**": {"ros__parameters": given}}))
    program = start("run", "--middleware", "memory", "--json", "--ros-args", "--params-file", path)
    _send(json.loads(program.wait_for("port", program.output))["port"], b"anything")
    assert peer.recv(2000) == b"anything"
    assert program.interrupt() == 0


@needs_dds
@pytest.mark.slow
def test_a_wrong_domain_is_told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A ROS_DOMAIN_ID that cannot be is exit code 2."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "mars")
    assert main(["run", "--middleware", "dds", "--ros-args", "-p", "listen_port:=0"]) == 2
    assert capsys.readouterr().err == "roverlink: ROS_DOMAIN_ID is 'mars'; set it to a number from 0 to 232\n"


@needs_dds
@pytest.mark.slow
def test_echo_knows_the_standard_messages_that_a_row_feeds(bridge: Bridge, start: Start) -> None:
    """What a board says over UDP is printed, over DDS, as the standard message in its units; no type has to be said."""
    program, port = bridge(middleware="dds")
    listener = start("echo", "/imu/data_raw", "--json", "--count", 1)
    said = REGISTRY.envelope(imu_info={"gyro_x": 180.0, "accel_y": 0.5}).SerializeToString()
    _send_until(port, said, lambda: listener.output)
    assert listener.end() == 0
    message = json.loads(listener.output[0])
    assert message["angular_velocity"] == {"x": pytest.approx(3.141592653589793), "y": 0.0, "z": 0.0}
    assert message["linear_acceleration"]["y"] == 0.5
    assert message["header"]["frame_id"] == "imu_link"
    assert abs(message["header"]["stamp"]["sec"] - time.time()) < 120
    assert program.interrupt() == 0
