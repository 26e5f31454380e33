"""`roverlink explain`: everything about a row, for people and for scripts; and what a rule is about."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from google.protobuf import wrappers_pb2
from programs import Start
from running import Called

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.generator.example_payloads import payload_at
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


@pytest.mark.parametrize(
    "word",
    [
        "imu_info",
        *(
            pytest.param(w, marks=pytest.mark.slow)
            for w in ("13", "imu_data", "SensorBoardIMUInfo", "ImuSensorInformation")
        ),
    ],
)
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
def test_the_json_is_the_same_whatever_the_hash_seed(done: Start) -> None:
    """For scripts: one object, equal in every run, whose example is what the registry makes of it."""
    first, second = (done("explain", "imu_info", "--json", PYTHONHASHSEED=seed) for seed in ("1", "2"))
    assert first == second
    said = json.loads(first[1])
    assert said["size"] == {"payload": 51, "envelope": 53, "unbounded": None}
    assert [field["ros"] for field in said["fields"]][:2] == ["accel_x", "accel_y"]
    envelope = REGISTRY.envelope.FromString(bytes.fromhex(said["example"]["bytes"]))
    assert envelope.WhichOneof("payload") == "imu_info"
    assert all((_ROOT / path).is_file() for path in said["files"])
    handler = REGISTRY.by_name["imu_info"]
    assert said["ros"]["message"] == handler.message_type.__msgtype__
    assert said["ros"]["type_hash"] == handler.message_type.__typehash__


def test_the_history_of_the_number(called: Called) -> None:
    """With --history, the commits by which it came are told."""
    if not (_ROOT / ".git").exists():
        pytest.skip("need the history of this repository (git clone)")
    code, said, _ = called("explain", "imu_info", "--history")
    assert code == 0
    assert "history    SensorBoardIMUInfo imu_info, since " in said


def test_what_is_missing_is_told_beside_what_is_there(project: Path, called: Called) -> None:
    """A number that is retired says so; without generated code there is no example; a wrong table is told instead."""
    assert called("retire", "13", folder=project)[0] == 0
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
    """A rule is explained anywhere; a row, where there is none, is not."""
    assert called("explain", "ENV101", folder=tmp_path)[1].startswith("ENV101 field-number-taken (error)")
    code, _, errors = called("explain", "imu_info", folder=tmp_path)
    assert (code, "mapping.yaml does not exist" in errors) == (2, True)


def test_the_lines_are_all_of_the_bytes() -> None:
    """Put together, the bytes of all lines are the datagram."""
    for handler in REGISTRY.handlers:
        envelope = REGISTRY.envelope(**{handler.route.name: payload_at(handler.payload_type, 2.0)})
        data = envelope.SerializeToString()
        assert bytes.fromhex("".join(line.bytes for line in wire_lines(data, envelope.DESCRIPTOR))) == data


@pytest.mark.slow
def test_a_group_is_told_by_its_two_ends(project: Path, done: Start) -> None:
    """Fields of a group stand deeper, between a line where it begins and one where it ends; groups may be in groups."""
    (project / "proto/legacy.proto").write_text(
        'syntax = "proto2";\nmessage Legacy {\n  repeated group Leg = 1 {\n    required int32 x = 1;\n'
        "    optional group Foot = 2 { optional float z = 3; }\n  }\n}\n",
        encoding="utf-8",
    )
    table = project / "mapping.yaml"
    row = "  - {number: 40, name: legacy, proto: Legacy, topic: legacy, direction: hardware_to_ros}\n"
    text = table.read_text(encoding="utf-8")
    table.write_text(text.replace("messages:\n", f"messages:\n{row}", 1), encoding="utf-8")
    assert done("generate", folder=project)[0] == 0
    code, said, errors = done("explain", "legacy", "--json", folder=project)
    assert (code, errors) == (0, "")
    lines = json.loads(said)["example"]["lines"]
    first = [(line["depth"], line["meaning"].partition(":")[0]) for line in lines[:6]]
    assert first == [
        (0, "legacy = 40, Legacy of 33 bytes"),
        (1, "leg = 1, Leg as a group"),
        (2, "x = 1"),
        (2, "foot = 2, Foot as a group"),
        (3, "z = 3"),
        (2, "end of foot"),
    ]
    assert lines[6]["meaning"] == "end of leg"


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (wrappers_pb2.Int64Value(value=-1), "value = 1: -1"),
        (wrappers_pb2.Int64Value(value=5), "value = 1: 5"),
        (wrappers_pb2.UInt64Value(value=2**64 - 1), "value = 1: 18446744073709551615"),
        (wrappers_pb2.DoubleValue(value=0.1), "value = 1: 0.1"),
        (wrappers_pb2.FloatValue(value=0.1), "value = 1: 0.1"),
        (wrappers_pb2.StringValue(value="ü"), "value = 1: 'ü'"),
        (wrappers_pb2.BytesValue(value=b"ab"), "value = 1: 2 bytes"),
        (wrappers_pb2.BoolValue(value=True), "value = 1: true"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_values_as_people_read_them(message: Any, expected: str) -> None:
    """Each kind of value is told as a .proto file's author would write it."""
    (line,) = wire_lines(message.SerializeToString(), message.DESCRIPTOR)
    assert line.meaning == expected
