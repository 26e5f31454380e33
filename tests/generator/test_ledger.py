"""The ledger over many generates: nothing that was published is ever forgotten."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from golden import ROOT, case, generate
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.lint.rules import modules

_LEDGER = (ROOT / "mapping.lock").read_text(encoding="utf-8")


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A small project, generated."""
    project = case("nested").write_inputs(tmp_path / "project")
    assert generate(project).code == 0
    return project


def _edit(file: Path, before: str, after: str) -> None:
    text = file.read_text()
    assert before in text
    file.write_text(text.replace(before, after))


def _allow(project: Path, *rules: str) -> None:
    """Let changes pass that are faults otherwise, as a team does that knows what it does."""
    settings = "".join(f"  {rule}: {{severity: hint, reason: for the test}}\n" for rule in rules)
    (project / "mapping.yaml").write_text((project / "mapping.yaml").read_text() + f"lint:\n{settings}")


def _read(file: Path) -> tuple[lock.Ledger, list[str]]:
    findings: list[Diagnostic] = []
    read = lock.read(file, findings)
    return read, [finding.rule.id for finding in findings]


def test_a_field_that_is_gone_stays_known(project: Path) -> None:
    """Its line stays, marked; when the field comes back, the mark goes."""
    file, lock = project / "proto" / "arm.proto", project / "mapping.lock"
    line = next(line for line in file.read_text().splitlines() if " = 1;" in line)
    before = lock.read_text()
    gone = [fact for fact in before.splitlines() if fact.startswith("    1 ")]
    _allow(project, *_every_rule())
    text = file.read_text()
    _edit(file, f"{line}\n", "")
    assert generate(project).code == 0, generate(project).stderr
    assert any(f"{fact} gone" in lock.read_text() for fact in gone)
    file.write_text(text)
    assert generate(project).code == 0
    assert " gone" not in lock.read_text()


def _every_rule() -> list[str]:
    changes = {id: module.RULE for id, module in modules().items() if id.startswith("WIR")}
    return [id for id, rule in changes.items() if rule.severity is not Severity.HINT]


@settings(deadline=None, max_examples=150)
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


def test_a_deleted_ledger_is_noticed(project: Path) -> None:
    """As long as git has it, nothing is generated without it; a project that never had one begins with none."""
    lock = project / "mapping.lock"
    git = ("git", "-C", str(project), "-c", "user.name=A", "-c", "user.email=a@example.com")
    for command in (["init", "--quiet"], ["add", "--all"], ["commit", "--quiet", "--message", "Begin"]):
        subprocess.run([*git, *command], check=True)
    lock.unlink()
    assert _read(lock)[1] == ["LED104"]
    assert "mapping.lock: error[LED104] was deleted" in generate(project).stderr
    assert not lock.exists()
    for command in (["rm", "--quiet", "mapping.lock"], ["commit", "--quiet", "--message", "Begin again"]):
        subprocess.run([*git, *command], check=True)
    assert generate(project).code == 0


def test_what_is_written_is_read_back() -> None:
    """Of this repository's ledger, every message and enum says what the file's lines say."""
    read, findings = _read(ROOT / "mapping.lock")
    assert findings == []
    assert [entry.number for entry in read.entries] == list(range(1, 22))
    schema = read.schema
    imu = schema.messages["SensorBoardIMUInfo"]
    assert [(field.number, field.name, field.type) for field in imu.fields][:2] == [
        (1, "accel_x", "float"),
        (2, "accel_y", "float"),
    ]
    assert imu.reserved == ((10, 12),)
    assert schema.messages["PBEnvelope"].fields[0].oneof == "payload"


def _merged(ours: list[str], theirs: list[str]) -> str:
    head, tail = "version: 1\n\nnumbers:\n  1: old Old on old\n", "\nchecksum: 0123456789abcdef\n"
    return f"{head}<<<<<<< HEAD\n{''.join(ours)}=======\n{''.join(theirs)}>>>>>>> theirs\n{tail}"


def test_a_conflict_keeps_what_both_sides_have(tmp_path: Path) -> None:
    """Within the markers, a number of one side is contested, a fact of both sides was published."""
    schema = "\nschema:\n  message Old:\n    1 a int32\n"
    file = tmp_path / "mapping.lock"
    file.write_text(
        _merged(
            ["  2: ours Ours on ours\n", schema, "    2 b int32\n"],
            ["  2: theirs Theirs on theirs\n", schema, "    2 c int32\n"],
        )
    )
    read, findings = _read(file)
    assert findings == []
    assert [(entry.number, entry.name, entry.contested) for entry in read.entries] == [
        (1, "old", False),
        (2, "ours", True),
        (2, "theirs", True),
    ]
    assert [field.name for field in read.fields("Old")] == ["a"]
