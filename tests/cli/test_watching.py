"""A running bridge is watched: diagnostics, metrics, Foxglove, `roverlink top`, and `roverlink doctor` beside it."""

from __future__ import annotations

import asyncio
import json
import os
import re
import socket
import struct
import threading
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import websockets
from needs import needs_dds
from polling import wait_until
from prometheus_client.parser import text_string_to_metric_families

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.recording.message_definitions import definition_of

Start = Callable[..., Any]

_FREE_PORT = ("--ros-args", "-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'")


class _Board:
    """Sends one IMU message after the other, fifty a second. A context manager."""

    def __init__(self, program: Any) -> None:
        self._port = int(program.wait_for("on UDP port ").rpartition(" ")[2])
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._send, daemon=True)

    def _send(self) -> None:
        datagram = REGISTRY.envelope(imu_info={"accel_x": 1.5}).SerializeToString()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            while not self._ending.wait(0.02):
                sock.sendto(datagram, ("127.0.0.1", self._port))

    def __enter__(self) -> _Board:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        self._thread.join()


@needs_dds
def test_diagnostics_are_heard_by_anybody(start: Start, done: Start) -> None:
    """Once a second, as diagnostic_msgs, with no option at all; `--no-diagnostics` is silent."""
    with _Board(start("run", "--middleware", "dds", *_FREE_PORT)):
        heard = (
            "echo",
            "/diagnostics",
            "--type",
            "diagnostic_msgs/msg/DiagnosticArray",
            "--json",
            "--middleware",
            "dds",
        )
        code, output, _ = done(*heard, "--count", 2)
        assert code == 0
        said = [json.loads(line) for line in output.splitlines()]
    stamps = [array["header"]["stamp"]["sec"] + array["header"]["stamp"]["nanosec"] / 1e9 for array in said]
    assert stamps[0] < stamps[1]
    statuses = {status["name"]: status for status in said[-1]["status"]}
    assert statuses.keys() == {"udp_forwarder", *(f"udp_forwarder: {name}" for name in REGISTRY.by_name)}
    imu = {pair["key"]: pair["value"] for pair in statuses["udp_forwarder: imu_info"]["values"]}
    assert int(imu["count"]) > 0


@needs_dds
def test_top_shows_the_bridge(start: Start, done: Start) -> None:
    """As a page, and as JSON for scripts, from a second program; exit code 1 where no bridge is heard."""
    program = start("run", "--middleware", "dds", *_FREE_PORT)
    with _Board(program):
        live = start("top", "--middleware", "dds", "--json", "--timeout", 60)
        code, output, _ = done("top", "--once", "--middleware", "dds", "--timeout", 60)
        assert (code, output.splitlines()[0]) == (0, "udp_forwarder  OK  nothing lost")
        assert re.search(r"13 +imu_info +hardware→ros +OK", output)
        code, output, _ = done("top", "--once", "--json", "--middleware", "dds", "--timeout", 60)
        page = json.loads(output)
        row = next(row for row in page["rows"] if row["name"] == "imu_info")
        assert (code, row["level"], row["number"], row["topic"]) == (0, "OK", 13, "imu_data")
        assert row["count"] > 0
        live.wait_for('"node"', live.output)
        assert live.interrupt() == 0
    assert program.interrupt() == 0


