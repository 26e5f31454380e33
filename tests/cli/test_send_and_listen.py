"""`roverlink send` and `roverlink listen`: envelopes as boards send and receive them."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime.text.values import payload_to_values

Start = Callable[..., Any]


@pytest.fixture
def receiver() -> Iterator[socket.socket]:
    """A socket to send to."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        sock.settimeout(60)
        yield sock


def _sent(receiver: socket.socket, *arguments: str) -> Any:
    """The envelope that a `send` of these arguments makes."""
    assert main(["send", *arguments, "--to", f"127.0.0.1:{receiver.getsockname()[1]}"]) == 0
    return REGISTRY.envelope.FromString(receiver.recv(65_536))


# --- send -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("handler", REGISTRY.handlers, ids=lambda handler: handler.route.name)
def test_every_payload_can_be_sent(receiver: socket.socket, handler: Any) -> None:
    """Each payload of the table goes out empty, in an envelope of its own."""
    name = handler.route.name
    assert _sent(receiver, name) == REGISTRY.envelope(**{name: handler.payload_type()})


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["imu_info", "accel_x=0.12", "accel_y=-9.81"], {"imu_info": {"accel_x": 0.12, "accel_y": -9.81}}),
        (["imu_info", "is_calibrated=true"], {"imu_info": {"is_calibrated": True}}),
        (["imu_info", "error_code=IMU_SENSOR_FAULT"], {"imu_info": {"error_code": 5}}),
        (["imu_info", "error_code=5", "state=SENSOR_ERROR"], {"imu_info": {"error_code": 5, "state": 3}}),
        (["imu_info", "error_code=300"], {"imu_info": {"error_code": 300}}),
        (["detected_object", "bbox.x=7", "bbox.width=9"], {"detected_object": {"bbox": {"x": 7, "width": 9}}}),
        (["detected_object", "bbox={x: 7, width: 9}"], {"detected_object": {"bbox": {"x": 7, "width": 9}}}),
        (["sensor_diag", "imu_sensor.state=SENSOR_IDLE"], {"sensor_diag": {"imu_sensor": {}}}),
        (["gps_info", "utc_timestamp=9223372036854775807"], {"gps_info": {"utc_timestamp": 2**63 - 1}}),
        (["control_mode", "mode=MODE_AUTO"], {"control_mode": {"mode": 1}}),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_each_way_to_say_a_value(receiver: socket.socket, arguments: list[str], expected: dict[str, Any]) -> None:
    """Numbers, flags, enum values by name or number, nested fields by dots or as mappings."""
    assert _sent(receiver, *arguments) == REGISTRY.envelope(**expected)


def test_options_may_stand_anywhere(receiver: socket.socket) -> None:
    """Options before, between and behind the assignments mean the same."""
    envelope = _sent(receiver, "--count", "1", "imu_info", "accel_x=1", "--rate", "100", "accel_y=2")
    assert envelope == REGISTRY.envelope(imu_info={"accel_x": 1, "accel_y": 2})


