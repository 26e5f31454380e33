"""Golden cases: a folder each under `cases/`, with a user's project and what `roverlink generate` makes of it.

A case holds `mapping.yaml`, `proto/` and whatever else the project has, and

- `expected/`: the generated files that are worth reading; the others are made too, and looked at by other tests. A case
  without it fails, and leaves the project as it was;
- `stderr`: the findings; beside `expected/` they are warnings.

A new case: write the project, create empty files under `expected/` for what is worth reading (or none, where it is to
fail), run `pytest tests/generator/test_cases.py --update-cases`, and review what was filled in. The same command after
a change of the generator; the diff of the cases is then the change as a user sees it.
"""

from __future__ import annotations

import contextlib
import io
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from roverlink.__main__ import main
from roverlink.generator.pipeline import compile_table

ROOT = Path(__file__).parents[2]
CASES = Path(__file__).parent / "cases"


@dataclass(frozen=True)
class Outcome:
    """What a command said, and how it ended."""

    code: int
    stdout: str
    stderr: str


@dataclass(frozen=True)
class Case:
    """A golden case."""

    folder: Path

    @property
    def expected(self) -> Path:
        """Folder of the expected files."""
        return self.folder / "expected"

    @property
    def stderr(self) -> Path:
        """File with the expected findings."""
        return self.folder / "stderr"

    def copy_project(self, parent: Path) -> Path:
        """The case's project, in a folder of its own."""
        return Path(
            shutil.copytree(self.folder, parent / "project", ignore=lambda folder, _: self._expectations(folder))
        )

    def _expectations(self, folder: str) -> list[str]:
        return ["expected", "stderr"] if Path(folder) == self.folder else []


def cases() -> list[Case]:
    """Every case, by name."""
    return [Case(folder) for folder in sorted(CASES.iterdir()) if folder.is_dir()]


def passing_cases() -> list[Case]:
    """The cases that compile."""
    return [case for case in cases() if case.expected.is_dir()]


@cache
def files_of(case: Case) -> dict[str, str]:
    """Everything that a passing case compiles to."""
    return compile_table(case.folder / "mapping.yaml").files


def generate(project: Path, *options: str) -> Outcome:
    """`roverlink generate` in a project's folder."""
    stdout, stderr = io.StringIO(), io.StringIO()
    with inside(project), contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr):
        code = main(["generate", *options])
    return Outcome(code, stdout.getvalue(), stderr.getvalue())


@contextlib.contextmanager
def inside(folder: Path) -> Iterator[None]:
    """The folder as the current one."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def snapshot(project: Path) -> dict[str, bytes]:
    """The content of every file of a project, by path."""
    return {
        path.relative_to(project).as_posix(): path.read_bytes() for path in sorted(project.rglob("*")) if path.is_file()
    }
