"""`roverlink add` and `roverlink number retire`: one row more or less in the table; its other lines stay the same."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest
from golden import PROBE_TABLE, ROOT, case, generate, inside, snapshot
from hypothesis import given, settings
from hypothesis import strategies as st
from trees import edit

from roverlink.__main__ import main
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.table import Table, reader
from roverlink.generator.table.edit import with_retired, with_row

_HEAD = PROBE_TABLE.partition("messages:")[0]


def _parsed(text: str) -> Table:
    findings: list[object] = []
    table = reader.parse(text, "mapping.yaml", findings)  # type: ignore[arg-type]  # only their number matters
    assert findings == []
    return table


# --- a row more -------------------------------------------------------------------------------------------------

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
_FLOW = "messages:\n- {number: 1, name: a, proto: A, topic: a, direction: board_to_ros}  # short\n"
_ADDED_BLOCK = '  - number: 2\n    name: "off"\n    proto: B\n    topic: b\n    direction: board_to_ros\n'
_ADDED_FLOW = '- {number: 2, name: "off", proto: B, topic: b, direction: board_to_ros}\n'


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        (_BLOCK, _BLOCK.replace("# what is gone\n", f"{_ADDED_BLOCK}# what is gone\n")),
        (_FLOW, _FLOW + _ADDED_FLOW),
        (_FLOW.rstrip("\n"), _FLOW + _ADDED_FLOW),
    ],
    ids=["a block", "in one line", "no end of the last line"],
)
def test_a_row_comes_behind_the_last_in_its_style(rows: str, expected: str) -> None:
    """The text differs by the row alone, and reads back as it was meant."""
    text = with_row(_HEAD + rows, _ROW, "mapping.yaml")
    assert text == _HEAD + expected
    assert [row.name for row in _parsed(text).rows] == ["a", "off"]


@pytest.mark.parametrize("rows", ["", "messages: []\n", "messages: [{number: 1, name: a}]\n", "messages:\n  - 7\n"])
def test_rows_that_are_not_one_below_the_other(rows: str) -> None:
    """Where no row stands that the new one could be written like, that is a finding."""
    with pytest.raises(DiagnosticsError, match="RET103"):
        with_row(_HEAD + rows, _ROW, "mapping.yaml")


@pytest.fixture
def two_payloads(tmp_path: Path) -> Path:
    """A generated project with two payloads, one of which has a row."""
    (tmp_path / "mapping.yaml").write_text(_HEAD + _BLOCK.replace("    forward:\n      - board\n", ""))
    (tmp_path / "proto").mkdir()
    for name in ("a", "b"):
        text = f'syntax = "proto3";\nmessage {name.upper()} {{ int32 x = 1; }}\n'
        (tmp_path / "proto" / f"{name}.proto").write_text(text)
    assert generate(tmp_path).code == 0
    return tmp_path


def _add(project: Path, name: str, *options: str, proto: str = "B", direction: str = "board_to_ros") -> int:
    with inside(project):
        return int(main(["add", name, "--proto", proto, "--direction", direction, *options]))


@pytest.mark.slow
def test_a_row_is_added_and_generated(two_payloads: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The number is the next one that was never taken, the topic the name unless it is given; all is generated."""
    assert _add(two_payloads, "b", direction="ros_to_board") == 0
    assert "b has the number 2" in capsys.readouterr().err
    assert _add(two_payloads, "again", "--topic", "t", "--ros", "B") == 0
    assert generate(two_payloads, "--check").code == 0
    rows = reader.read(two_payloads / "mapping.yaml", []).rows
    assert [(row.number, row.name, row.topic) for row in rows] == [(1, "a", "a"), (2, "b", "b"), (3, "again", "t")]
    assert (two_payloads / "generated" / "handlers" / "again.py").is_file()
    with inside(two_payloads):
        main(["number", "retire", "3"])
    assert _add(two_payloads, "c") == 0
    assert "c has the number 4" in capsys.readouterr().err


