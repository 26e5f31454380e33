"""Taking over trees that were written without a table: the table that is drafted, and what is not.

After a change, `pytest tests/generator/test_adopt.py --update-cases` writes the golden file anew.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from trees import COLLIDING, FLAT, PACKAGES, PACKAGES_BEFORE, commit, plant

from roverlink.generator.adopt import Adoption, AdoptionRequest, adopt
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.emit.writer import compare, write
from roverlink.generator.lint.project import Question, lint_project
from roverlink.generator.pipeline import compile_table

_OWN = Path(__file__).parents[2]


def _flat(folder: Path) -> None:
    plant(folder / "protos", FLAT)


def _packages(folder: Path) -> None:
    plant(folder / "protos", PACKAGES_BEFORE)
    commit(folder, "First")
    plant(folder / "protos", PACKAGES)
    commit(folder, "Take it away")


_TREES: dict[str, Callable[[Path], object]] = {
    "flat": _flat,
    "packages": _packages,
    "colliding": lambda folder: plant(folder / "protos", COLLIDING),
    "own": lambda folder: shutil.copytree(_OWN / "proto", folder / "protos"),
}


def _adopted(folder: Path, **wanted: str) -> Adoption:
    return adopt(folder / "mapping.yaml", AdoptionRequest(folder / "protos", **wanted))


def _table(adoption: Adoption) -> str:
    return next(str(change.after) for change in adoption.changes if change.path == "mapping.yaml")


_DRAFTED = {
    "flat": [
        *("  file: messages.proto", "  message: Envelope", "  oneof: content"),
        "  owner: proto  # generate only checks the file, because its file declares more than the envelope",
        *("  ground_station: {port: 6000}  # guessed", "  hardware: {port: 6001}  # guessed", "messages:"),
        *("  - number: 1", "    name: joints", "    proto: ArmJoints", "    direction: hardware_to_ros"),
        *("  - number: 3", "    name: wheels", "    proto: Wheels", "    direction: ros_to_hardware"),
        *("  # from the ground station", "  - number: 4", "    name: note", "    direction: ground_station_to_ros"),
        "retired: []",
    ],
    "packages": [
        *("  root: protos", "  file: rover/v1/envelope.proto", "  message: rover.v1.Packet", "  oneof: payload"),
        "  owner: mapping  # generate writes the file from the rows, because it contains only the oneof",
        *("  ground_station: {port: 6000}  # guessed", "  hardware: {port: 6001}  # guessed", "messages:"),
        *("    proto: rover.v1.sensor_board.ImuReading", "    topic: imu", "    direction: hardware_to_ros"),
        *("    proto: rover.v1.ground_station.DriveCommand", "    direction: ground_station_to_ros"),
        *("# Numbers that were used before, by git's history.", "retired:"),
        "  - {number: 2, name: ph, proto: sensor_board.PhReading}  # until 2a702be2b1 2026-03-01 Take it away",
    ],
    "colliding": [
        *("# yaml-language-server: $schema=generated/mapping.schema.json", "version: 1", "  exclude:"),
        '    - legacy.proto  # "MotorStatus" is already defined in file "motor.proto".',
        '    - lost.proto  # Import "nowhere.proto" was not found or had errors.',
        "    - needs_legacy.proto  # imports legacy.proto, which is excluded",
        *('    - other_states.proto  # "IDLE" is already defined in file "motor.proto".', "  message: PBEnvelope"),
        "  owner: proto  # generate only checks the file, because it has members outside the oneof (sequence)",
        *(
            "ros:",
            "  package: comms",
            "  hardware: {port: 6000}  # guessed",
            "  - number: 2",
            "    topic: motor_status",
        ),
        *("    lint:", '      NAM101: {severity: hint, reason: "found when the tree was taken over"}', "  - number: 3"),
        "    direction: hardware_to_ros  # guessed: neither name nor comment tells who sends it",
    ],
    "own": [
        "  owner: mapping  # generate writes the file from the rows, because it contains only the oneof",
        "  basestation: {prefixes: [Basestation], port: 6000}  # guessed",
        "  hardware: {prefixes: [ArmBoard, DrivingBoard, SensorBoard], port: 6001}  # guessed",
        "    name: arm_obstructions",
        "    direction: hardware_to_ros  # guessed: neither name nor comment tells who sends it",
        *("    name: rover_localization", "    direction: ros_to_basestation", "retired: []"),
    ],
}


@pytest.mark.slow
@pytest.mark.parametrize("name", _DRAFTED)
def test_the_lines_of_a_draft(name: str, tmp_path: Path) -> None:
    """What is left out and why, envelope, peers, rows and retired numbers are in the table; nothing is written yet."""
    _TREES[name](tmp_path)
    before = sorted(tmp_path.rglob("*"))
    adoption = _adopted(tmp_path)
    assert sorted(tmp_path.rglob("*")) == before
    remaining = iter(_table(adoption).splitlines())
    assert [line for line in _DRAFTED[name] if line not in remaining] == []  # `in` reads on from the line before
    if name == "own":
        own = compile_table(_OWN / "mapping.yaml").bridge.routes
        assert [(row.number, row.name, row.proto, row.direction) for row in adoption.draft.rows] == [
            (route.number, route.name, route.conversion.proto, route.direction) for route in own
        ]


@pytest.mark.slow
@pytest.mark.parametrize("name", _TREES)
def test_generate_and_lint_have_nothing_to_say(name: str, tmp_path: Path) -> None:
    """Right after it was taken over, a tree generates without drift, and the lint finds hints at most."""
    _TREES[name](tmp_path)
    write(tmp_path, _adopted(tmp_path).changes)
    compiled = compile_table(tmp_path / "mapping.yaml")
    assert compare(tmp_path, compiled.files, compiled.folders) == []
    found = lint_project(tmp_path / "mapping.yaml", Question()).findings
    assert {finding.severity.value for finding in found} <= {"hint"}


_BROKEN = FLAT | {"messages.proto": FLAT["messages.proto"].replace("sint32", "sint33")}


def _no_oneof(folder: Path) -> None:
    plant(folder / "protos", {"a.proto": 'syntax = "proto3";\nmessage A { int32 x = 1; }\n'})


def _import(path: str, at: str) -> Callable[[Path], None]:
    """Return a function that writes the flat tree with an import of ``path``, whose file is at ``at``."""
    text = FLAT["messages.proto"].replace(";\n", f';\nimport "{path}";\n', 1)
    files = {**FLAT, "messages.proto": text}

    def prepare(folder: Path) -> None:
        plant(folder / "protos", files)
        plant(folder, {at: 'syntax = "proto3";\n'} if at else {})
        commit(folder, "First")

    return prepare


def _file_in_the_way(folder: Path) -> None:
    _flat(folder)
    plant(folder, {"docs/messages.md": "Written by hand.\n"})


@pytest.mark.parametrize(
    ("prepare", "wanted", "expected"),
    [
        (lambda folder: (folder / "protos").mkdir(), {}, "protos: fatal[ADO101] the folder contains no .proto file"),
        (_flat, {"file": "x.proto"}, "protos: fatal[ADO102] the folder contains no file 'x.proto'"),
        (_flat, {"message": "Missing"}, "no message 'Missing' is declared"),
        (_flat, {"message": "Wheels"}, "'Wheels' has no oneof that contains messages"),
        (_flat, {"oneof": "missing"}, "'Envelope' has no oneof 'missing' that contains messages"),
        (_no_oneof, {}, "no message with a oneof is declared\n  help: the envelope is a message with a oneof of all"),
        (lambda folder: plant(folder / "protos", _BROKEN), {}, '"sint33" is not defined'),
        (_import("go/go.proto", "lib/go/go.proto"), {}, "help: it is in 'lib', .* `ln -s ../lib/go protos/go`"),
        (_import("protos/a.proto", "protos/a.proto"), {}, r"help: its path starts at '\.': run `.*--from \.`"),
        (_import("x.org/me/lib/a.proto", "lib/a.proto"), {}, "submodule add REPOSITORY proto/x.org/me` and"),
        (_import("go/go.proto", ""), {}, "help: no file of this repository .*copy it to protos/go/go.proto, or"),
        (_flat, {"package": "No_Package"}, "No_Package"),
        (_file_in_the_way, {}, "docs/messages.md: fatal[ADO103] the file exists and was not generated"),
    ],
)
def test_what_cannot_be_taken_over_is_told(
    prepare: Callable[[Path], None], wanted: dict[str, str], expected: str, tmp_path: Path
) -> None:
    """Where no table can help, the findings say what is in the way."""
    prepare(tmp_path)
    with pytest.raises(DiagnosticsError) as caught:
        _adopted(tmp_path, **wanted)
    assert expected in str(caught.value) or re.search(expected, str(caught.value))


def test_what_a_tree_without_an_envelope_is_told_to_write_is_one(tmp_path: Path) -> None:
    """The text in the help, put where it says, is taken over."""
    _no_oneof(tmp_path)
    with pytest.raises(DiagnosticsError) as caught:
        _adopted(tmp_path)
    _, file, text, _ = re.split(r" write into |:\n|\n  and run", caught.value.findings[0].help)
    plant(tmp_path, {file: text})
    assert [(row.number, row.name, row.proto) for row in _adopted(tmp_path).draft.rows] == [(1, "a", "A")]


_NESTED = """
syntax = "proto3";
message Imu { float x = 1; }
message Gps { float x = 1; }
message Body { oneof payload { Imu imu = 1; Gps gps = 2; Other other = 3; } }
message Other { float x = 1; }
message Batch { map<string, Body> bodies = 1; }
message Match { oneof match { Match not = 1; Frame a = 2; Imu b = 3; Gps c = 4; } }
message Frame { oneof kind { Batch batch = 1; Imu ping = 2; } oneof trailer { Gps place = 3; } }
"""


@pytest.mark.slow
def test_the_outermost_message_is_the_envelope(tmp_path: Path) -> None:
    """Also where a larger oneof is inside a payload of it; the table names what else it could be."""
    plant(tmp_path / "protos", {"frame.proto": _NESTED})
    adoption = _adopted(tmp_path)
    assert "  message: Frame  # guessed: it could be Body or Match; the oneof could be trailer\n" in _table(adoption)
    assert (
        "guessed"
        not in _table(_adopted(tmp_path, message="Frame", oneof="kind")).partition("ros:")[0].partition("root:")[2]
    )


_AWKWARD = {
    "a/status.proto": 'syntax = "proto3";\npackage a;\nmessage Status { Part p = 1; }\nmessage Part { int32 x = 1; }\n',
    "b/status.proto": 'syntax = "proto3";\npackage b;\nmessage Status { int32 On = 1; int32 on_ = 2; }\n',
    "c.proto": 'syntax = "proto3";\nmessage motor_state { Node tree = 1; }\nmessage Node { Node next = 1; }  // \x1b\n',
    "envelope.proto": """
