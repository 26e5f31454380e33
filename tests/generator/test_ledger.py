"""The ledger over many generates: nothing that was published is ever forgotten."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from golden import PROBE_TABLE, ROOT, generate
from hypothesis import given, settings
from hypothesis import strategies as st
from trees import commit, edit

from roverlink.__main__ import main
from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.lint.rules import lint_rules

_LEDGER = (ROOT / "mapping.lock").read_text(encoding="utf-8")


def _read(file: Path) -> tuple[lock.Ledger, list[str]]:
    findings: list[Diagnostic] = []
    read = lock.read(file, findings)
    return read, [finding.rule.id for finding in findings]


@pytest.mark.slow
def test_a_field_that_is_gone_stays_known(project: Path) -> None:
    """Its line stays, marked; when the field comes back, the mark goes."""
    file, ledger = project / "proto" / "arm.proto", project / "mapping.lock"
    text = file.read_text()
    line = next(line for line in text.splitlines() if " = 1;" in line)
    gone = [f"{fact} gone" for fact in ledger.read_text().splitlines() if fact.startswith("    1 ")]
    faults = (rule for rule in lint_rules().values() if rule.severity is not Severity.HINT)
    allowed = (f"  {rule.id}: {{severity: hint, reason: for the test}}\n" for rule in faults if rule.id[:3] == "WIR")
    (project / "mapping.yaml").write_text((project / "mapping.yaml").read_text() + f"lint:\n{''.join(allowed)}")
    edit(file, f"{line}\n", "")
    assert generate(project).code == 0
    assert any(fact in ledger.read_text() for fact in gone)
    file.write_text(text)
    assert generate(project).code == 0
    assert " gone" not in ledger.read_text()


def test_a_payload_whose_message_got_another_name(project: Path) -> None:
    """It keeps its number, since its fields are the same; the ledger knows both names, and nobody else gets it."""
    table = project / "mapping.yaml"
    for file in (table, project / "proto" / "joint.proto", project / "proto" / "arm.proto"):
        edit(file, "Wrist", "Hand")
    assert generate(project).code == 0
    published, _ = _read(project / "mapping.lock")
    assert [(one.number, one.proto, one.gone) for one in published.entries] == [
        (1, "Arm", False),
        (2, "Hand", False),
        (2, "Wrist", True),
    ]
    assert generate(project, "--check").code == 0
    edit(table, "proto: Hand", "proto: Joint")
    refused = generate(project)
    assert (refused.code, "error[ENV102] field 2 was published for 'wrist' (Hand)" in refused.stderr) == (1, True)


@pytest.mark.slow
@settings(max_examples=50)
@given(st.integers(0, len(_LEDGER.splitlines()) - 1), st.sampled_from(["cut", "drop", "twice", "change"]))
def test_every_edit_by_hand_is_noticed(tmp_path_factory: pytest.TempPathFactory, index: int, edit: str) -> None:
    """A line taken out, repeated or changed, or everything after it cut off, is a finding."""
    lines = _LEDGER.splitlines(keepends=True)
    changed = {
        "cut": lines[:index],
        "drop": lines[:index] + lines[index + 1 :],
        "twice": lines[: index + 1] + lines[index:],
        "change": [*lines[:index], lines[index].rstrip("\n") + "x\n", *lines[index + 1 :]],
    }[edit]
    file = tmp_path_factory.getbasetemp() / "edited.lock"
    file.write_text("".join(changed))
    _, rules = _read(file)
    assert rules
    assert set(rules) <= {"LED102", "LED103"}


@pytest.mark.slow
def test_a_deleted_ledger_is_noticed(project: Path) -> None:
    """As long as git has it, nothing is generated without it; a project that never had one begins with none."""
    lock = project / "mapping.lock"
    commit(project, "Begin")
    lock.unlink()
    assert _read(lock)[1] == ["LED104"]
    assert "mapping.lock: error[LED104] the ledger was deleted" in generate(project).stderr
    assert not lock.exists()
    commit(project, "Begin again")
    assert generate(project).code == 0


_ROWS = """\
  - {number: 2, name: arm, proto: Arm, topic: arm, direction: ros_to_board, deadman: {after: 1s, send: {SENT}}}
  - {number: 3, name: sensor, proto: Sensor, topic: sensor, direction: board_to_ros}
