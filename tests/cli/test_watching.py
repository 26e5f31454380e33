"""A running bridge is watched: diagnostics, metrics, Foxglove, `roverlink top`, and `roverlink doctor` beside it."""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import socket
import struct
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import websockets
from linked import TABLE, linked_registry, write_project
from needs import NO_FOXGLOVE, needs_dds
from polling import PATIENCE_S, wait_until
from programs import Start
from prometheus_client.parser import text_string_to_metric_families
from repeating import repeated
from running import Bridge, Called

from generated.messages import ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.generated_code import changed_sources
from roverlink.runtime.core import cdr
from roverlink.runtime.recording.message_definitions import definition_of

_EVERY_ADDRESS = "0.0.0.0"  # noqa: S104  # on request
_TOP = ("top", "--once", "--middleware", "dds", "--timeout", PATIENCE_S)


@contextlib.contextmanager
def _speaking(port: int, *others: str) -> Iterator[None]:
    """A board that sends one IMU message after the other, fifty a second, and others that send these rows."""
    payloads = [{"imu_info": {"accel_x": 1.5}}, *({name: {}} for name in others)]
    datagrams = [REGISTRY.envelope(**payload).SerializeToString() for payload in payloads]
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def send(_: int) -> None:
        for datagram in datagrams:
            sock.sendto(datagram, ("127.0.0.1", port))

    with sock, repeated(send):
        yield


@pytest.mark.slow
@needs_dds
def test_top_shows_the_bridge(bridge: Bridge, start: Start, called: Called) -> None:
    """As a page, and as JSON for scripts, from a second program; exit code 1 while a board or peer has not spoken."""
    program, port = bridge(middleware="dds")
    with _speaking(port):
        live = start("top", "--middleware", "dds", "--json", "--timeout", PATIENCE_S)
        code, output, _ = called(*_TOP)
        waiting = "/udp_forwarder  WAITING  no message yet from ArmBoard, DrivingBoard, basestation"
        assert (code, output.splitlines()[0]) == (1, waiting)
    with _speaking(port, "arm_pos", "drive_diag", "control_mode"):
        code, output, _ = called(*_TOP)
        assert (code, output.splitlines()[0]) == (0, "/udp_forwarder  OK  nothing lost")
        assert re.search(r"13 +imu_info +hardware→ros +OK", output)
        code, output, _ = called(*_TOP, "--json")
        state = json.loads(output)
        row = next(row for row in state["rows"] if row["name"] == "imu_info")
        assert (code, state["worst"]["level"], row["number"], row["topic"]) == (0, "OK", 13, "imu_data")
        assert row["count"] > 0
        live.wait_for('"node"', live.output)
        assert live.interrupt() == 0
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


@pytest.mark.slow
def test_a_running_bridge_tells_what_it_does(bridge: Bridge) -> None:
    """Metrics count what crosses, a client of Foxglove gets every topic with its schema; every log line is JSON."""
    pytest.importorskip("foxglove", reason=NO_FOXGLOVE)
    foxglove = ("--foxglove", 0, "--foxglove-address", _EVERY_ADDRESS)
    program, port = bridge("--no-diagnostics", "--metrics", 0, *foxglove, "--log-format", "json")
    page, address = (
        json.loads(program.wait_for(text))["message"].rpartition(" ")[2]
        for text in ("metrics: ", "connect Foxglove to ")
    )
    assert _EVERY_ADDRESS not in address
    with _speaking(port):
        wait_until(lambda: _crossed(_families(page))["imu_info"] >= 10, "ten messages")
        families = _families(page)
        channels, message = asyncio.run(asyncio.wait_for(_foxglove(address), 60))
        for headers in ({"Host": "evil.example"}, {"Origin": "https://evil.example"}, {"Origin": "null"}):
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(urllib.request.Request(address.replace("ws:", "http:"), headers=headers))
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