syntax = "proto3";
import "a/status.proto";
import "b/status.proto";
import "c.proto";
message E {
  oneof payload {
    a.Status off = 1;  // \x1b[2J
    b.Status status = 2;
    motor_state motor = 3;
    a.Status again = 4;
  }
}
""",
    "rtl\u202e\x1b.proto": "message",
}


def test_names_that_ros_refuses_are_replaced(tmp_path: Path) -> None:
    """Two messages of one name, names that ROS forbids, words that YAML reads otherwise, recursion: all of it fits."""
    plant(tmp_path / "protos", _AWKWARD)
    adoption = _adopted(tmp_path)
    rows = {row.name: row for row in adoption.draft.rows}
    routes = {route.name: route for route in adoption.compiled.bridge.routes}
    assert routes.keys() == {"off", "status", "motor", "again"}
    assert routes["motor"].conversion.ros == "MotorState"
    assert {rows["off"].ros, rows["status"].ros} & {"AStatus", "BStatus"}
    assert rows["off"].ros == rows["again"].ros
    assert all(text in _table(adoption) for text in ('name: "off"', "# \\x1b[2J\n", '- "rtl\\u202e\\x1b.proto"\n'))
    assert not any("\x1b" in text for text in adoption.compiled.files.values())


_FAULTY = {
    "envelope.proto": """
syntax = "proto3";
message Ring { Pair pair = 1; int32 size = 2; }
message Pair { Ring ring = 1; bool on = 2; bool On = 3; }
message Holder { Part part = 1; Part none = 2; int32 kept = 3; }
message Part { Deep deep = 1; }
message Deep { Deep again = 1; }
message E { oneof payload { Ring ring = 1; Pair pair = 2; Holder holder = 3; } }
"""
}


def test_a_fault_is_put_down_to_the_fields_that_have_it(tmp_path: Path) -> None:
    """A payload's own field is renamed or left out in its row alone; for a message inside, the fields that hold it."""
    plant(tmp_path / "protos", _FAULTY)
    rows = {row.name: row for row in _adopted(tmp_path).draft.rows}
    assert {name: (list(row.ignore), row.fields) for name, row in rows.items()} == {
        "ring": ([], {}),
        "pair": (["ring"], {"On": "on_field"}),
        "holder": (["part", "none"], {}),
    }
