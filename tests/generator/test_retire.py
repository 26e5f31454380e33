"""`roverlink retire`: a row goes, its number stays taken, and the rest of the file is as it was."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest
from golden import ROOT, case, generate, inside, snapshot
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.__main__ import main
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.table import Table, reader
from roverlink.generator.table.edit import with_retired

_TABLE = (ROOT / "mapping.yaml").read_text(encoding="utf-8")
_HEAD = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload}
ros: {package: rover}
peers: {board: {}}
"""
_ROWS = """\
messages:
  # the first
  - {number: 1, name: a, proto: A, topic: a, direction: board_to_ros}
  # the second, in a block
  - number: 2  # two
    name: b
    proto: pkg.B
    topic: b
    direction: board_to_ros
    ignore:
      - x

  # the last
  - {number: 3, name: c, proto: C,
     topic: c, direction: board_to_ros}
"""


def _parsed(text: str) -> Table:
    findings: list[object] = []
    table = reader.parse(text, "mapping.yaml", findings)  # type: ignore[arg-type]  # only their number matters
    assert findings == []
    return table


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("retired: []\n", "retired:\n  - {number: 2, name: b, proto: pkg.B}\n"),
        ("retired: []  # none yet\n", "retired:  # none yet\n  - {number: 2, name: b, proto: pkg.B}\n"),
        ("", "retired:\n  - {number: 2, name: b, proto: pkg.B}\n"),
        (
            "retired: [{number: 9, name: z, proto: Z}]  # long ago\n",
            "retired: [{number: 9, name: z, proto: Z}, {number: 2, name: b, proto: pkg.B}]  # long ago\n",
        ),
        (
            "retired:\n- number: 9\n  name: z\n  proto: Z\n# the end\n",
            "retired:\n- number: 9\n  name: z\n  proto: Z\n- {number: 2, name: b, proto: pkg.B}\n# the end\n",
        ),
    ],
    ids=["empty", "empty with a comment", "absent", "in one line", "a block"],
)
def test_the_entry_is_written_as_its_neighbours_are(before: str, after: str) -> None:
    """Whatever `retired` looks like, the new entry stands in it, and comments and layout stay."""
    row = _ROWS[_ROWS.index("  - number: 2") : _ROWS.index("\n  # the last")]
    said = with_retired(_HEAD + _ROWS + before, 2, "mapping.yaml")
    assert said == _HEAD + _ROWS.replace(row, "") + after
    assert [row.number for row in _parsed(said).rows] == [1, 3]


@settings(max_examples=6)
@given(st.permutations(range(1, 22)), st.integers(1, 8))
def test_any_rows_can_be_retired_one_after_the_other(numbers: list[int], count: int) -> None:
    """Of this repository's table, the rows that are left are as they were, and every other line is, too."""
    text, before = _TABLE, _parsed(_TABLE)
    for number in numbers[:count]:
        text = with_retired(text, number, "mapping.yaml")
    after = _parsed(text)
    gone = set(numbers[:count])
    assert [row.name for row in after.rows] == [row.name for row in before.rows if row.number not in gone]
    assert {(row.number, row.name, row.proto) for row in after.retired} == {
        (row.number, row.name, row.proto) for row in before.rows if row.number in gone
    }
    changed = [line for line in difflib.ndiff(_TABLE.splitlines(), text.splitlines()) if line[0] in "+-"]
    assert [line for line in changed if "#" in line] == []  # no comment is lost
    assert {line for line in changed if line[0] == "+"} <= {"+ retired:"} | {
        f"+   - {{number: {row.number}, name: {row.name}, proto: {row.proto}}}" for row in after.retired
    }


def test_a_number_that_no_row_has(tmp_path: Path) -> None:
    """Which numbers there are is said, and nothing is touched."""
    with pytest.raises(
        DiagnosticsError, match=r"RET101.*no row under `messages` has the number 7\n  help: known numbers: 1, 2, 3"
    ):
        with_retired(_HEAD + _ROWS, 7, "mapping.yaml")


def test_retiring_generates(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The envelope reserves number and name, the ledger says so, the handler goes; the drift check is content."""
    project = case("nested").write_inputs(tmp_path / "project")
    assert generate(project).code == 0
    with inside(project):
        assert main(["retire", "2"]) == 0
    assert "changed mapping.yaml" in capsys.readouterr().out
    envelope = (project / "proto" / "envelope.proto").read_text()
    assert "reserved 2;" in envelope
    assert 'reserved "wrist";' in envelope
    assert "\n  2: wrist Wrist retired\n" in (project / "mapping.lock").read_text()
    assert not (project / "generated" / "handlers" / "wrist.py").exists()
    assert generate(project, "--check").code == 0


def test_what_cannot_be_generated_is_not_retired(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Where the table without the row has a fault, nothing is written, the table neither."""
    project = case("env101_number_taken").write_inputs(tmp_path / "project")
    before = snapshot(project)
    with inside(project):
        assert main(["retire", "1"]) == 1
    assert "nothing was written" in capsys.readouterr().err
    assert snapshot(project) == before
