"""The lint says what each golden case expects; `golden_lint_cases` describes the files, and how to write a case."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from golden_histories import golden_histories
from golden_lint_cases import LintCase, lint_cases

from roverlink.__main__ import main
from roverlink.generator.lint.rules import lint_rules

_CASES = lint_cases()
# A case holds no history: these have their cases in test_past.py, where a test reports each and another does not.
_OF_HISTORY = {"HIS101", "HIS102", "HIS103", "HIS104", "HIS105", "PIN102"}
# The good example in the documentation of these is all there is to say; generator/test_rule_examples.py runs it.
_GOOD_BY_EXAMPLE = {
    *("ENV101", "ENV103", "ENV104", "ENV105", "ENV106", "ENV107", "ENV108", "FIX103", "LNK101", "NAM101"),
    *("NAM103", "ROS101", "TAB101", "TAB102", "TAB103", "TAB104", "TAB106", "TAB108", "TAB111", "TAB114"),
    *("TAB115", "TAB116", "TAB117", "TAB118", "TAB119", "WIR102", "WIR103", "WIR105", "WIR106", "WIR107"),
    *("WIR108", "WIR109", "WIR112", "WIR113", "WIR115"),
}


@pytest.mark.parametrize("case", _CASES, ids=lambda case: case.name)
def test_lint_case(
    case: LintCase,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    request: pytest.FixtureRequest,
) -> None:
    """The lint says what the case expects, with the rule's id exactly where the case's name promises it."""
    monkeypatch.chdir(case.write(tmp_path))
    code = main(["lint", *case.arguments])
    said = capsys.readouterr()
    assert said.err == ""
    if request.config.getoption("update_cases"):
        case.update(said.out)
    else:
        shown, expected = case.expected(said.out)
        assert shown == expected
    id, verdict = case.name.split("_")[:2]
    assert (f"[{id}]" in said.out) == (verdict == "bad")
    assert code == (1 if "error[" in said.out or "warning[" in said.out else 0)


def test_every_rule_has_a_case_that_fails_and_one_that_passes() -> None:
    """For each rule of the lint there is a bad and a good case, or a good example that is run."""
    named = {tuple(case.name.split("_")[:2]) for case in _CASES} | {(id, "good") for id in _GOOD_BY_EXAMPLE}
    ids = lint_rules().keys() - _OF_HISTORY
    assert sorted(f"{id}_{verdict}" for id in ids for verdict in ("bad", "good") if (id, verdict) not in named) == []


def test_every_case_says_what_it_proves() -> None:
    """Cases and histories have a sentence and names of their own, and cases have no keys that nobody reads."""
    for case in _CASES:
        assert case.entry["why"].endswith("."), case.name
        assert case.entry.keys() <= {"why", "now", "before", "finds", "prints"}, case.name
    assert [history.name for history in golden_histories() if not history.entry["why"].endswith(".")] == []
    for folder in ("cases", "histories"):
        for file in (Path(__file__).parent / folder).glob("*.yaml"):
            names = re.findall(r"^  (\w+):$", file.read_text(encoding="utf-8"), re.MULTILINE)
            assert sorted(set(names)) == sorted(names), file  # YAML takes the last one of two