@pytest.mark.slow
def test_doctor_finds_what_is_wrong(called: Called, peer: socket.socket) -> None:
    """A port that is taken, and by whom; exit code 1. A host that does not resolve is a warning: it may boot later."""
    taken = peer.getsockname()[1]
    given = (f"listen_port:={taken}", "listen_address:='127.0.0.1'", "dst_ip:='rover.invalid'")
    code, output, _ = called("doctor", "--json", "--ros-args", *(word for one in given for word in ("-p", one)))
    found = {diagnosis["check"]: diagnosis for diagnosis in json.loads(output)}
    assert code == 1
    assert found[f"UDP port {taken}"]["verdict"] == "error"
    assert "is in use by another program" in found[f"UDP port {taken}"]["says"]
    assert "python" in found[f"UDP port {taken}"]["cure"] or "ss -lunp" in found[f"UDP port {taken}"]["cure"]
    assert found["dst_ip"]["verdict"] == "warning"
    assert "rover.invalid, the host of basestation, hardware, cannot be resolved" in found["dst_ip"]["says"]
    assert found["generated code"]["verdict"] == "ok"
    buffers = called("doctor", "--ros-args", "-p", "listen_port:=0", "-p", "receive_buffer:=1073741824")[1]
    assert re.search(r"(warning|ok) +receive buffer: \d+ bytes", buffers)  # ok where the kernel allows so much


@pytest.mark.slow
def test_the_user_is_warned_if_the_table_was_changed_and_not_generated(
    done: Start, start: Start, tmp_path: Path
) -> None:
    """The bridge uses the generated code, so a row or a host that is only in the table has no effect."""
    project = write_project(tmp_path / "rover")
    for changed, says in (
        ("topic: mode", ""),
        ("topc: mode", "the table has errors, so it was not compared with the generated code"),
        ("topic: wanted_mode", "the generated code is not that of this table"),
    ):
        (project / "mapping.yaml").write_text(TABLE.replace("topic: mode", changed), encoding="utf-8")
        found = json.loads(done("doctor", "--json", "--project", project, "--ros-args", "-p", "listen_port:=0")[1])
        said = "".join(one["says"] for one in found if one["check"] == "mapping.yaml")
        assert says in said
        assert bool(says) == bool(said)
    program = start("run", "--middleware", "memory", "--project", project, "--ros-args", "-p", "listen_port:=0")
    program.wait_for("the generated code is that of an earlier state of mapping.yaml; run `roverlink generate`")
    assert program.interrupt() == 0


_PROTO = "proto/linked/messages.proto"


@pytest.mark.parametrize(
    ("file", "old", "new", "is_old"),
    [
        ("mapping.yaml", "version: 1", "version: 1  # the first", False),
        ("mapping.yaml", "topic: mode", "topic: wanted_mode", True),
        ("mapping.yaml", "version: 1", "version: [", True),
        ("mapping.yaml", "version: 1", "version: &a [*a]", True),
        (_PROTO, ";\n", ";  // the end\n", False),
        (_PROTO, "= 1;", "=1 /* 2 */;", False),
        (_PROTO, "= 1;", "= 2;", True),
    ],
)
def test_code_is_old_if_a_value_or_a_token_has_changed(
    tmp_path: Path, file: str, old: str, new: str, is_old: bool
) -> None:
    """Comments and layout make no difference. Nor does a file that is missing, as on a rover without the sources."""
    project, registry = write_project(tmp_path / "rover"), linked_registry()
    path = project / file
    path.write_text(path.read_text().replace(old, new))
    assert changed_sources(project, registry) == ([file] if is_old else [])
    path.unlink()
    assert changed_sources(project, registry) == []


@pytest.mark.slow
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
@pytest.mark.parametrize("middleware", [pytest.param("dds", marks=needs_dds), "zenoh"])
def test_top_serves_the_page(bridge: Bridge, start: Start, middleware: str, request: pytest.FixtureRequest) -> None:
    """`top --web` shows the rows of a bridge in another process, and the log that it publishes."""
    if middleware == "zenoh":
        request.getfixturevalue("zenoh_router")
    program, port = bridge(middleware=middleware)
    with _speaking(port):
        top = start("top", "--middleware", middleware, "--web", "127.0.0.1:0", "--timeout", PATIENCE_S)
        url = top.wait_for("page: ").rpartition(" ")[2]
        seen: dict[str, dict[str, Any]] = {}
        with urllib.request.urlopen(f"{url}events", timeout=PATIENCE_S) as events:
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
