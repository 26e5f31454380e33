"""A running bridge is watched: diagnostics, metrics, Foxglove, `roverlink top`, and `roverlink doctor` beside it."""

from __future__ import annotations

import asyncio
import contextlib
import fcntl
import json
import os
import pty
import re
import resource
import select
import socket
import struct
import subprocess
import sys
import termios
import threading
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import websockets
from linked import TABLE, write_project
from needs import needs_dds
from polling import wait_until
from prometheus_client.parser import text_string_to_metric_families

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.net.http_server import BoundedServer
from roverlink.runtime.recording.message_definitions import definition_of

Start = Callable[..., Any]

_FREE_PORT = ("--ros-args", "-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'")

_EVERY_ADDRESS = "0.0.0.0"  # noqa: S104  # on request


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


@pytest.mark.slow
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
    links = {"basestation", "hardware", *(f"{board}Board of hardware" for board in ("Arm", "Driving", "Sensor"))}
    parts = {*REGISTRY.by_name, *(f"link to {name}" for name in links)}
    assert statuses.keys() == {"udp_forwarder", *(f"udp_forwarder: {name}" for name in parts)}
    imu = {pair["key"]: pair["value"] for pair in statuses["udp_forwarder: imu_info"]["values"]}
    assert int(imu["count"]) > 0


@needs_dds
def test_top_shows_the_bridge(start: Start, done: Start) -> None:
    """As a page, and as JSON for scripts, from a second program; exit code 1 where no bridge is heard."""
    program = start("run", "--middleware", "dds", *_FREE_PORT)
    with _Board(program):
        live = start("top", "--middleware", "dds", "--json", "--timeout", 60)
        code, output, _ = done("top", "--once", "--middleware", "dds", "--timeout", 60)
        assert (code, output.splitlines()[0]) == (0, "/udp_forwarder  OK  nothing lost")
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
@pytest.mark.slow
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


class _Terminal:
    """`roverlink top` on a terminal of some size, and what it has written."""

    def __init__(self, environment: dict[str, str], columns: int, lines: int) -> None:
        self._file, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
        self.before = termios.tcgetattr(theirs)
        self.theirs = theirs
        kept = {name: value for name, value in environment.items() if name not in ("COLUMNS", "LINES")}

        def own_the_terminal() -> None:
            os.setsid()
            fcntl.ioctl(theirs, termios.TIOCSCTTY, 0)

        self.program = subprocess.Popen(
            [sys.executable, "-m", "roverlink", "top", "--middleware", "dds", "--timeout", "60"],
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            env={**kept, "TERM": "xterm-256color"},
            preexec_fn=own_the_terminal,
        )
        self._text = ""

    def wait_for(self, pattern: str) -> str:
        """What is written from now on, up to a match."""
        self._text = ""

        def read() -> bool:
            if select.select([self._file], [], [], 0.1)[0]:
                self._text += os.read(self._file, 65536).decode(errors="replace")
            plain = re.sub(r"\x1b\[[0-9;]*m", "", self._text)  # without colours
            return re.search(pattern, plain) is not None

        wait_until(read, f"{pattern!r} on the terminal")
        return self._text

    def press(self, keys: str) -> None:
        os.write(self._file, keys.encode())

    def close(self) -> None:
        self.program.kill()
        self.program.wait()
        os.close(self._file)
        os.close(self.theirs)


@pytest.mark.slow
@needs_dds
def test_top_obeys_keys_on_a_small_terminal(start: Start, environment: dict[str, str]) -> None:
    """Arrows scroll to the last row, letters sort and filter, `q` ends it, and the terminal is as it was before."""
    program = start("run", "--middleware", "dds", *_FREE_PORT)
    with _Board(program):
        terminal = _Terminal(environment, 70, 20)
        try:
            terminal.wait_for("datagrams dropped: 0; by the kernel: 0")
            assert terminal.wait_for("row 1 of 21")
            terminal.press("\x1b[F")
            assert "rover_localization" in terminal.wait_for("row 21 of 21")
            terminal.press("s")
            terminal.wait_for("sort: name")
            terminal.press("/imu_")
            terminal.wait_for("row 1 of 1 (?s:.*)filter: imu__")
            terminal.press("\r")
            terminal.wait_for("/ filter: imu_")
            terminal.press("q")
            terminal.wait_for(re.escape("\x1b[?1049l"))
            assert terminal.program.wait(60) == 0
            assert termios.tcgetattr(terminal.theirs) == terminal.before
        finally:
            terminal.close()
    assert program.interrupt() == 0


