"""Section `conversion`: the cost of converting a payload to a serialized ROS 2 message, by kind of field.

A table with one message of sixteen fields of each kind is compiled, and its handlers are timed on existing payloads.
Each kind is compared with a row of sixteen floats; a standard message is compared with a message of the table with as
many fields.
"""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.contestants import ROOT
from bench.errors import BenchError
from bench.lab import Lab
from bench.result import Group, SectionResult, Table

COUNT = 16
ROUNDS, QUICK_ROUNDS = 60, 15
LIMIT = 2.0
"""Highest cost of a standard message, as a multiple of our own message with as many fields."""


@dataclass(frozen=True, slots=True)
class Cost:
    """Microseconds for one message, and for one of sixteen floats."""

    kind: str
    whole: float
    base: float


def measure(lab: Lab) -> SectionResult:
    """Time every kind of field."""
    project = _project(lab.site.out / "conversion")
    found = _timed(project, QUICK_ROUNDS if lab.quick else ROUNDS)
    base = found["kind_0"]
    kinds = [Cost(kind, found[f"kind_{index}"], base) for index, kind in enumerate(_KINDS)]
    standard = [Cost(name, found[topic], found[own]) for name, topic, own in _STANDARD]
    for cost in standard:
        lab.say(f"conversion {cost.kind}: {cost.whole:.2f} us, {cost.whole / cost.base:.2f} times our own message")
    tables = [
        Table(
            "Payload to CDR, by kind of field",
            (f"{COUNT} fields", "us per message", "ns per field", "vs floats"),
            [Group("", [_row(cost, COUNT) for cost in kinds])],
        ),
        Table(
            "Standard messages",
            ("", "us per message", "us of our own", "ratio"),
            [Group("", [_beside(cost) for cost in standard])],
            [f"Compared with a message of the table with as many fields; the limit is {LIMIT:g}."],
        ),
    ]
    return SectionResult(tables, data={"kinds": [*map(asdict, kinds)], "standard": [*map(asdict, standard)]})


def _row(cost: Cost, count: int) -> Sequence[str]:
    per_field = 1000 * cost.whole / count
    return (cost.kind, f"{cost.whole:.2f}", f"{per_field:.0f}", f"{cost.whole / cost.base:.2f}")


def _beside(cost: Cost) -> Sequence[str]:
    return (cost.kind, f"{cost.whole:.2f}", f"{cost.base:.2f}", f"{cost.whole / cost.base:.2f}")


def _timed(project: Path, rounds: int) -> dict[str, float]:
    command = (sys.executable, "-m", "bench.conversion_calls", str(project), str(rounds))
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(  # noqa: S603  # our own program
        command, capture_output=True, text=True, check=False, env=environment
    )
    if done.returncode:
        raise BenchError(f"the conversions of {project} failed:\n{done.stderr}")
    found: dict[str, float] = json.loads(done.stdout)
    return found


# --- the tables -------------------------------------------------------------------------------------------------

_KINDS = {
    "float": "float f_{k} = {k};",
    "double": "double f_{k} = {k};",
    "int32": "int32 f_{k} = {k};",
    "bool": "bool f_{k} = {k};",
    "enum": "Mode f_{k} = {k};",
    "optional float": "optional float f_{k} = {k};",
    "nested message of two floats": "Pair f_{k} = {k};",
    "string": "string f_{k} = {k};",
    "repeated float": "repeated float f_{k} = {k};",
}
_VECTOR = "{{x: f_{0}, y: f_{1}, z: f_{2}{3}}}"


def _accel(unit: str, turned: str) -> str:
    linear = _VECTOR.format(1, 2, 3, f", unit: {unit}")
    return f"{{linear: {linear}, angular: {_VECTOR.format(4, 5, 6, f', unit: {turned}')}}}"


