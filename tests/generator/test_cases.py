"""Every golden case gives what it is expected to give; see `golden` for what a case is and how to write one."""

from __future__ import annotations

import importlib
import pkgutil
from pathlib import Path

import pytest
from golden import ROOT, Case, Outcome, cases, generate, passing_cases, snapshot

from roverlink import generator
from roverlink.generator.diagnostics import Rule


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.folder.name)
def test_case(case: Case, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """The project compiles to the expected files, or the expected findings are all that comes of it."""
    project = case.copy_project(tmp_path)
    before = snapshot(project)
    outcome = generate(project)
    after = snapshot(project)
    if request.config.getoption("update_cases"):
        _update(case, outcome, after)
    assert outcome.stderr == (case.stderr.read_text(encoding="utf-8") if case.stderr.exists() else "")
    if case.expected.is_dir():
        assert outcome.code == 0
        assert {name: after.get(name) for name in snapshot(case.expected)} == snapshot(case.expected)
    else:
        assert outcome.code == (2 if " fatal[" in outcome.stderr else 1)
        assert after == before


def _update(case: Case, outcome: Outcome, files: dict[str, bytes]) -> None:
    if case.expected.is_dir():
        assert outcome.code == 0, outcome.stderr
        for name in snapshot(case.expected):
            (case.expected / name).write_bytes(files[name])
    else:
        assert outcome.code, "it compiles: create an empty file under expected/ for each file that is worth reading"
    if outcome.stderr:
        case.stderr.write_text(outcome.stderr, encoding="utf-8")
    else:
        case.stderr.unlink(missing_ok=True)


def test_every_rule_has_a_case() -> None:
    """Each rule is seen to report at its place by a failing case here, or by a case or a test of the lint."""
    seen = [case.stderr for case in cases() if case.stderr.exists()]
    seen += [*(ROOT / "tests").glob("lint/cases/*/expected"), *(ROOT / "tests").glob("lint/test_*.py")]
    seen += [*(ROOT / "tests").glob("cli/test_*.py"), *(ROOT / "tests" / "generator").glob("test_*.py")]
    said = "".join(file.read_text(encoding="utf-8") for file in seen)
    assert [rule for rule in sorted(_rules()) if rule not in said] == []


def test_rules_are_told_apart() -> None:
    """No two rules share an id or a name: `explain` finds them by both."""
    rules = {id(rule): rule for rules in _rules().values() for rule in rules}.values()
    assert len(rules) == len({rule.id for rule in rules}) == len({rule.name for rule in rules})


def _rules() -> dict[str, list[Rule]]:
    """The rules that the generator's modules declare, by id."""
    rules: dict[str, list[Rule]] = {}
    for module in pkgutil.walk_packages(generator.__path__, "roverlink.generator."):
        for value in vars(importlib.import_module(module.name)).values():
            if isinstance(value, Rule):
                rules.setdefault(value.id, []).append(value)
    return rules


def test_there_are_passing_cases() -> None:
    """The tests that run over the passing cases have something to run over."""
    assert len(passing_cases()) > 10
