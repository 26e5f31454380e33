"""`roverlink add`: one more row, behind the last and written as that one is; the rest of the file is as it was."""

from __future__ import annotations

from pathlib import Path

import pytest
from golden import inside, snapshot

from roverlink.__main__ import main
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.table import reader
from roverlink.generator.table.edit import with_row

_HEAD = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload}
ros: {package: rover}
peers: {board: {}}
"""
_ROW = {"number": 2, "name": "off", "proto": "B", "topic": "b", "direction": "board_to_ros"}
_BLOCK = """\
messages:
  # the first
  - number: 1
    name: a
    proto: A
    topic: a
    direction: board_to_ros  # and nobody else
    forward:
      - board
# what is gone
retired: []
"""
_FLOW = """\
messages:
- {number: 1, name: a, proto: A, topic: a, direction: board_to_ros}  # short
"""


@pytest.mark.parametrize(
    ("rows", "before", "added"),
    [
        (
            _BLOCK,
            "# what is gone\n",
            '  - number: 2\n    name: "off"\n    proto: B\n    topic: b\n    direction: board_to_ros\n',
        ),
        (_FLOW, "", '- {number: 2, name: "off", proto: B, topic: b, direction: board_to_ros}\n'),
    ],
)
def test_a_row_comes_behind_the_last_in_its_style(rows: str, before: str, added: str) -> None:
    """The text differs by the row alone, and reads back as it was meant."""
    text = with_row(_HEAD + rows, _ROW, "mapping.yaml")
    first, found, rest = (_HEAD + rows).partition(before) if before else (_HEAD + rows, "", "")
    assert text == first + added + found + rest
    findings: list[object] = []
    assert [row.name for row in reader.parse(text, "mapping.yaml", findings).rows] == ["a", "off"]  # type: ignore[arg-type]
    assert findings == []


def test_a_last_line_without_an_end_gets_one() -> None:
    """A file that ends within its last row is not glued to the new one."""
    assert with_row((_HEAD + _FLOW).rstrip("\n"), _ROW, "mapping.yaml") == with_row(_HEAD + _FLOW, _ROW, "mapping.yaml")


@pytest.mark.parametrize("rows", ["", "messages: []\n", "messages: [{number: 1, name: a}]\n", "messages:\n  - 7\n"])
def test_rows_that_are_not_one_below_the_other(rows: str) -> None:
    """Where no row stands that the new one could be written like, that is a finding."""
    with pytest.raises(DiagnosticsError, match="RET103"):
        with_row(_HEAD + rows, _ROW, "mapping.yaml")


# --- the command ------------------------------------------------------------------------------------------------


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project with two payloads, one of which has a row."""
    (tmp_path / "mapping.yaml").write_text(_HEAD + _BLOCK.replace("    forward:\n      - board\n", ""))
    (tmp_path / "proto").mkdir()
    for name in ("a", "b"):
        text = f'syntax = "proto3";\nmessage {name.upper()} {{ int32 x = 1; }}\n'
        (tmp_path / "proto" / f"{name}.proto").write_text(text)
    with inside(tmp_path):
        assert main(["generate"]) == 0
    return tmp_path


def test_a_row_is_added_and_generated(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The number is the next one, the topic the name unless it is given, and everything is generated."""
    with inside(project):
        assert main(["add", "b", "--proto", "B", "--direction", "ros_to_board"]) == 0
        assert "b has the number 2" in capsys.readouterr().err
        assert main(["add", "again", "--proto", "B", "--direction", "board_to_ros", "--topic", "t", "--ros", "B"]) == 0
        assert main(["generate", "--check"]) == 0
    rows = reader.read(project / "mapping.yaml", []).rows
    assert [(row.number, row.name, row.topic) for row in rows] == [(1, "a", "a"), (2, "b", "b"), (3, "again", "t")]
    assert (project / "generated" / "handlers" / "again.py").is_file()


def test_a_retired_number_is_not_given_again(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is taken is skipped, and said."""
    with inside(project):
        main(["add", "b", "--proto", "B", "--direction", "ros_to_board"])
        main(["retire", "2"])
        capsys.readouterr()
        assert main(["add", "c", "--proto", "B", "--direction", "ros_to_board"]) == 0
    assert "c has the number 3" in capsys.readouterr().err


def test_a_dry_run_shows_the_diff(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With --dry-run, the changes are printed and none is made."""
    before = snapshot(project)
    with inside(project):
        assert main(["add", "b", "--proto", "B", "--direction", "ros_to_board", "--dry-run"]) == 0
    said = capsys.readouterr()
    assert "+  - number: 2\n" in said.out
    assert "+++ b/proto/envelope.proto" in said.out
    assert "b would have the number 2" in said.err
    assert snapshot(project) == before


@pytest.mark.parametrize(
    ("name", "proto", "direction", "expected"),
    [
        ("a", "B", "board_to_ros", "TAB101"),
        ("b c", "B", "board_to_ros", "MAP108"),
        ("b", "Missing", "board_to_ros", "PRO103"),
        ("b", "B", "bord_to_ros", "TAB103"),
        ("b", "B", "sideways", "TAB103"),
    ],
)
def test_what_cannot_be_added_leaves_everything(
    name: str, proto: str, direction: str, expected: str, project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A name that is taken, a message or a peer that is not there: findings, exit code 1, and no change."""
    before = snapshot(project)
    with inside(project):
        assert main(["add", name, "--proto", proto, "--direction", direction]) == 1
    assert f"error[{expected}]" in capsys.readouterr().err
    assert snapshot(project) == before


def test_in_an_envelope_of_another_the_number_is_the_member_s(project: Path) -> None:
    """Where the envelope has the member already, its number stands there; where it does not, nothing is added."""
    table, envelope = project / "mapping.yaml", project / "proto" / "envelope.proto"
    table.write_text(table.read_text().replace("oneof: payload}", "oneof: payload, owner: proto}"))
    text = envelope.read_text().replace("    A a = 1;\n", "    A a = 1;\n    B b = 7;\n")
    envelope.write_text(text.replace('import "a.proto";\n', 'import "a.proto";\nimport "b.proto";\n'))
    with inside(project):
        assert main(["add", "c", "--proto", "B", "--direction", "board_to_ros"]) == 1
        assert main(["add", "b", "--proto", "B", "--direction", "board_to_ros"]) == 0
    assert [row.number for row in reader.read(table, []).rows] == [1, 7]
