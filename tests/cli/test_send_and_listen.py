"""`roverlink send` and `roverlink listen`: envelopes as boards send and receive them."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from polling import wait_until
from programs import Start
from running import Called

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime.text.values import payload_to_values


def _sent(peer: socket.socket, *arguments: str) -> Any:
    """The envelope that a `send` of these arguments makes."""
    assert main(["send", *arguments, "--to", f"127.0.0.1:{peer.getsockname()[1]}"]) == 0
    return REGISTRY.envelope.FromString(peer.recv(65_536))


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["imu_info", "accel_x=0.12", "accel_y=-9.81"], {"imu_info": {"accel_x": 0.12, "accel_y": -9.81}}),
        (["imu_info", "error_code=5", "state=SENSOR_ERROR"], {"imu_info": {"error_code": 5, "state": 3}}),
        (["detected_object", "bbox={x: 7, width: 9}"], {"detected_object": {"bbox": {"x": 7, "width": 9}}}),
        (
            ["--count", "1", "imu_info", "accel_x=1", "--rate", "9", "accel_y=2"],
            {"imu_info": {"accel_x": 1, "accel_y": 2}},
        ),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_each_way_to_say_a_value(peer: socket.socket, arguments: list[str], expected: dict[str, Any]) -> None:
    """Numbers, enum values by name or number, nested fields; options may stand between them."""
    assert _sent(peer, *arguments) == REGISTRY.envelope(**expected)


def test_count_and_rate(
    peer: socket.socket, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """So many are sent, and so many a second."""
    pauses: list[float] = []
    clock = SimpleNamespace(monotonic=lambda: sum(pauses), sleep=pauses.append)
    monkeypatch.setattr("roverlink.commands.send.time", clock)
    _sent(peer, "imu_info", "accel_x=1", "--count", "6", "--rate", "50")
    assert pauses == pytest.approx([0, *[1 / 50] * 5])
    datagrams = [peer.recv(65_536) for _ in range(5)]
    assert set(datagrams) == {REGISTRY.envelope(imu_info={"accel_x": 1}).SerializeToString()}
    assert capsys.readouterr().out.startswith("sent 6 x imu_info (7 bytes) to 127.0.0.1:")


def test_the_list_names_every_payload_and_field(called: Called) -> None:
    """`--list` shows number, name, direction and type of each payload, its fields, and the names of enum values."""
    code, output, _ = called("send", "--list", folder=Path(__file__).parents[2] / "proto" / "components")
    assert code == 0
    lines = [" ".join(line.split()) for line in output.splitlines()]
    for handler in REGISTRY.handlers:
        route = handler.route
        start = lines.index(f"{route.number} {route.name} {route.direction} {handler.payload_type.DESCRIPTOR.name}")
        fields = handler.payload_type.DESCRIPTOR.fields
        assert [line.split()[0] for line in lines[start + 1 : start + 1 + len(fields)]] == [f.name for f in fields]
    assert "mode (MODE_MANUAL, MODE_AUTO)" in lines
    assert "bbox (BoundingBox)" in lines


def _send(port: int, *datagrams: bytes) -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for datagram in datagrams:
            sock.sendto(datagram, ("127.0.0.1", port))
        sent_from: int = sock.getsockname()[1]
        return sent_from


def _listening(start: Start, *arguments: object) -> tuple[Any, int]:
    program = start("listen", "--port", 0, "--address", "127.0.0.1", *arguments)
    return program, int(program.wait_for("listening on UDP port ").rpartition(" ")[2])


@pytest.mark.slow
def test_each_datagram_is_one_line_of_json(start: Start) -> None:
    """Number, name, sender and all fields, zeros included; what is no payload is told with its size; then it ends."""
    program, port = _listening(start, "--count", len(REGISTRY.handlers) + 5)
    payloads = {h.route.name: payload_at(h.payload_type, 1.0) for h in REGISTRY.handlers}
    rubbish = (b"\xff" * 5, bytes.fromhex("ca01"), b"", bytes.fromhex("6a"), bytes.fromhex("6a00") + bytes(9))
    sent_from = _send(port, *(REGISTRY.envelope(**{n: p}).SerializeToString() for n, p in payloads.items()), *rubbish)
    assert program.end() == 0
    lines = [json.loads(line) for line in program.output]
    assert lines[:-5] == [
        {
            "from": f"127.0.0.1:{sent_from}",
            "number": handler.route.number,
            "name": handler.route.name,
            "payload": payload_to_values(payloads[handler.route.name]),
        }
        for handler in REGISTRY.handlers
    ]
    malformed, unknown, empty, *padded = lines[-5:]
    assert malformed["error"].startswith("not a valid PBEnvelope: 5 bytes")
    assert (unknown["error"], unknown["bytes"]) == ("unknown payload numbers [25]", 2)
    assert (empty["error"], empty["bytes"]) == ("empty", 0)
    assert [line["name"] for line in padded] == ["imu_info", "imu_info"]


@pytest.mark.slow
def test_what_is_sent_is_heard_until_an_interrupt(start: Start, capsys: pytest.CaptureFixture[str]) -> None:
    """The two commands fit together; Ctrl-C is how listening is meant to end: exit code 0, and what came is there."""
    program, port = _listening(start)
    words = ("drive_motor", "distance_to_go=1.5", "--to", f"127.0.0.1:{port}", "--count", "2", "--rate", "99")
    assert main(["send", *words]) == 0
    wait_until(lambda: len(program.output) == 2, "both payloads")
    assert program.interrupt() == 0
    payloads = [json.loads(line)["payload"] for line in program.output]
    assert payloads == [{"distance_to_go": 1.5, "turning_radius": 0.0}] * 2


@pytest.mark.slow
def test_the_commands_speak_over_a_line(start: Start, tmp_path: Path, called: Called, free_port: int) -> None:
    """A line at both ends: what `send` and a simulated peer send over it is heard by `listen`."""
    line = f"tcp:127.0.0.1:{free_port}"
    program = start("listen", "--address", f"{line}?listen")
    program.wait_for("nobody has connected")
    assert main(["send", "imu_info", "accel_x=1.5", "--to", line]) == 0
    program.wait_for("accel_x", program.output)
    assert json.loads(program.output[0])["from"] == f"{line}?listen"
    code, output, _ = called("simulate", "--peer", "hardware", "--to", line, "--seconds", "0.5")
    assert (code, "the bridge should have counted" in output) == (0, True)
    wait_until(lambda: len(program.output) > 20, "the simulated boards")
    names = {json.loads(one)["name"] for one in program.output}
    assert {REGISTRY.by_name[name].route.peer for name in names} == {"hardware"}
    assert program.interrupt() == 0
    code, _, errors = called("send", "imu_info", "--to", f"serial:{tmp_path}/none")
    assert (code, errors.split(": there is no ")[1]) == (2, f"{tmp_path}/none; connect the cable")
    code, _, errors = called("simulate", "--to", "tcp:10.0.0.7", "--seconds", "1")
    assert (code, errors) == (2, "roverlink: 'tcp:10.0.0.7': write an address such as tcp:10.0.0.7:7000")