"""


def _commands(folder: Path, sent: str) -> Path:
    """A project with a sensor and an arm, whose deadman sends the fields ``sent``; generated."""
    (folder / "proto").mkdir()
    shutil.copy(ROOT / "tests" / "shared" / "commands.proto", folder / "proto")
    head = PROBE_TABLE.partition("  - ")[0].replace("{board: {}}", "{board: {}, base: {}}")
    (folder / "mapping.yaml").write_text(head + _ROWS.replace("SENT", sent), encoding="utf-8")
    run = generate(folder)
    assert run.code == 0, run.stderr
    return folder


@pytest.fixture
def rover(tmp_path: Path) -> Path:
    """A copy of the sample rover's table, ledger and protos."""
    for name in ("mapping.yaml", "mapping.lock"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copytree(ROOT / "proto", tmp_path / "proto")
    return tmp_path


@pytest.mark.slow
def test_a_retired_row_does_not_come_back_with_another_peer(tmp_path: Path) -> None:
    """The ledger keeps the settings of a retired row: where its number may be freed, only the same row comes back."""
    project = _commands(tmp_path, "text: a")
    table = project / "mapping.yaml"
    text = table.read_text()
    assert main(["number", "retire", "2", "--table", str(table)]) == 0
    assert "  2: arm Arm retired\n" in (project / "mapping.lock").read_text()
    text += 'lint:\n  WIR106: {severity: "off", reason: the arm is back}\n'
    table.write_text(text.replace("ros_to_board", "ros_to_base"))
    assert "error[TAB109] 'arm' has another peer" in generate(project).stderr
    table.write_text(text.replace(", deadman: {after: 1s, send: {text: a}}", ""))
    assert "error[TAB110] the deadman of 'arm' was removed" in generate(project).stderr
    table.write_text(text)
    assert generate(project).code == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "sent", ['text: "a\\nb"', 'text: "a: b\\u2028\\u00e9 retired"', "mode: HOLD, grip.force: -1.5"]
)
def test_any_stop_payload_is_read_back(tmp_path: Path, sent: str) -> None:
    """Line breaks and marks of the ledger within a text are no lines of the ledger, and nothing changes with them."""
    project = _commands(tmp_path, sent)
    read, findings = _read(project / "mapping.lock")
    assert findings == []
    assert read.settings[2, "Arm"]["deadman send"].text.count(":") >= 1
    before = (project / "mapping.lock").read_bytes()
    run = generate(project)
    assert (run.code, run.stderr) == (0, "")
    assert (project / "mapping.lock").read_bytes() == before


_CONFLICT = """\
version: 1

numbers:
  1: old Old on old
<<<<<<< HEAD
  2: ours Ours on ours
{shared}    2 b int32
=======
  2: theirs Theirs on theirs
{shared}    2 c int32
>>>>>>> theirs

rows:
  1 Old direction: a_to_ros
<<<<<<< HEAD
  1 Old priority: 2
  1 Old max_rate: 5
=======
  1 Old priority: 2
  1 Old max_rate: 7
>>>>>>> theirs

checksum: 0123456789abcdef
"""


def test_a_conflict_keeps_what_both_sides_have(tmp_path: Path) -> None:
    """Within the markers, a number of one side is contested, a setting of one is open; what both have was published."""
    file = tmp_path / "mapping.lock"
    file.write_text(_CONFLICT.format(shared="\nschema:\n  message Old:\n    1 a int32\n"))
    read, findings = _read(file)
    assert findings == []
    assert [(entry.number, entry.name, entry.contested) for entry in read.entries] == [
        (1, "old", False),
        (2, "ours", True),
        (2, "theirs", True),
    ]
    assert [field.name for field in read.fields("Old")] == ["a"]
    settings = {key: setting.text for key, setting in read.settings[1, "Old"].items()}
    assert settings == {"direction": "a_to_ros", "priority": "2"}