def test_count_and_rate(
    receiver: socket.socket, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """So many are sent, and so many a second."""
    pauses: list[float] = []
    clock = SimpleNamespace(monotonic=lambda: sum(pauses), sleep=pauses.append)
    monkeypatch.setattr("roverlink.commands.send.time", clock)
    _sent(receiver, "imu_info", "accel_x=1", "--count", "6", "--rate", "50")
    assert pauses == pytest.approx([0, *[1 / 50] * 5])
    datagrams = [receiver.recv(65_536) for _ in range(5)]
    assert set(datagrams) == {REGISTRY.envelope(imu_info={"accel_x": 1}).SerializeToString()}
    assert capsys.readouterr().out.startswith("sent 6 x imu_info (7 bytes) to 127.0.0.1:")


def test_the_list_names_every_payload_and_field(capsys: pytest.CaptureFixture[str]) -> None:
    """`--list` shows number, name, direction and type of each payload, its fields, and the names of enum values."""
    assert main(["send", "--list"]) == 0
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    for handler in REGISTRY.handlers:
        route = handler.route
        start = lines.index(f"{route.number} {route.name} {route.direction} {handler.payload_type.DESCRIPTOR.name}")
        fields = handler.payload_type.DESCRIPTOR.fields
        assert [line.split()[0] for line in lines[start + 1 : start + 1 + len(fields)]] == [f.name for f in fields]
    assert "mode (MODE_MANUAL, MODE_AUTO)" in lines
    assert "bbox (BoundingBox)" in lines


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["send"], "no payload is given; `roverlink send --list` lists all payloads"),
        (["send", "imu_inf"], "unknown payload 'imu_inf'; did you mean 'imu_info'?"),
        (["send", "zzz"], "unknown payload 'zzz'; known: ph_info, arm_ctrl"),
        (["send", "imu_info", "accel_q=1"], "SensorBoardIMUInfo has no field 'accel_q'; did you mean 'accel_z'?"),
        (["send", "imu_info", "accel_x"], "'accel_x' is not of the form field=value"),
        (["send", "imu_info", "=1"], "'=1' is not of the form field=value"),
        (["send", "imu_info", "accel_x=fast"], "accel_x: 'fast' is not a valid float"),
        (["send", "imu_info", "accel_x=1e39"], "accel_x: '1e39' is not a valid float"),
        (["send", "imu_info", "accel_x=1", "accel_x=2"], "the field 'accel_x' is assigned more than once"),
        (["send", "imu_info", "error_code=IMU_SENSOR_FALT"], "did you mean 'IMU_SENSOR_FAULT'?"),
        (["send", "imu_info", "accel_x.y=1"], "SensorBoardIMUInfo.accel_x is not a message"),
        (["send", "detected_object", "bbox=3"], "bbox: '3' is not a mapping"),
        (["send", "imu_info", "--to", "127.0.0.1"], "'127.0.0.1' is not of the form HOST:PORT"),
        (["send", "imu_info", "--to", ":5000"], "':5000' is not of the form HOST:PORT"),
        (["send", "imu_info", "--to", "localhost:0"], "'localhost:0' is not of the form HOST:PORT"),
        (["send", "imu_info", "--to", "localhost:65536"], "'localhost:65536' is not of the form HOST:PORT"),
        (["send", "imu_info", "--to", "localhost:http"], "'localhost:http' is not of the form HOST:PORT"),
        (["send", "imu_info", "--to", "rover.invalid:5000"], "the destination 'rover.invalid' does not resolve"),
        (
            ["send", "imu_info", "--to", "255.255.255.255:5000"],
            "255.255.255.255:5000: Permission denied",
        ),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_what_cannot_be_sent_is_told(arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2, nothing on standard output, and one line that quotes what is wrong and says what there is."""
    assert main(arguments) == 2
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith("roverlink: ")
    assert expected in errors


# --- listen -----------------------------------------------------------------------------------------------------


def _send(port: int, *datagrams: bytes) -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        for datagram in datagrams:
            sock.sendto(datagram, ("127.0.0.1", port))
        sent_from: int = sock.getsockname()[1]
        return sent_from


def _listening(start: Start, *arguments: object) -> tuple[Any, int]:
    program = start("listen", "--port", 0, "--address", "127.0.0.1", *arguments)
    return program, int(program.wait_for("listening on UDP port ").rpartition(" ")[2])


def test_each_payload_is_one_line_of_json(start: Start) -> None:
    """Number, name, sender and all fields, zeros included, as one JSON object a line; then it ends, as it was told."""
    program, port = _listening(start, "--count", len(REGISTRY.handlers))
    payloads = {h.route.name: payload_at(h.payload_type, 1.0) for h in REGISTRY.handlers}
    sent_from = _send(port, *(REGISTRY.envelope(**{n: p}).SerializeToString() for n, p in payloads.items()))
    assert program.end() == 0
    assert [json.loads(line) for line in program.output] == [
        {
            "from": f"127.0.0.1:{sent_from}",
            "number": handler.route.number,
            "name": handler.route.name,
            "payload": payload_to_values(payloads[handler.route.name]),
        }
        for handler in REGISTRY.handlers
    ]


def test_what_is_no_payload_is_a_line_as_well(start: Start) -> None:
    """Rubbish, an unknown payload and an empty datagram are told with their sizes; trailing zeros are understood."""
    program, port = _listening(start, "--count", 5)
    _send(port, b"\xff" * 5, bytes.fromhex("ca01"), b"", bytes.fromhex("6a"), bytes.fromhex("6a00") + bytes(9))
    assert program.end() == 0
    lines = [json.loads(line) for line in program.output]
    assert lines[0]["error"].startswith("not a valid PBEnvelope: 5 bytes")
    assert (lines[1]["error"], lines[1]["bytes"]) == ("unknown payload numbers [25]", 2)
    assert (lines[2]["error"], lines[2]["bytes"]) == ("empty", 0)
    assert [line["name"] for line in lines[3:]] == ["imu_info", "imu_info"]


def test_listening_ends_with_an_interrupt(start: Start) -> None:
    """Ctrl-C is how it is meant to end: exit code 0, and what came before is there."""
    program, port = _listening(start)
    _send(port, bytes.fromhex("6a00"))
    program.wait_for("imu_info", program.output)
    assert program.interrupt() == 0


@pytest.mark.parametrize("argument", ["--list", "imu_info"])
@pytest.mark.slow
def test_a_reader_that_has_had_enough_is_no_error(argument: str, environment: dict[str, str]) -> None:
    """`roverlink send --list | head -1` ends quietly, whoever closes first, and so does a command that says little."""
    command = [sys.executable, "-m", "roverlink", "send", argument]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment) as program:
        assert program.stdout is not None
        assert program.stderr is not None
        program.stdout.close()
        assert program.stderr.read() == b""
        assert program.wait(60) == 0


def test_what_is_sent_is_heard(start: Start) -> None:
    """The two commands fit together."""
    program, port = _listening(start, "--count", 2)
    sender = start("send", "drive_motor", "distance_to_go=1.5", "--to", f"127.0.0.1:{port}", "--count", 2, "--rate", 99)
    assert sender.end() == 0
    assert program.end() == 0
    payloads = [json.loads(line)["payload"] for line in program.output]
    assert payloads == [{"distance_to_go": 1.5, "turning_radius": 0.0}] * 2


def test_a_port_in_use_is_told(receiver: socket.socket, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2 and the port, where another program has it."""
    port = receiver.getsockname()[1]
    assert main(["listen", "--port", str(port), "--address", "127.0.0.1"]) == 2
    assert f"roverlink: UDP port {port} on 127.0.0.1 is in use by another program" in capsys.readouterr().err


@pytest.mark.parametrize("address", ["192.0.2.1", "no such host", "a" * 70 + ".x"])
def test_an_address_that_is_not_ours_is_told(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2 and the address, where it is none of this host's."""
    assert main(["listen", "--port", "0", "--address", address]) == 2
    assert f"roverlink: cannot listen on UDP port 0 of {address}: " in capsys.readouterr().err
