"""Every rule is documented; its bad example raises the rule and nothing else, its good example nothing."""

from __future__ import annotations

import importlib
import pkgutil
import re
from collections.abc import Iterable
from pathlib import Path

import pytest
from rule_examples import example, is_console, states, write_project

from roverlink import generator
from roverlink.__main__ import main
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Rule, Severity
from roverlink.generator.lint.bare_tree import TreeOptions
from roverlink.generator.lint.project import Question, lint_project, lint_tree
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.pipeline import add, compile_table
from roverlink.generator.rule_catalogue import rules

# The examples of these are parts of larger projects, with a ledger, git's history, folders of components or an envelope
# of another repository. Cases and tests of the lint show each of them at work.
_OF_A_PAST = {"ENV102", "ENV103", "ENV107", "ENV110", "FIX103", "TAB106", "TAB107", "WIR111", "WIR112"}
_OF_A_PAST |= {"TAB109", "TAB110", "TAB111", "TAB112", "TAB113"}
_OF_A_PAST |= {"HIS101", "HIS102", "HIS103", "HIS104", "HIS105", "PIN102"}
_OF_A_LARGER_PROJECT = {"ENV105", "ENV106", "ENV108", "FIX101", "FIX102", "FIX104", "FIX105"}
_OF_A_LARGER_PROJECT |= {"NAM101", "NAM102", "NAM103", "TAB105", "WIR113"}


def _runnable(rule: type[Rule]) -> bool:
    shown_elsewhere = rule.id in _OF_A_PAST | _OF_A_LARGER_PROJECT
    return not shown_elsewhere and not is_console(example(rule, "Bad"))


def _raised(rule: type[Rule], verdict: str, folder: Path, *, generated: bool) -> set[str]:
    """Return the ids of what the lint, and generate where it is asked, find in an example."""
    changed = states(rule, verdict)
    if changed is not None:
        for name, text in zip(("before", "now"), changed):
            (folder / name).mkdir()
            (folder / name / "example.proto").write_text(text, encoding="utf-8")
        question = Question(against=str(folder / "before"))
        return _ids(rule, lint_tree(folder / "now", TreeOptions("", ""), question).findings)
    write_project(example(rule, verdict), folder)
    table = folder / "mapping.yaml"
    try:
        if rule.id == "RET103":
            add(table, {"number": 2, "name": "gps", "proto": "Imu", "topic": "gps", "direction": "board_to_ros"})
        found = _ids(rule, compile_table(table).warnings) if generated else set()
        # The envelope is not written here, which the lint reports.
        return found | _ids(rule, lint_project(table, Question()).findings) - {"ENV105"}
    except DiagnosticsError as error:
        return _ids(rule, error.findings)


def _ids(rule: type[Rule], findings: Iterable[Diagnostic]) -> set[str]:
    """Return the ids of findings; hints are none, but for the rule's own."""
    return {one.rule.id for one in findings if one.rule == rule or one.severity is not Severity.HINT}


@pytest.mark.parametrize("rule", list(filter(_runnable, rules().values())), ids=lambda rule: rule.id)
def test_a_bad_example_raises_the_rule_and_a_good_one_nothing(rule: type[Rule], tmp_path: Path) -> None:
    """Each example, put through the lint, or else through the pipeline as well, shows what its rule is about."""
    for generated in (False, True):  # most rules are the lint's, which is faster
        folders = {verdict: tmp_path / f"{verdict}_{generated}" for verdict in ("Bad", "Good")}
        for folder in folders.values():
            folder.mkdir()
        if _raised(rule, "Bad", folders["Bad"], generated=generated) == {rule.id}:
            assert _raised(rule, "Good", folders["Good"], generated=generated) == set(), example(rule, "Good")
            return
    pytest.fail(f"not raised, or not alone:\n{example(rule, 'Bad')}")


def test_every_rule_is_in_the_catalogue_and_shown() -> None:
    """`roverlink explain` knows each rule, none shares an id or a name, and what no example runs has a case."""
    declared: dict[int, type[Rule]] = {}
    for module in pkgutil.walk_packages(generator.__path__, "roverlink.generator."):
        values = vars(importlib.import_module(module.name)).values()
        declared |= {
            id(value): value
            for value in values
            if isinstance(value, type) and issubclass(value, Rule) and value not in (Rule, LintRule)
        }
    by_id = {rule.id: rule for rule in declared.values()}
    assert by_id == rules()
    assert len(declared) == len(by_id) == len({rule.name for rule in declared.values()})
    tests = Path(__file__).parents[1]
    files = {*tests.glob("generator/cases/*"), *tests.glob("lint/cases/*"), *tests.glob("*/test_*.py")} - {
        Path(__file__)
    }
    said = "".join(file.read_text(encoding="utf-8") for file in files)
    assert [rule.id for rule in by_id.values() if not _runnable(rule) and rule.id not in said] == []


@pytest.mark.parametrize("rule", list(rules().values()), ids=lambda rule: rule.id)
def test_every_rule_is_documented(rule: type[Rule], capsys: pytest.CaptureFixture[str]) -> None:
    """The documentation has a summary, says why the rule is there, and has a bad and a good example."""
    summary, blank, why, *_ = rule.documentation.strip().splitlines()
    assert summary[-1] == "."
    assert not blank
    assert why not in ("", "Bad::")
    assert example(rule, "Bad")
    assert example(rule, "Good")
    assert main(["explain", rule.id]) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"{rule.id} {rule.name} ({rule.severity.value})\n\n{summary}\n")
    assert re.findall(r"``|::$|:\w+:`", said, re.MULTILINE) == []  # reStructuredText
