"""The generated Python reads as if written by hand: it compiles, and the formatter and the linter leave it as it is."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import black
import pytest
from case_file import CaseFile
from golden import ROOT, files_of, passing_cases

_MODE = black.Mode(line_length=88, target_versions={black.TargetVersion.PY310})
_CASES = pytest.mark.parametrize("case", passing_cases(), ids=lambda case: case.name)
# What protoc's stubs say of a message with extensions is in no release of protobuf's own stubs, and of a message with a
# field called `str` they say that every text is that field.
_TYPED = [case for case in passing_cases() if case.name not in ("extensions", "names_of_python")]


def _python(case: CaseFile) -> dict[str, str]:
    """The generated modules that are ours, not protoc's."""
    return {
        path: text
        for path, text in files_of(case).items()
        if path.endswith(".py") and not path.startswith(f"{_folder(case)}/pb2/")
    }


def _folder(case: CaseFile) -> str:
    """The folder of the generated package."""
    return next(path.removesuffix("/registry.py") for path in files_of(case) if path.endswith("/registry.py"))


@pytest.mark.slow
@_CASES
def test_black_leaves_it_as_it_is(case: CaseFile) -> None:
    """Every module is laid out as black lays it out in 88 columns."""
    changed = {path: black.format_str(text, mode=_MODE) for path, text in _python(case).items()}
    assert _python(case) == changed


@_CASES
def test_it_compiles(case: CaseFile) -> None:
    """Every module, protoc's included, is Python."""
    for path, text in files_of(case).items():
        if path.endswith((".py", ".pyi")):
            compile(text, path, "exec")


@pytest.mark.slow
def test_ruff_finds_nothing(tmp_path: Path) -> None:
    """The linter, with this repository's settings, has nothing to say about the modules of any case."""
    for case in passing_cases():
        _write(tmp_path / case.name, files_of(case))
    lint = [sys.executable, "-m", "ruff", "check", "--no-cache", "--config", ROOT / "pyproject.toml"]
    said = [
        subprocess.run([*lint, _folder(case)], cwd=tmp_path / case.name, capture_output=True, text=True).stdout
        for case in passing_cases()
    ]
    assert [text for text in said if "All checks passed!" not in text] == []


@pytest.mark.slow
@pytest.mark.parametrize("case", _TYPED, ids=lambda case: case.name)
def test_mypy_finds_nothing(case: CaseFile, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """The type checker, as strict as for this repository, has nothing to say about the modules."""
    _write(tmp_path, files_of(case))
    cache = tmp_path_factory.getbasetemp() / "mypy"
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", cache]
    done = subprocess.run(
        [*command, "--package", _folder(case).replace("/", ".")], cwd=tmp_path, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stdout


def _write(project: Path, files: dict[str, str]) -> None:
    """The project as its owner has it: the generated code beside the runtime that it imports."""
    project.mkdir(exist_ok=True)
    (project / "roverlink").symlink_to(ROOT / "roverlink")
    for path, text in files.items():
        target = project / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