@needs_dds
@pytest.mark.slow
def test_top_warns_of_two_bridges_with_one_name(start: Start, done: Start) -> None:
    """With both processes; exit code 1; of two names, each bridge is shown, and `--node` selects one."""
    programs = [start("run", "--middleware", "dds", *_FREE_PORT, *more) for more in ((), (), ("-r", "__node:=another"))]
    for program in programs:
        program.wait_for("on UDP port ")
    heard: dict[str, int] = {}

    def all_heard() -> bool:
        nonlocal heard
        code, output, errors = done("top", "--once", "--middleware", "dds", "--timeout", 60)
        titles = [line for line in output.splitlines() if line.startswith("/")]
        heard = {"code": code, "titles": len(titles), "warned": "warning: 2 bridges are named '/udp_fo" in errors}
        return heard == {"code": 1, "titles": 3, "warned": True}

    # A command that has just started may hear one bridge later than the others.
    wait_until(all_heard, "all three bridges in one answer")
    code, output, errors = done("top", "--once", "--middleware", "dds", "--timeout", 60, "--node", "another")
    assert (code, output.splitlines()[0], errors) == (0, "/another  OK  nothing lost", "")
    for program in programs:
        assert program.interrupt() == 0


def test_top_without_a_bridge_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """By the names that were asked for and the topic; exit code 1."""
    assert main(["top", "--once", "--middleware", "memory", "--timeout", "0.1"]) == 1
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith("no messages of a bridge on /diagnostics within 0.1 s; check that")
    assert main(["top", "--once", "--middleware", "memory", "--timeout", "0.1", "--node", "a", "--node", "b"]) == 1
    assert "no messages of a bridge named 'a' or named 'b' on /diagnostics" in capsys.readouterr().err


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


def _threads(program: Any) -> int:
    status = Path(f"/proc/{program.pid}/status").read_text(encoding="utf-8")
    return int(re.search(r"^Threads:\s*(\d+)", status, re.MULTILINE)[1])  # type: ignore[index]  # always there


@pytest.mark.slow
def test_slow_clients_do_not_stop_a_scrape(start: Start) -> None:
    """Not 1,000 that send half a request and wait: threads stay few, and nothing is said about half a request."""
    program = start("run", "--middleware", "memory", "--no-diagnostics", "--metrics", 0, *_FREE_PORT)
    page = program.wait_for("metrics: ").rpartition(" ")[2]
    port = int(page.split(":")[2].partition("/")[0])
    before = _threads(program)
    limit = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(limit[0], min(4096, limit[1])), limit[1]))
    with contextlib.ExitStack() as clients:
        clients.callback(resource.setrlimit, resource.RLIMIT_NOFILE, limit)
        for _ in range(1000):
            client = clients.enter_context(socket.create_connection(("127.0.0.1", port), 60))
            client.sendall(b"GET /metrics HTTP/1.1\r\nHost: x")
        for _ in range(10):
            assert "roverlink_received" in _families(page)
            assert _threads(program) <= before + BoundedServer.connections + 1
        # A client that resets its connection in the middle of its request.
        client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    with socket.create_connection(("127.0.0.1", port), 60) as client:
        client.sendall(b"GET /met")
    assert "roverlink_received" in _families(page)
    assert program.interrupt() == 0
    assert program.errors[-1].count("received 0, published 0") == 1
    assert not [line for line in program.errors if "xception" in line or not line.startswith("[")]


def test_foxglove_sees_the_topics(start: Start) -> None:
    """A client of its WebSocket protocol is told of every topic with its schema, and gets the messages it asks for."""
    everywhere = ("--ros-args", "-p", "listen_port:=0")  # the bridge is on all addresses, Foxglove is not
    program = start("run", "--middleware", "memory", "--no-diagnostics", "--foxglove", 0, *everywhere)
    address = program.wait_for("connect Foxglove to ").rpartition(" ")[2]
    assert address.startswith("ws://127.0.0.1:")
    with _Board(program):
        channels, message = asyncio.run(asyncio.wait_for(_foxglove(address), 60))
    assert {channel["topic"] for channel in channels} == {f"/{topic}" for topic in REGISTRY.by_topic}
    imu = next(channel for channel in channels if channel["topic"] == "/imu_data")
    assert (imu["encoding"], imu["schemaEncoding"]) == ("cdr", "ros2msg")
    assert imu["schemaName"] == "comms/msg/ImuSensorInformation"
    assert imu["schema"] == definition_of(ImuSensorInformation)
    assert cdr.decode(ImuSensorInformation, message) == ImuSensorInformation(accel_x=1.5)
    assert program.interrupt() == 0