def test_a_dry_run_shows_the_diff(two_payloads: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With --dry-run, the changes are printed and none is made."""
    before = snapshot(two_payloads)
    assert _add(two_payloads, "b", "--dry-run") == 0
    said = capsys.readouterr()
    assert "+  - number: 2\n" in said.out
    assert "+++ b/proto/envelope.proto" in said.out
    assert "b would have the number 2" in said.err
    assert snapshot(two_payloads) == before


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
    name: str, proto: str, direction: str, expected: str, two_payloads: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A name that is taken, a message or a peer that is not there: findings, exit code 1, and no change."""
    before = snapshot(two_payloads)
    assert _add(two_payloads, name, proto=proto, direction=direction) == 1
    assert f"error[{expected}]" in capsys.readouterr().err
    assert snapshot(two_payloads) == before


@pytest.mark.slow
def test_in_an_envelope_of_another_the_number_is_the_member_s(two_payloads: Path) -> None:
    """Where the envelope has the member already, its number stands there; where it does not, nothing is added."""
    table, envelope = two_payloads / "mapping.yaml", two_payloads / "proto" / "envelope.proto"
    edit(table, "oneof: payload}", "oneof: payload, owner: proto}")
    edit(envelope, "    A a = 1;\n", "    A a = 1;\n    B b = 7;\n")
    edit(envelope, 'import "a.proto";\n', 'import "a.proto";\nimport "b.proto";\n')
    assert _add(two_payloads, "c") == 1
    assert _add(two_payloads, "b") == 0
    assert [row.number for row in reader.read(table, []).rows] == [1, 7]


# --- a row less -------------------------------------------------------------------------------------------------

_TABLE = (ROOT / "mapping.yaml").read_text(encoding="utf-8")
_SECOND = """\
  - number: 2  # two
    name: b
    proto: pkg.B
    topic: b
    direction: board_to_ros
    ignore:
      - x
"""
_ROWS = f"""\
messages:
  # the first
  - {{number: 1, name: a, proto: A, topic: a, direction: board_to_ros}}
  # the second, in a block
{_SECOND}
  # the last
  - {{number: 3, name: c, proto: C,
     topic: c, direction: board_to_ros}}
"""
_B = "{number: 2, name: b, proto: pkg.B}"
_Z = "{number: 9, name: z, proto: Z}"
_Z_BLOCK = "- number: 9\n  name: z\n  proto: Z\n"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("retired: []\n", f"retired:\n  - {_B}\n"),
        ("retired: []  # none yet\n", f"retired:  # none yet\n  - {_B}\n"),
        ("", f"retired:\n  - {_B}\n"),
        (f"retired: [{_Z}]  # long ago\n", f"retired: [{_Z}, {_B}]  # long ago\n"),
        (f"retired:\n{_Z_BLOCK}# the end\n", f"retired:\n{_Z_BLOCK}- {_B}\n# the end\n"),
    ],
    ids=["empty", "empty with a comment", "absent", "in one line", "a block"],
)
def test_the_entry_is_written_as_its_neighbours_are(before: str, after: str) -> None:
    """Whatever `retired` looks like, the new entry stands in it, and comments and layout stay."""
    said = with_retired(_HEAD + _ROWS + before, 2, "mapping.yaml")
    assert said == _HEAD + _ROWS.replace(_SECOND, "") + after
    assert [row.number for row in _parsed(said).rows] == [1, 3]


@pytest.mark.slow
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
    retired = {(row.number, row.name, row.proto) for row in before.rows if row.number in gone}
    assert {(row.number, row.name, row.proto) for row in after.retired} == retired
    changed = [line for line in difflib.ndiff(_TABLE.splitlines(), text.splitlines()) if line[0] in "+-"]
    assert [line for line in changed if "#" in line] == []  # no comment is lost
    assert {line for line in changed if line[0] == "+"} <= {"+ retired:"} | {
        f"+   - {{number: {number}, name: {name}, proto: {proto}}}" for number, name, proto in retired
    }


def test_a_number_that_no_row_has() -> None:
    """Which numbers there are is said, and nothing is touched."""
    said = r"RET101.*no row under `messages` has the number 7\n  help: known numbers: 1, 2, 3"
    with pytest.raises(DiagnosticsError, match=said):
        with_retired(_HEAD + _ROWS, 7, "mapping.yaml")


@pytest.mark.slow
def test_retiring_generates(project: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The envelope reserves number and name, the ledger says so, the handler goes; the drift check is content."""
    with inside(project):
        assert main(["number", "retire", "2"]) == 0
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
        assert main(["number", "retire", "1"]) == 1
    assert "nothing was written" in capsys.readouterr().err
    assert snapshot(project) == before
