"""The lint says what each golden case expects; `golden_lint_cases` describes the files, and how to write a case."""

from __future__ import annotations

from pathlib import Path

import pytest
from golden_lint_cases import LintCase, lint_cases

from roverlink.__main__ import main

_CASES = lint_cases()


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
