"""Golden cases of the lint: the files below `cases/`, named after the rule that they are about.

`case_file` describes the format. A case is a user's project, or a folder `proto/` without a table, and what
`roverlink lint` prints of it. A folder `before/` is the earlier state (`--against before`). `<ID>_bad_...` has a
finding of the rule, `<ID>_good_...` has none. A new case: write the sentence and the project, run
`pytest tests/lint/test_lint_cases.py --update-cases`, review.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from case_file import CaseFile, case_files, outcome

from roverlink.__main__ import main
from roverlink.generator.lint.rules import modules

_CASES = case_files(Path(__file__).parent / "cases")
# A case holds no history: these have their cases in test_past.py, where a test reports each and another does not.
_OF_HISTORY = {"HIS101", "HIS102", "HIS103", "HIS104", "HIS105", "PIN102"}


@pytest.mark.parametrize("case", _CASES, ids=lambda case: case.name)
def test_lint_case(
    case: CaseFile,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    request: pytest.FixtureRequest,
) -> None:
    """The lint says what the case expects, with the rule's id exactly where the case's name promises it."""
    monkeypatch.chdir(case.write_inputs(tmp_path))
    root = [] if "mapping.yaml" in case.inputs else ["proto"]
    against = ["--against", "before"] if (tmp_path / "before").is_dir() else []
    code = main(["lint", *root, *against])
    said = capsys.readouterr()
    found = outcome(code, stdout=said.out, stderr=said.err)
    if request.config.getoption("update_cases"):
        case.update(found)
    else:
        assert found == case.expectations
    id, verdict = case.name.split("_")[:2]
    assert (f"[{id}]" in said.out) == (verdict == "bad")
    assert code == (1 if "error[" in said.out or "warning[" in said.out else 0)


def test_every_rule_has_a_case_that_fails_and_one_that_passes() -> None:
    """For each rule of the lint there is a bad and a good case."""
    named = {tuple(case.name.split("_")[:2]) for case in _CASES}
    missing = [f"{id}_{verdict}" for id in modules() for verdict in ("bad", "good") if (id, verdict) not in named]
    missing = [name for name in missing if name[:6] not in _OF_HISTORY]
    assert missing == []


@pytest.mark.parametrize("id", modules())
def test_every_rule_explains_itself(id: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`roverlink explain ID` says what a rule finds and why that hurts, and shows a bad and a good example."""
    assert main(["explain", id]) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"{id} {modules()[id].RULE.name} (")
    assert "\nBad::\n" in said
    assert "\nGood::\n" in said
