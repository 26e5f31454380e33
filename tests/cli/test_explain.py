"""`roverlink explain`: everything about a row, for people and for scripts; and what a rule is about."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from case_file import usual_table
from google.protobuf import wrappers_pb2
from running import Called

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime.native.core import LIBRARY
from roverlink.wire_dump import wire_lines

_ROOT = Path(__file__).parents[2]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the project, which is no repository."""
    for name in ("mapping.yaml", "mapping.lock"):
        shutil.copy(_ROOT / name, tmp_path)
    for name in ("proto", "generated"):
        shutil.copytree(_ROOT / name, tmp_path / name)
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("word", ["13", "imu_data", "ImuSensorInformation"])
def test_a_row_is_found_by_whatever_it_is_called(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Name, number, topic, proto and ROS message all lead to the row, told with sizes, fields and bytes."""
    assert main(["explain", word]) == 0
    said, errors = capsys.readouterr()
    assert errors == ""
    assert "row        imu_info, number 13 in PBEnvelope" in said
    assert "size       at most 51 bytes, 53 in the envelope" in said
    assert "float accel_x = 1" in said
    assert "6a 31             imu_info = 13, SensorBoardIMUInfo of 49 bytes" in said
    assert "    68 01           is_calibrated = 13: true" in said


@pytest.mark.slow
def test_the_json_is_one_object(called: Called) -> None:
    """For scripts: its example is what the registry makes of it."""
    said = json.loads(called("explain", "imu_info", "--json")[1])
    assert said["size"] == {"payload": 51, "envelope": 53, "unbounded": None, "accepted": 1472}
    assert {one["topic"]: bool(one["in_python"]) for one in said["translation"]} == dict.fromkeys(
        ("imu_data", "imu/data_raw", "imu/mag"), not LIBRARY.is_file()
    )
    assert [field["ros"] for field in said["fields"]][:2] == ["accel_x", "accel_y"]
    envelope = REGISTRY.envelope.FromString(bytes.fromhex(said["example"]["bytes"]))
    assert envelope.WhichOneof("payload") == "imu_info"
    assert all((_ROOT / path).is_file() for path in said["files"])
    handler = REGISTRY.by_name["imu_info"]
    assert said["ros"]["message"] == handler.message_type.__msgtype__
    assert said["ros"]["type_hash"] == handler.message_type.__typehash__


@pytest.mark.slow
def test_the_history_of_the_number(called: Called) -> None:
    """With --history, the commits by which it came are told."""
    if not (_ROOT / ".git").exists():
        pytest.skip("need the history of this repository (git clone)")
    code, said, _ = called("explain", "imu_info", "--history")
    assert code == 0
    assert "history    SensorBoardIMUInfo imu_info, since " in said


@pytest.mark.slow
def test_the_limits_of_a_row_are_told(tmp_path: Path, called: Called) -> None:
    """Sizes, rates and silence; what a board sends is limited by the bridge, too."""
    row = "  - {number: %d, name: %s, proto: Note, topic: %s, direction: %s, %s}\n"
    rows = row % (1, "up", "up", "board_to_ros", "max_rate: 5, expect_rate: 2")
    rows += row % (2, "down", "down", "ros_to_board", "deadman: {after: 300ms, repeat: 1s, send: {x: 7}}")
    table = usual_table(f'peers: {{board: {{host: "serial:/dev/ttyACM0"}}}}\nmessages:\n{rows}')
    (tmp_path / "proto").mkdir()
    (tmp_path / "proto/note.proto").write_text('syntax = "proto3";\nmessage Note { uint32 x = 1; }\n')
    (tmp_path / "mapping.yaml").write_text(table)
    limits = {
        "up": [
            "the bridge accepts at most 1472 (parameter max_datagram)",
            "to 5 messages a second",
            "at least 2 messages",
        ],
        "down": ["as nanopb does; its line carries at most 4096", "after 300 ms of silence, every 1000 ms: x: 7"],
    }
    for name, wanted in limits.items():
        said = called("explain", name, "--table", tmp_path / "mapping.yaml")[1]
        assert not [one for one in wanted if one not in said]


@pytest.mark.slow
def test_what_is_missing_is_told_beside_what_is_there(project: Path, called: Called) -> None:
    """A number that is retired says so; without generated code there is no example; a wrong table is told instead."""
    assert called("number", "retire", "imu_info", folder=project)[0] == 0
    said = "13 is retired: it was 'imu_info' (SensorBoardIMUInfo)"
    assert called("explain", "13", folder=project) == (1, said, "")
    shutil.rmtree(project / "generated")
    code, said, _ = called("explain", "gps_info", folder=project)
    assert code == 0
    assert "example: no generated code in" in said
    table = project / "mapping.yaml"
    table.write_text(table.read_text().replace("proto: SensorBoardPHInfo", "proto: Missing"))
    code, _, errors = called("explain", "gps_info", folder=project)
    assert (code, "error[PRO103]" in errors) == (1, True)


def test_rules_need_no_table(tmp_path: Path, called: Called) -> None:
    """A rule and a key are explained anywhere; a row, where there is none, is not."""
    assert "\nmessages[].max_rate: 1 to 1000000 (" in called("explain", "max_rate", folder=tmp_path)[1]
    assert "`1 kB/s` to `1000 MB/s` (" in called("explain", "budget", folder=tmp_path)[1]
    assert called("explain", "ENV101", folder=tmp_path)[1].startswith("ENV101 field-number-taken (error)")
    code, _, errors = called("explain", "imu_info", folder=tmp_path)
    assert (code, "mapping.yaml does not exist" in errors) == (2, True)


def test_values_as_people_read_them() -> None:
    """Each kind of value is told as a .proto file's author would write it."""
    for message, expected in (
        (wrappers_pb2.Int64Value(value=-1), "-1"),
        (wrappers_pb2.Int64Value(value=5), "5"),
        (wrappers_pb2.UInt64Value(value=2**64 - 1), "18446744073709551615"),
        (wrappers_pb2.DoubleValue(value=0.1), "0.1"),
        (wrappers_pb2.FloatValue(value=0.1), "0.1"),
        (wrappers_pb2.StringValue(value="ü"), "'ü'"),
        (wrappers_pb2.BytesValue(value=b"ab"), "2 bytes"),
        (wrappers_pb2.BoolValue(value=True), "true"),
    ):
        (line,) = wire_lines(message.SerializeToString(), message.DESCRIPTOR)
        assert line.meaning == f"value = 1: {expected}"
