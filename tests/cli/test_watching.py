"""A running bridge is watched: diagnostics, metrics, Foxglove, `roverlink top`, and `roverlink doctor` beside it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import resource
import socket
import struct
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import websockets
from linked import TABLE, write_project
from needs import needs_dds
from polling import wait_until
from programs import Start
from prometheus_client.parser import text_string_to_metric_families
from repeating import repeated
from running import Bridge, Called
from terminals import Terminal

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.net.http_server import BoundedServer
from roverlink.runtime.recording.message_definitions import definition_of

_EVERY_ADDRESS = "0.0.0.0"  # noqa: S104  # on request
_TOP = ("top", "--once", "--middleware", "dds", "--timeout", 60)


@contextlib.contextmanager
def _speaking(port: int) -> Iterator[None]:
    """A board that sends one IMU message after the other, fifty a second."""
    datagram = REGISTRY.envelope(imu_info={"accel_x": 1.5}).SerializeToString()
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(_: int) -> None:
        sock.sendto(datagram, ("127.0.0.1", port))

    with sock, repeated(send):
        yield


@pytest.mark.slow
@needs_dds
def test_diagnostics_are_heard_by_anybody(bridge: Bridge, called: Called) -> None:
    """Once a second, as diagnostic_msgs, with no option at all; `--no-diagnostics` is silent."""
    _, port = bridge(middleware="dds")
    with _speaking(port):
        heard = ("/diagnostics", "--type", "diagnostic_msgs/msg/DiagnosticArray", "--json", "--middleware", "dds")
        code, output, _ = called("echo", *heard, "--count", 2)
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
def test_top_shows_the_bridge(bridge: Bridge, start: Start, called: Called) -> None:
    """As a page, and as JSON for scripts, from a second program; exit code 1 where no bridge is heard."""
    program, port = bridge(middleware="dds")
    with _speaking(port):
        live = start("top", "--middleware", "dds", "--json", "--timeout", 60)
        code, output, _ = called(*_TOP)
        assert (code, output.splitlines()[0]) == (0, "/udp_forwarder  OK  nothing lost")
        assert re.search(r"13 +imu_info +hardware→ros +OK", output)
        code, output, _ = called(*_TOP, "--json")
        row = next(row for row in json.loads(output)["rows"] if row["name"] == "imu_info")
        assert (code, row["level"], row["number"], row["topic"]) == (0, "OK", 13, "imu_data")
        assert row["count"] > 0
        live.wait_for('"node"', live.output)
        assert live.interrupt() == 0
    assert program.interrupt() == 0


@needs_dds
@pytest.mark.slow
def test_a_node_whose_qos_does_not_match_is_shown(bridge: Bridge, called: Called) -> None:
    """A best-effort publisher of commands: in the log, in the status of the node and in that of the row."""
    program, _ = bridge(middleware="dds")
    why = "no messages come from a publisher of /joystick (reliability: reliable required, best_effort offered)"
    with open_middleware("dds", NodeIdentity("joystick")) as joystick:
        joystick.publisher("/drive_motor", DrivingBoardMotorMessage, Qos(reliability="best_effort"))
        program.wait_for(f"/drive_motor: {why}; change the QoS of one side")
        code, output, _ = called(*_TOP, "--json")
    page = json.loads(output)
    row = next(row for row in page["rows"] if row["name"] == "drive_motor")
    assert (code, row["level"], row["message"], row["qos_mismatches"]) == (1, "WARN", why, 1)
    assert page["node"]["message"] == "the QoS of other nodes does not match on drive_motor"
    assert page["node"]["qos_mismatches.drive_motor"] == 1
    assert program.interrupt() == 0


@pytest.mark.slow
@needs_dds
def test_top_obeys_keys_on_a_small_terminal(bridge: Bridge) -> None:
    """Arrows scroll to the last row, letters sort and filter, `q` ends it, and the terminal is as it was before."""
    program, port = bridge(middleware="dds")
    words = ("top", "--middleware", "dds", "--timeout", 60)
    with _speaking(port), Terminal(*words, columns=70, lines=20) as terminal:
        terminal.wait_for("datagrams dropped: 0; by the kernel: 0")
        terminal.wait_for("row 1 of 21")
        terminal.type("\x1b[F")
        assert "rover_localization" in terminal.wait_for("row 21 of 21")
        terminal.type("s")
        terminal.wait_for("sort: name")
        terminal.type("/imu_")
        terminal.wait_for("row 1 of 1 (?s:.*)filter: imu__")
        terminal.type("\r")
        terminal.wait_for("/ filter: imu_")
        terminal.type("q")
        terminal.wait_for(re.escape("\x1b[?1049l"))
        assert terminal.end() == 0
        assert terminal.left_as_it_was()
    assert program.interrupt() == 0


@needs_dds
@pytest.mark.slow
def test_top_warns_of_two_bridges_with_one_name(bridge: Bridge, called: Called) -> None:
    """With both processes; exit code 1; of two names, each bridge is shown, and `--node` selects one."""
    programs = [bridge(ros=more, middleware="dds")[0] for more in ((), (), ("-r", "__node:=another"))]

    def all_heard() -> bool:
        code, output, errors = called(*_TOP)
        titles = [line for line in output.splitlines() if line.startswith("/")]
        return (code, len(titles), "warning: 2 bridges are named '/udp_fo" in errors) == (1, 3, True)

    # A command that has just started may hear one bridge later than the others.
    wait_until(all_heard, "all three bridges in one answer")
    code, output, errors = called(*_TOP, "--node", "another")
    assert (code, output.splitlines()[0], errors) == (0, "/another  OK  nothing lost", "")
    for program in programs:
        assert program.interrupt() == 0


def test_top_without_a_bridge_is_told(called: Called) -> None:
    """By the names that were asked for and the topic; exit code 1."""
    words = ("top", "--once", "--middleware", "memory", "--timeout", "0.1")
    code, output, errors = called(*words)
    assert (code, output) == (1, "")
    assert errors.startswith("no messages of a bridge on /diagnostics within 0.1 s; check that")
    assert (
        "no messages of a bridge named 'a' or named 'b' on /diagnostics"
        in called(*words, "--node", "a", "--node", "b")[2]
    )


def _families(page: str) -> dict[str, Any]:
    with urllib.request.urlopen(page) as answer:
        return {family.name: family for family in text_string_to_metric_families(answer.read().decode())}


def _crossed(families: dict[str, Any]) -> dict[str, float]:
    return {sample.labels["row"]: sample.value for sample in families["roverlink_crossed"].samples}


def test_a_running_bridge_tells_what_it_does(bridge: Bridge) -> None:
    """Metrics count what crosses, a client of Foxglove gets every topic with its schema; every log line is JSON."""
    options = ("--no-diagnostics", "--metrics", 0, "--foxglove", 0, "--log-format", "json")
    program, port = bridge(*options)
    page, address = (
        json.loads(program.wait_for(text))["message"].rpartition(" ")[2]
        for text in ("metrics: ", "connect Foxglove to ")
    )
    assert address.startswith("ws://127.0.0.1:")
    with _speaking(port):
        wait_until(lambda: _crossed(_families(page))["imu_info"] >= 10, "ten messages")
        families = _families(page)
        channels, message = asyncio.run(asyncio.wait_for(_foxglove(address), 60))
    samples = {sample.name: sample.value for sample in families["roverlink_handling_seconds"].samples}
    assert samples["roverlink_handling_seconds_count"] >= 10
    assert {channel["topic"] for channel in channels} == {f"/{topic}" for topic in REGISTRY.by_topic}
    imu = next(channel for channel in channels if channel["topic"] == "/imu_data")
    assert (imu["encoding"], imu["schemaEncoding"]) == ("cdr", "ros2msg")
    assert imu["schemaName"] == "comms/msg/ImuSensorInformation"
    assert imu["schema"] == definition_of(ImuSensorInformation)
    assert cdr.decode(ImuSensorInformation, message) == ImuSensorInformation(accel_x=1.5)
    assert program.interrupt() == 0
    lines = [json.loads(line) for line in program.errors]
    assert all("message" in line for line in lines)
    assert {(line["level"], line["logger"]) for line in lines} == {("info", "udp_forwarder")}


def _threads(program: Any) -> int:
    status = Path(f"/proc/{program.pid}/status").read_text(encoding="utf-8")
    return int(re.search(r"^Threads:\s*(\d+)", status, re.MULTILINE)[1])  # type: ignore[index]  # always there


@pytest.mark.slow
def test_slow_clients_do_not_stop_a_scrape(bridge: Bridge) -> None:
    """Not 1,000 that send half a request and wait: threads stay few, and nothing is said about half a request."""
    program, _ = bridge("--no-diagnostics", "--metrics", 0)
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


def test_foxglove_is_offered_to_others_on_request(bridge: Bridge) -> None:
    """On all addresses, the address in the log is one that can be opened."""
    program, port = bridge("--no-diagnostics", "--foxglove", 0, "--foxglove-address", _EVERY_ADDRESS)
    address = program.wait_for("connect Foxglove to ").rpartition(" ")[2]
    assert _EVERY_ADDRESS not in address
    with _speaking(port):
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


# --- doctor -----------------------------------------------------------------------------------------------------


_FREE_PORT = ("--ros-args", "-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'")


def test_doctor_finds_what_is_wrong(called: Called, peer: socket.socket) -> None:
    """A port that is taken, and by whom; exit code 1. A host that does not resolve is a warning: it may boot later."""
    taken = peer.getsockname()[1]
    arguments = ("-p", f"listen_port:={taken}", "-p", "listen_address:='127.0.0.1'", "-p", "dst_ip:='rover.invalid'")
    code, output, _ = called("doctor", "--json", "--ros-args", *arguments)
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


def test_doctor_warns_of_small_buffers(called: Called) -> None:
    """With the command that cures it; a warning is no failure."""
    code, output, _ = called("doctor", "--ros-args", "-p", "listen_port:=0", "-p", "receive_buffer:=1073741824")
    assert code == 0 or "error" in output
    assert re.search(r"(warning|ok) +receive buffer: \d+ bytes", output)


def test_doctor_goes_on_where_something_keeps_it_from_checking(called: Called, tmp_path: Path) -> None:
    """Without generated code, or with a wrong parameter: that is told, and the rest is looked at all the same."""
    code, output, _ = called("doctor", "--json", "--project", tmp_path)
    found = {diagnosis["check"]: diagnosis for diagnosis in json.loads(output)}
    assert code == 1
    assert "run `roverlink generate` there" in found["generated code"]["says"]
    assert found["not checked"]["says"].startswith("UDP port, receive buffer, dst_ip and firewall were not checked")
    assert {"python", "multicast"} <= found.keys()
    code, output, _ = called("doctor", "--ros-args", "-p", "listen_port:=70000")
    assert code == 1
    for line in (r"ok +generated code: ", r"error +parameters: .*listen_port", r"warning +not checked: UDP port, "):
        assert re.search(f"^{line}", output, re.MULTILINE)
    assert " multicast: " in output
    assert "UDP port 70000" not in output


@pytest.mark.slow
@needs_dds
def test_top_serves_the_page(bridge: Bridge, start: Start) -> None:
    """`top --web` shows the rows of a bridge in another process, and the log that it publishes."""
    program, port = bridge(middleware="dds")
    with _speaking(port):
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
def test_the_page_of_top_shows_all_bridges(bridge: Bridge, start: Start) -> None:
    """All that run, and one that starts later; with `--node`, those with this name."""
    bridge(middleware="dds")
    urls = {}
    for options in ((), ("--node", "udp_forwarder")):
        top = start("top", "--middleware", "dds", "--web", "127.0.0.1:0", "--timeout", 60, *options)
        urls[options] = top.wait_for("page: ").rpartition(" ")[2]
        assert _shown(urls[options], 1) == (["/udp_forwarder"], "/udp_forwarder")
    bridge(ros=["-r", "__node:=another"], middleware="dds")
    assert _shown(urls[()], 2)[0] == ["/another", "/udp_forwarder"]
    assert _shown(urls[()], 2)[1] == "/another"  # without a selection, the first by name
    assert _shown(urls["--node", "udp_forwarder"], 1) == (["/udp_forwarder"], "/udp_forwarder")