def test_foxglove_is_offered_to_others_on_request(start: Start) -> None:
    """On all addresses, the address in the log is one that can be opened."""
    options = ("--no-diagnostics", "--foxglove", 0, "--foxglove-address", _EVERY_ADDRESS)
    program = start("run", "--middleware", "memory", *options, *_FREE_PORT)
    address = program.wait_for("connect Foxglove to ").rpartition(" ")[2]
    assert _EVERY_ADDRESS not in address
    with _Board(program):
        channels, _ = asyncio.run(asyncio.wait_for(_foxglove(address), 60))
    assert channels
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
    """A port that is taken, and by whom; exit code 1. A host that does not resolve is a warning: it may boot later."""
    arguments = ("-p", f"listen_port:={taken}", "-p", "listen_address:='127.0.0.1'", "-p", "dst_ip:='rover.invalid'")
    code, output, _ = done("doctor", "--json", "--ros-args", *arguments)
    found = {diagnosis["check"]: diagnosis for diagnosis in json.loads(output)}
    assert code == 1
    assert found[f"UDP port {taken}"]["verdict"] == "error"
    assert "is in use by another program" in found[f"UDP port {taken}"]["says"]
    assert "python" in found[f"UDP port {taken}"]["cure"] or "ss -lunp" in found[f"UDP port {taken}"]["cure"]
    assert found["dst_ip"]["verdict"] == "warning"
    assert "rover.invalid, the host of basestation, hardware, cannot be resolved" in found["dst_ip"]["says"]
    assert found["generated code"]["verdict"] == "ok"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ("topic: mode", None),
        ("topic: wanted_mode", "the generated code is not that of this table"),
        ("topc: mode", "the table has errors, so it was not compared with the generated code"),
    ],
)
def test_doctor_warns_if_the_table_was_changed_and_not_generated(
    done: Start, tmp_path: Path, changed: str, says: str | None
) -> None:
    """The bridge uses the generated code, so a row or a host that is only in the table has no effect."""
    project = write_project(tmp_path / "rover")
    (project / "mapping.yaml").write_text(TABLE.replace("topic: mode", changed), encoding="utf-8")
    free = ("--ros-args", "-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'")
    found = json.loads(done("doctor", "--json", "--project", project, *free)[1])
    said = [one["says"] for one in found if one["check"] == "mapping.yaml"]
    assert said == [] if says is None else says in said[0]


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
    assert found["not checked"]["says"].startswith("UDP port, receive buffer, dst_ip and firewall were not checked")
    assert {"python", "multicast"} <= found.keys()


def test_doctor_tells_what_a_wrong_parameter_keeps_from_being_checked(done: Start) -> None:
    """The parameter is named, not the generated code; the checks that need no parameters are made."""
    code, output, _ = done("doctor", "--ros-args", "-p", "listen_port:=70000")
    assert code == 1
    assert re.search(r"^ok +generated code: ", output, re.MULTILINE)
    assert re.search(r"^error +parameters: .*listen_port", output, re.MULTILINE)
    assert re.search(r"^warning +not checked: UDP port, ", output, re.MULTILINE)
    assert " multicast: " in output
    assert "UDP port 70000" not in output


@pytest.mark.slow
@needs_dds
def test_top_serves_the_page(start: Start) -> None:
    """`top --web` shows the rows of a bridge in another process, and the log that it publishes."""
    program = start("run", "--middleware", "dds", *_FREE_PORT)
    with _Board(program):
        top = start("top", "--middleware", "dds", "--web", "127.0.0.1:0", "--timeout", 60)
        url = top.wait_for("page: ").rpartition(" ")[2]
        seen: dict[str, dict[str, Any]] = {}
        with urllib.request.urlopen(f"{url}events", timeout=60) as events:
            while not (seen.get("state") and seen.get("log", {}).get("lines")):
                name = events.readline().decode().strip()
                if name.startswith("event: "):
                    seen[name.removeprefix("event: ")] = json.loads(events.readline().decode().removeprefix("data: "))
        row = next(row for row in seen["state"]["rows"] if row["name"] == "imu_info")
        assert row["count"] > 0
        assert not seen["state"]["has_values"]
        assert any("bridges" in line["text"] for line in seen["log"]["lines"])
        assert top.interrupt() == 0
    assert program.interrupt() == 0


def _shown(url: str, count: int) -> tuple[list[str], str]:
    """The bridges in the list of a page, as soon as there are so many, and the name of the one whose state comes."""
    ids: list[str] = []
    deadline = time.monotonic() + 60
    with urllib.request.urlopen(f"{url}events", timeout=60) as events:
        while True:
            assert time.monotonic() < deadline, ids
            name = events.readline().decode().strip()
            if name in ("event: bridges", "event: state"):
                content = json.loads(events.readline().decode().removeprefix("data: "))
                if name == "event: bridges":
                    ids = [bridge["id"] for bridge in content["bridges"]]
                elif len(ids) == count:
                    return ids, content["node"]["full_name"]


@pytest.mark.slow
@needs_dds
def test_the_page_of_top_shows_all_bridges(start: Start) -> None:
    """All that run, and one that starts later; with `--node`, those with this name."""
    start("run", "--middleware", "dds", *_FREE_PORT).wait_for("on UDP port ")
    urls = {}
    for options in ((), ("--node", "udp_forwarder")):
        top = start("top", "--middleware", "dds", "--web", "127.0.0.1:0", "--timeout", 60, *options)
        urls[options] = top.wait_for("page: ").rpartition(" ")[2]
        assert _shown(urls[options], 1) == (["/udp_forwarder"], "/udp_forwarder")
    start("run", "--middleware", "dds", *_FREE_PORT, "-r", "__node:=another").wait_for("on UDP port ")
    assert _shown(urls[()], 2)[0] == ["/another", "/udp_forwarder"]
    assert _shown(urls[()], 2)[1] == "/another"  # without a selection, the first by name
    assert _shown(urls["--node", "udp_forwarder"], 1) == (["/udp_forwarder"], "/udp_forwarder")