_EXTRA_TOPICS = {
    "accel": ("geometry_msgs/Accel", _accel("m/s^2", "rad/s^2")),
    "accel_units": ("geometry_msgs/Accel", _accel("g0", "deg/s^2")),
    "accel_stamped": (
        "geometry_msgs/AccelStamped, frame_id: base",
        "{accel: " + _accel("m/s^2", "rad/s^2") + "}",
    ),
    "imu": (
        "sensor_msgs/Imu, frame_id: base",
        "{linear_acceleration: " + _VECTOR.format(1, 2, 3, ", unit: m/s^2") + ", angular_velocity: "
        f"{_VECTOR.format(4, 5, 6, ', unit: deg/s')}, orientation_covariance: [-1, 0, 0, 0, 0, 0, 0, 0, 0]}}",
    ),
    "imu_stamped": (
        "sensor_msgs/Imu, frame_id: base, stamp: {from: t_7, unit: ms}",
        "{linear_acceleration: " + _VECTOR.format(1, 2, 3, ", unit: m/s^2") + ", angular_velocity: "
        f"{_VECTOR.format(4, 5, 6, ', unit: deg/s')}, orientation_covariance: [-1, 0, 0, 0, 0, 0, 0, 0, 0]}}",
    ),
    "quaternion": (
        "geometry_msgs/Quaternion",
        "{x: {from: f_1}, y: {from: f_2}, z: {from: f_3}, w: {from: f_4}}",
    ),
    "orientation": (
        "geometry_msgs/Pose",
        "{position: " + _VECTOR.format(1, 2, 3, ", unit: m") + ", "
        "orientation: {euler: {roll: f_4, pitch: f_5, yaw: f_6, unit: deg}}}",
    ),
    "status": (
        "sensor_msgs/NavSatStatus",
        "{status: {from: e_8, enum: {OFF: STATUS_NO_FIX, ON: STATUS_FIX}}, service: {value: SERVICE_GPS}}",
    ),
}
_STANDARD = (
    ("Accel: six numbers unchanged", "accel", "six"),
    ("Accel: six numbers in other units", "accel_units", "six"),
    ("AccelStamped: with a header", "accel_stamped", "six"),
    ("Imu: header, six numbers, 31 constants", "imu", "six"),
    ("Imu: stamp from a field", "imu_stamped", "six"),
    ("Imu vs a row of 37 doubles", "imu", "thirty_seven"),
    ("Quaternion: four numbers unchanged", "quaternion", "six"),
    ("Pose: a quaternion from angles", "orientation", "seven"),
    ("NavSatStatus: an enum by its table", "status", "one_enum"),
)


def _project(project: Path) -> Path:
    shutil.rmtree(project, ignore_errors=True)
    (project / "proto").mkdir(parents=True)
    messages = [f"message Kind{index} {{ {_fields(field)} }}" for index, field in enumerate(_KINDS.values())]
    six = "float f_1 = 1; float f_2 = 2; float f_3 = 3; float f_4 = 4; float f_5 = 5; float f_6 = 6;"
    doubles = " ".join(f"double f_{k} = {k};" for k in range(1, 38))
    messages += [
        "enum Mode { OFF = 0; ON = 1; }",
        "message Pair { float a = 1; float b = 2; }",
        f"message Six {{ {six} }}",
        f"message Seven {{ {six} float f_7 = 7; }}",
        f"message More {{ {six} int64 t_7 = 7; Mode e_8 = 8; }}",
        f"message ThirtySeven {{ {doubles} }}",
        "message OneEnum { Mode e_8 = 8; }",
    ]
    text = "\n".join(['syntax = "proto3";', *messages, ""])
    (project / "proto" / "kinds.proto").write_text(text, encoding="utf-8")
    own = [(f"kind_{index}", f"Kind{index}") for index in range(len(_KINDS))]
    own += [
        ("six", "Six"),
        ("seven", "Seven"),
        ("thirty_seven", "ThirtySeven"),
        ("one_enum", "OneEnum"),
        ("more", "More"),
    ]
    rows = [
        f"  - {{number: {number}, name: {name}, proto: {proto}, topic: {name}, direction: board_to_ros"
        + (f", also: [{_also()}]}}" if name == "more" else "}")
        for number, (name, proto) in enumerate(own, 1)
    ]
    head = (
        "version: 1",
        "proto: {root: proto}",
        "envelope: {file: envelope.proto, message: Envelope, oneof: payload}",
        "ros: {package: kinds}",
        "peers: {board: {}}",
        "messages:",
    )
    (project / "mapping.yaml").write_text("\n".join([*head, *rows, ""]), encoding="utf-8")
    command = (sys.executable, "-m", "roverlink", "generate", "--table", str(project / "mapping.yaml"))
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603  # our own program
    if done.returncode:
        raise BenchError(f"roverlink generate failed in {project}:\n{done.stderr}")
    return project


def _fields(field: str) -> str:
    return " ".join(field.format(k=k) for k in range(1, COUNT + 1))


def _also() -> str:
    return ", ".join(
        f"{{topic: {topic}, ros: {ros}, fields: {fields}}}" for topic, (ros, fields) in _EXTRA_TOPICS.items()
    )
