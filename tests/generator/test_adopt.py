"""Taking over trees that were written without a table: the table that is drafted, in golden files, and what is not.

After a change, `pytest tests/generator/test_adopt.py --update-cases` writes the golden files anew.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from trees import COLLIDING, FLAT, PACKAGES, PACKAGES_BEFORE, commit, plant

from roverlink.generator.adopt import Adoption, AdoptionRequest, adopt
from roverlink.generator.adopt.role_words import words
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.emit.writer import compare, write
from roverlink.generator.lint.project import Question, lint_project
from roverlink.generator.pipeline import compile_table

_GOLDEN = Path(__file__).parent / "adopted"


def _flat(folder: Path) -> None:
    plant(folder / "protos", FLAT)


def _packages(folder: Path) -> None:
    plant(folder / "protos", PACKAGES_BEFORE)
    commit(folder, "First")
    plant(folder / "protos", PACKAGES)
    commit(folder, "Take the pH sensor away")


def _colliding(folder: Path) -> None:
    plant(folder / "protos", COLLIDING)


def _own(folder: Path) -> None:
    protos = Path(__file__).parents[2] / "proto"
    texts = {path.relative_to(protos).as_posix(): path.read_text() for path in sorted(protos.rglob("*.proto"))}
    plant(folder / "protos", texts)


_TREES = {"flat": _flat, "packages": _packages, "colliding": _colliding, "own": _own}


def _adopted(folder: Path, **wanted: str) -> Adoption:
    return adopt(folder / "mapping.yaml", AdoptionRequest(folder / "protos", **wanted))


def _table(adoption: Adoption) -> str:
    return next(str(change.after) for change in adoption.changes if change.path == "mapping.yaml")


@pytest.mark.parametrize("name", _TREES)
def test_the_table_that_is_drafted(name: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """Rows, peers, directions, what is left out and what is retired, with the reasons, are those of the golden file."""
    _TREES[name](tmp_path)
    text = _table(_adopted(tmp_path))
    golden = _GOLDEN / f"{name}.yaml"
    if request.config.getoption("--update-cases"):
        golden.parent.mkdir(exist_ok=True)
        golden.write_text(text, encoding="utf-8")
    assert text == golden.read_text(encoding="utf-8")
    assert text == _table(_adopted(tmp_path))  # and once more the same


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


def test_the_directions_of_this_project_are_guessed_as_they_are(tmp_path: Path) -> None:
    """From names, folders and comments alone, every direction of this project's own table comes out."""
    _own(tmp_path)
    own = compile_table(Path(__file__).parents[2] / "mapping.yaml").bridge
    drafted = {row.number: row.direction for row in _adopted(tmp_path).draft.rows}
    assert drafted == {route.number: route.direction for route in own.routes}


def test_nothing_is_written(tmp_path: Path) -> None:
    """Drafting leaves the folder as it is, whatever it tries out."""
    _colliding(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    _adopted(tmp_path)
    assert sorted(tmp_path.rglob("*")) == before


def _no_protos(folder: Path) -> None:
    (folder / "protos").mkdir()


def _broken_envelope(folder: Path) -> None:
    plant(folder / "protos", {**FLAT, "messages.proto": FLAT["messages.proto"].replace("sint32", "sint33")})


def _no_oneof(folder: Path) -> None:
    plant(folder / "protos", {"a.proto": 'syntax = "proto3";\nmessage A { int32 x = 1; }\n'})


def _file_in_the_way(folder: Path) -> None:
    _flat(folder)
    plant(folder, {"docs/messages.md": "Written by hand.\n"})


@pytest.mark.parametrize(
    ("prepare", "wanted", "expected"),
    [
        (_no_protos, {}, "protos: fatal[ADO101] the folder contains no .proto file"),
        (_flat, {"file": "x.proto"}, "protos: fatal[ADO102] the folder contains no file 'x.proto'"),
        (_flat, {"message": "Missing"}, "no message 'Missing' is declared"),
        (_flat, {"message": "Wheels"}, "'Wheels' has no oneof that contains messages"),
        (_flat, {"oneof": "missing"}, "'Envelope' has no oneof 'missing' that contains messages"),
        (_no_oneof, {}, "no message with a oneof is declared"),
        (_broken_envelope, {}, '"sint33" is not defined'),
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
    assert expected in str(caught.value)


_AWKWARD = {
    "a/status.proto": 'syntax = "proto3";\npackage a;\nmessage Status { Part p = 1; }\nmessage Part { int32 x = 1; }\n',
    "b/status.proto": 'syntax = "proto3";\npackage b;\nmessage Status { int32 On = 1; int32 on_ = 2; }\n',
    "c.proto": 'syntax = "proto3";\nmessage motor_state { Node tree = 1; }\nmessage Node { Node next = 1; }\n',
    "envelope.proto": """
syntax = "proto3";
import "a/status.proto";
import "b/status.proto";
import "c.proto";
message E {
  oneof payload {
    a.Status off = 1;
    b.Status status = 2;
    motor_state motor = 3;
    a.Status again = 4;
  }
}
""",
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
    assert 'name: "off"' in _table(adoption)


_FAULTY = {"envelope.proto": """
syntax = "proto3";
message Ring { Pair pair = 1; int32 size = 2; }
message Pair { Ring ring = 1; bool on = 2; bool On = 3; }
message Holder { Part part = 1; Part none = 2; int32 kept = 3; }
message Part { Deep deep = 1; }
message Deep { Deep again = 1; }
message E { oneof payload { Ring ring = 1; Pair pair = 2; Holder holder = 3; } }
"""}


def test_a_fault_is_put_down_to_the_fields_that_have_it(tmp_path: Path) -> None:
    """A payload's own field is renamed or left out in its row alone; for a message inside, the fields that hold it."""
    plant(tmp_path / "protos", _FAULTY)
    rows = {row.name: row for row in _adopted(tmp_path).draft.rows}
    assert {name: (list(row.ignore), row.fields) for name, row in rows.items()} == {
        "ring": ([], {}),
        "pair": (["ring"], {"On": "on_field"}),
        "holder": (["part", "none"], {}),
    }


def test_a_tree_that_is_a_repository_of_its_own_is_only_checked(tmp_path: Path) -> None:
    """Nothing is written into a folder that belongs to another repository."""
    for files in (PACKAGES_BEFORE, PACKAGES):
        plant(tmp_path / "protos", files)
        commit(tmp_path / "protos", "A state")
    adoption = _adopted(tmp_path)
    assert adoption.draft.owner == "proto"
    assert [row.number for row in adoption.draft.retired] == [2]
    assert not [change.path for change in adoption.changes if change.path.startswith("protos/")]


def test_words() -> None:
    """A name falls apart where a reader sees words."""
    assert words("SensorBoardPHInfo") == ["sensor", "board", "ph", "info"]
    assert words("gps_fix2") == ["gps", "fix", "2"]
