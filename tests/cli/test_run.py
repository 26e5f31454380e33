"""`roverlink run`, as an operator and a launch file use it."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from needs import needs_dds
from polling import wait_until

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.generator.example_payloads import payload_at

_FREE_PORT = ("-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'")

Start = Callable[..., Any]


@pytest.fixture
def peer() -> Iterator[socket.socket]:
    """The basestation's socket."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(60)
        yield sock


def _port(program: Any) -> int:
    return int(program.wait_for("on UDP port ").rpartition(" ")[2])


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
def test_a_signal_stops_it_well(start: Start, peer: socket.socket, middleware: str, number: signal.Signals) -> None:
    """SIGINT and SIGTERM end it with exit code 0 and the account, after what had arrived was handled."""
    basestation = f"dst_a_port:={peer.getsockname()[1]}"
    program = start("run", "--middleware", middleware, "--json", "--ros-args", *_FREE_PORT, "-p", basestation)
    port = _port(program)
    sent = [_imu(), b"\xff", REGISTRY.envelope(arm_ctrl={}).SerializeToString(), bytes.fromhex("ca01"), _imu(2.0)]
    _send(port, *sent)
    assert [peer.recv(2000), peer.recv(2000)] == [sent[0], sent[4]]
    assert program.interrupt(number) == 0
    account = json.loads(program.output[-1])
    assert account["received"] == 5
    assert account["by_payload"]["published"] == {"imu_info": 2}
    assert account["dropped"] == {"malformed": 1, "unknown_payload": 1, "wrong_direction": 1}
    assert account["forwarded"] == 2
    assert program.wait_for("received 5, published 2").startswith("[INFO]")


@needs_dds
@pytest.mark.slow
def test_it_ends_whatever_the_middleware_still_has_to_free(start: Start) -> None:
    """Stopped in the middle of traffic over DDS, it does not hang in what Python tears down last."""
    for _ in range(4):
        program = start("run", "--middleware", "dds", "--ros-args", *_FREE_PORT)
        port = _port(program)
        _send(port, *[_imu()] * 2000)
        assert program.interrupt(signal.SIGINT) == 0


def test_json_says_when_it_is_ready(start: Start) -> None:
    """With --json the first line of output has node, port and the fingerprint of table and schema."""
    program = start("run", "--middleware", "memory", "--json", "--ros-args", *_FREE_PORT, "-r", "__ns:=/rover")
    port = _port(program)
    ready = json.loads(program.wait_for("fingerprint", program.output))
    assert ready == {
        "node": "/rover/udp_forwarder",
        "port": port,
        "messages": len(REGISTRY.handlers),
        "fingerprint": REGISTRY.fingerprint,
    }
    assert program.interrupt() == 0


def test_other_commands_take_no_ros_arguments(capsys: pytest.CaptureFixture[str]) -> None:
    """Where `--ros-args` would have no effect, it is refused and not ignored."""
    with pytest.raises(SystemExit) as ended:
        main(["send", "--list", "--ros-args", "-p", "listen_port:=1"])
    assert ended.value.code == 2
    assert "send does not take --ros-args" in capsys.readouterr().err


def test_impatient_signals_do_no_harm(start: Start) -> None:
    """Whoever presses Ctrl-C many times gets the same clean end."""
    program = start("run", "--middleware", "memory", "--ros-args", *_FREE_PORT)
    _port(program)
    for _ in range(50):
        program.send_signal(signal.SIGINT)
        time.sleep(0.001)  # or the kernel makes one signal of them
    assert program.end() == 0


def test_without_json_nothing_goes_to_standard_output(start: Start) -> None:
    """The log goes to standard error, in the form in which ROS 2 nodes log."""
    program = start("run", "--middleware", "memory", "--ros-args", *_FREE_PORT)
    line = program.wait_for("on UDP port ")
    assert re.fullmatch(
        r"\[INFO\] \[\d+\.\d{6}\] \[udp_forwarder\]: /udp_forwarder bridges 21 messages on UDP port \d+", line
    )
    assert program.interrupt() == 0
    assert program.output == []


def test_warnings_name_what_is_wrong(start: Start) -> None:
    """A datagram that cannot be bridged is a warning of the node, with number and name."""
    program = start("run", "--middleware", "memory", "--ros-args", *_FREE_PORT, "-r", "__node:=bridge")
    _send(_port(program), REGISTRY.envelope(drive_motor={}).SerializeToString())
    line = program.wait_for("'drive_motor' (9) is a message to a peer (ros_to_hardware)")
    assert re.match(r"\[WARN\] \[\d+\.\d{6}\] \[bridge\]: dropped: ", line)
    assert program.interrupt() == 0


def test_the_log_level_silences_it(start: Start, peer: socket.socket) -> None:
    """With `--log-level error`, neither what it does nor what it drops is told."""
    basestation = f"dst_a_port:={peer.getsockname()[1]}"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        port = sock.getsockname()[1]
    arguments = ("-p", f"listen_port:={port}", "-p", basestation, "--log-level", "error")
    program = start("run", "--middleware", "memory", "--ros-args", *arguments)
    peer.setblocking(False)

    def forwarded() -> bytes:
        with contextlib.suppress(BlockingIOError):
            return peer.recv(2000)
        return b""

    _send_until(port, _imu(), forwarded)  # it says nothing when it is ready
    _send(port, b"\xff", _imu())
    wait_until(forwarded, "what came behind the broken datagram")
    assert program.interrupt() == 0
    assert program.errors == []