@needs_dds
def test_a_node_whose_qos_does_not_match_is_shown(
    start: Start, done: Start, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A best-effort publisher of commands: in the log, in the status of the node and in that of the row."""
    for name in ("ROS_LOCALHOST_ONLY", "ROS_DOMAIN_ID"):
        monkeypatch.setenv(name, environment[name])
    program = start("run", "--middleware", "dds", *_FREE_PORT)
    why = "no messages come from a publisher of /joystick (reliability: reliable required, best_effort offered)"
    with open_middleware("dds", NodeIdentity("joystick")) as joystick:
        joystick.publisher("/drive_motor", DrivingBoardMotorMessage, Qos(reliability="best_effort"))
        program.wait_for(f"/drive_motor: {why}; change the QoS of one side")
        code, output, _ = done("top", "--once", "--json", "--middleware", "dds", "--timeout", 60)
    page = json.loads(output)
    row = next(row for row in page["rows"] if row["name"] == "drive_motor")
    assert (code, row["level"], row["message"], row["qos_mismatches"]) == (1, "WARN", why, 1)
    assert page["node"]["message"] == "the QoS of other nodes does not match on drive_motor"
    assert page["node"]["qos_mismatches.drive_motor"] == 1
    assert program.interrupt() == 0


def test_top_without_a_bridge_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """By the name of its node and the topic; exit code 1."""
    assert main(["top", "--once", "--middleware", "memory", "--timeout", "0.1"]) == 1
    assert capsys.readouterr() == ("", "no messages of a bridge named 'udp_forwarder' on /diagnostics within 0.1 s\n")


def _families(page: str) -> dict[str, Any]:
    with urllib.request.urlopen(page) as answer:
        return {family.name: family for family in text_string_to_metric_families(answer.read().decode())}


def _crossed(families: dict[str, Any]) -> dict[str, float]:
    return {sample.labels["row"]: sample.value for sample in families["roverlink_crossed"].samples}


def test_metrics_of_a_running_bridge(start: Start) -> None:
    """The port is told at start, and serves what the bridge has done."""
    program = start("run", "--middleware", "memory", "--no-diagnostics", "--metrics", 0, *_FREE_PORT)
    page = program.wait_for("metrics: ").rpartition(" ")[2]
    with _Board(program):
        wait_until(lambda: _crossed(_families(page))["imu_info"] >= 10, "ten messages")
        families = _families(page)
    samples = {sample.name: sample.value for sample in families["roverlink_handling_seconds"].samples}
    assert samples["roverlink_handling_seconds_count"] >= 10
    assert program.interrupt() == 0


def test_metrics_without_their_package_are_told(done: Start, tmp_path: Path) -> None:
    """The command that installs it is named."""
    (tmp_path / "prometheus_client.py").write_text("raise ImportError('hidden')\n")
    hidden = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    code, _, errors = done("run", "--middleware", "memory", "--metrics", 0, *_FREE_PORT, PYTHONPATH=hidden)
    assert code == 2
    assert "install it with `pip install 'roverlink[metrics]'`" in errors


def test_foxglove_sees_the_topics(start: Start) -> None:
    """A client of its WebSocket protocol is told of every topic with its schema, and gets the messages it asks for."""
    program = start("run", "--middleware", "memory", "--no-diagnostics", "--foxglove", 0, *_FREE_PORT)
    address = program.wait_for("connect Foxglove to ").rpartition(" ")[2]
    with _Board(program):
        channels, message = asyncio.run(asyncio.wait_for(_foxglove(address), 60))
    assert {channel["topic"] for channel in channels} == {f"/{topic}" for topic in REGISTRY.by_topic}
    imu = next(channel for channel in channels if channel["topic"] == "/imu_data")
    assert (imu["encoding"], imu["schemaEncoding"]) == ("cdr", "ros2msg")
    assert imu["schemaName"] == "comms/msg/ImuSensorInformation"
    assert imu["schema"] == definition_of(ImuSensorInformation)
    assert cdr.decode(ImuSensorInformation, message) == ImuSensorInformation(accel_x=1.5)
    assert program.interrupt() == 0


async def _foxglove(address: str) -> tuple[list[dict[str, Any]], bytes]:
    """The channels that a server advertises, and a message of /imu_data."""
    channels: list[dict[str, Any]] = []
    protocols = [websockets.Subprotocol(name) for name in ("foxglove.sdk.v1", "foxglove.websocket.v1")]
    async with websockets.connect(address, subprotocols=protocols) as connection:
        while True:
            data = await connection.recv()
            if isinstance(data, bytes):
                operation, _, _ = struct.unpack_from("<BIQ", data)
                if operation == 1:  # message data: subscription, time, and the message
                    return channels, data[13:]
            elif (said := json.loads(data))["op"] == "advertise":
                channels += said["channels"]
                imu = next((channel["id"] for channel in channels if channel["topic"] == "/imu_data"), None)
                if imu is not None:
                    asked = {"op": "subscribe", "subscriptions": [{"id": 1, "channelId": imu}]}
                    await connection.send(json.dumps(asked))


def test_json_logs(start: Start) -> None:
    """With `--log-format json`, every line on standard error is an object."""
    program = start("run", "--middleware", "memory", "--no-diagnostics", "--log-format", "json", *_FREE_PORT)
    ready = json.loads(program.wait_for("on UDP port "))
    assert (ready["level"], ready["logger"]) == ("info", "udp_forwarder")
    assert program.interrupt() == 0
    assert all("message" in json.loads(line) for line in program.errors)


# --- doctor -----------------------------------------------------------------------------------------------------


@pytest.fixture
def taken() -> Iterator[int]:
    """A UDP port that somebody has."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        yield int(sock.getsockname()[1])


def test_doctor_finds_what_is_wrong(done: Start, taken: int) -> None:
    """A port that is taken, and by whom; a destination that does not resolve; exit code 1."""
    arguments = ("-p", f"listen_port:={taken}", "-p", "listen_address:='127.0.0.1'", "-p", "dst_ip:='rover.invalid'")
    code, output, _ = done("doctor", "--json", "--ros-args", *arguments)
    found = {diagnosis["check"]: diagnosis for diagnosis in json.loads(output)}
    assert code == 1
    assert found[f"UDP port {taken}"]["verdict"] == "error"
    assert "is in use by another program" in found[f"UDP port {taken}"]["says"]
    assert "python" in found[f"UDP port {taken}"]["cure"] or "ss -lunp" in found[f"UDP port {taken}"]["cure"]
    assert found["dst_ip"]["verdict"] == "error"
    assert found["generated code"]["verdict"] == "ok"


def test_doctor_warns_of_small_buffers(done: Start) -> None:
    """With the command that cures it; a warning is no failure."""
    code, output, _ = done("doctor", "--ros-args", "-p", "listen_port:=0", "-p", "receive_buffer:=1073741824")
    assert code == 0 or "error" in output
    assert re.search(r"(warning|ok) +receive buffer: \d+ bytes", output)


def test_doctor_goes_on_where_there_is_no_generated_code(done: Start, tmp_path: Any) -> None:
    """What is not there is told, and the rest is looked at all the same."""
    code, output, _ = done("doctor", "--json", "--project", tmp_path)
    found = {diagnosis["check"]: diagnosis for diagnosis in json.loads(output)}
    assert code == 1
    assert "run `roverlink generate` there" in found["generated code"]["says"]
    assert found["python"]["verdict"] == "ok"


def test_a_foxglove_port_in_use_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2, with the port."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.listen()
        port = sock.getsockname()[1]
        arguments = ["run", "--middleware", "memory", "--no-diagnostics", "--foxglove", str(port), *_FREE_PORT]
        assert main(arguments) == 2
    assert f"cannot serve Foxglove on TCP port {port} of 127.0.0.1" in capsys.readouterr().err
