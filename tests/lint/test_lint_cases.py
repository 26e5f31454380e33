"""Golden cases of the lint: a folder each under `cases/`, named after the rule that it is about.

A case is a user's project, or a folder `proto/` without a table, and `expected`, what `roverlink lint` prints of it.
Where it has a folder `before/`, that is the earlier state (`--against before`). `<ID>_bad_...` has a finding of it,
`<ID>_good_...` has none. A new case: write the project, leave `expected` empty, run
`pytest tests/lint/test_lint_cases.py --update-cases`, review.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from roverlink.__main__ import main
from roverlink.generator.lint.rules import modules

CASES = Path(__file__).parent / "cases"
# A history cannot be a folder: these have their cases in test_past.py, where a test reports each and another does not.
_OF_HISTORY = {"HIS101", "HIS102", "HIS103", "HIS104", "PIN102"}
_FOLDERS = sorted(folder for folder in CASES.iterdir() if folder.is_dir())


def _lint(project: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    root = [] if (project / "mapping.yaml").is_file() else ["proto"]
    against = ["--against", "before"] if (project / "before").is_dir() else []
    code = main(["lint", *root, *against])
    said = capsys.readouterr()
    return code, said.out + said.err


@pytest.fixture
def project(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of a case's project, as the current folder."""
    copy = Path(shutil.copytree(request.param, tmp_path / "project", ignore=shutil.ignore_patterns("expected")))
    monkeypatch.chdir(copy)
    return copy


@pytest.mark.parametrize(
    ("project", "folder"),
    [(folder, folder) for folder in _FOLDERS],
    ids=lambda folder: folder.name,
    indirect=["project"],
)
def test_lint_case(
    project: Path, folder: Path, capsys: pytest.CaptureFixture[str], request: pytest.FixtureRequest
) -> None:
    """The lint says what the case expects, with the rule's id exactly where the case's name promises it."""
    code, said = _lint(project, capsys)
    if request.config.getoption("--update-cases"):
        (folder / "expected").write_text(said, encoding="utf-8")
    assert said == (folder / "expected").read_text(encoding="utf-8")
    id, verdict = folder.name.split("_")[:2]
    assert (f"[{id}]" in said) == (verdict == "bad"), said
    assert code == (1 if "error[" in said or "warning[" in said else 0)


def test_every_rule_has_a_case_that_fails_and_one_that_passes() -> None:
    """For each rule of the lint there is a bad and a good case."""
    named = {tuple(folder.name.split("_")[:2]) for folder in _FOLDERS}
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