@needs_dds
@pytest.mark.slow
def test_names_are_remapped_on_the_wire(start: Start) -> None:
    """Namespace, node name and topics are those of the command line, as another program sees them."""
    program = start(
        "run", "--middleware", "dds", "--ros-args", *_FREE_PORT, "-r", "__ns:=/rover", "-r", "imu_data:=imu"
    )
    assert "/rover/udp_forwarder bridges" in program.wait_for("on UDP port ")
    port = _port(program)
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
def test_a_subscriber_that_hangs_does_not_keep_it_from_stopping(start: Start, environment: dict[str, str]) -> None:
    """Where a reliable subscriber does not acknowledge, stopping takes no longer."""
    program = start("run", "--middleware", "dds", "--json", "--ros-args", *_FREE_PORT)
    port = _port(program)
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


# --- what keeps it from starting --------------------------------------------------------------------------------


def test_a_port_in_use_is_told(done: Start, peer: socket.socket) -> None:
    """Exit code 2, and the port, where another program has it."""
    port = peer.getsockname()[1]
    arguments = ("-p", f"listen_port:={port}", "-p", "listen_address:='127.0.0.1'")
    code, output, errors = done("run", "--middleware", "memory", "--ros-args", *arguments)
    assert (code, output) == (2, "")
    assert errors == (
        f"roverlink: UDP port {port} on 127.0.0.1 is in use by another program; "
        "stop that program or choose another port (parameter listen_port)"
    )


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("-p", "listen_prt:=5000"), "unknown parameter 'listen_prt'; did you mean 'listen_port'?"),
        (("-p", "listen_port:=fast"), "parameter 'listen_port' is 'fast'; it must be of type int"),
        (("-p", "listen_port:=70000"), "parameter 'listen_port' is 70000; a UDP port is a number from 1 to 65535"),
        (("-p", "listen_address:=2024-13-45"), "2024-13-45"),
        (("-p", "receive_buffer:=9999999999"), "parameter 'receive_buffer' is 9999999999"),
        (("-p", "dst_ip:=10.0.0.300"), "'10.0.0.300' is neither an IP address nor the name of a host"),
        (("-p", "dst_ip:=" + "a" * 70 + ".x"), "is neither an IP address nor the name of a host"),
        (("-p", "listen_address:=" + "a" * 70 + ".x"), "cannot listen on UDP port 5000 of aaaa"),
        (("-p", "forward_policy:=some"), "parameter 'forward_policy' is 'some'; it must be one of mapping, all"),
        (("--params-file", "nowhere.yaml"), "nowhere.yaml: cannot read the file"),
        (("-r", "imu data:=imu"), "is not a topic name"),
        (("-r", "__ns:=rover"), "'rover' is not a namespace"),
        (("--frobnicate",), "unknown argument '--frobnicate'"),
        (("--log-level", "loud"), "unknown log level 'loud'"),
    ],
    ids=lambda value: " ".join(value)[:30] if isinstance(value, tuple) else "",
)
def test_wrong_ros_arguments_are_told(
    arguments: tuple[str, ...], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Exit code 2 and one line that quotes what is wrong."""
    assert main(["run", "--middleware", "memory", "--ros-args", *arguments]) == 2
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith("roverlink: ")
    assert expected in errors


def test_a_params_file_with_an_unknown_name_is_told(done: Start, tmp_path: Path) -> None:
    """A parameter file with a name that the node does not have ends it with exit code 2, and the nearest name."""
    path = tmp_path / "params.yaml"
    path.write_text("udp_forwarder: {ros__parameters: {listen_prt: 5000}}")
    code, _, errors = done("run", "--middleware", "memory", "--ros-args", "--params-file", path)
    assert (code, errors) == (2, "roverlink: unknown parameter 'listen_prt'; did you mean 'listen_port'?")


def test_a_params_file_is_obeyed(start: Start, peer: socket.socket, tmp_path: Path) -> None:
    """What a parameter file says is what the node does."""
    path = tmp_path / "params.yaml"
    path.write_text(
        "/**:\n  ros__parameters:\n    listen_port: 0\n    forward_policy: all\n"
        f"    dst_a_port: {peer.getsockname()[1]}\n"
    )
    program = start("run", "--middleware", "memory", "--ros-args", "--params-file", path)
    _send(_port(program), b"anything")
    assert peer.recv(2000) == b"anything"
    assert program.interrupt() == 0


@needs_dds
@pytest.mark.slow
def test_a_wrong_domain_is_told(done: Start) -> None:
    """A ROS_DOMAIN_ID that cannot be is exit code 2."""
    code, _, errors = done("run", "--middleware", "dds", "--ros-args", *_FREE_PORT, ROS_DOMAIN_ID="mars")
    assert (code, errors) == (2, "roverlink: ROS_DOMAIN_ID is 'mars'; set it to a number from 0 to 232")


def test_a_project_without_generated_code_is_told(done: Start, tmp_path: Path) -> None:
    """A folder in which nothing was generated is exit code 2, with what to do."""
    code, _, errors = done("run", "--middleware", "memory", "--project", tmp_path)
    assert code == 2
    assert errors == f"roverlink: no generated code in {tmp_path}; run `roverlink generate` there"


@needs_dds
@pytest.mark.slow
def test_echo_knows_the_standard_messages_that_a_row_feeds(start: Start) -> None:
    """What a board says over UDP is printed, over DDS, as the standard message in its units; no type has to be said."""
    program = start("run", "--middleware", "dds", "--ros-args", *_FREE_PORT)
    port = _port(program)
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
