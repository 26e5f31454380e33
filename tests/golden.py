"""Golden cases, the files below `generator/cases/`: a user's project and what `roverlink generate` makes of it.

`case_file` describes the format. In a case that compiles, the sections `expected/...` are the generated files that are
worth reading; the others are made too, and other tests look at them. A case without such a section fails, and leaves
the project as it was.

A new case: write the sentence and the project, add an empty section `expected/...` for each file that is worth reading
(none where it should fail), run `pytest tests/generator/test_cases.py --update-cases`, and review what was filled in.
Run the same command after a change of the generator; the diff of the cases is then the change as a user sees it.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from case_file import CaseFile, case_files

from roverlink.__main__ import main
from roverlink.generator.pipeline import Compiled, compile_table

ROOT = Path(__file__).parents[1]
PROBE_TABLE = """\
version: 1
proto: {root: proto}
envelope: {file: envelope.proto, message: Envelope, oneof: payload}
ros: {package: rover}
peers: {board: {}}
messages:
  - {number: 1, name: probe, proto: Probe, topic: probe, direction: board_to_ros}
"""
"""Table of the smallest project: one message of a board."""
PROBE_PROTO = 'syntax = "proto3";\n\nmessage Probe {\n  float depth_m = 1;\n}\n'
"""The .proto file of this message."""
CASES = case_files(ROOT / "tests" / "generator" / "cases")


@dataclass(frozen=True)
class Outcome:
    """What a command said, and how it ended."""

    code: int
    stdout: str
    stderr: str


def case(name: str) -> CaseFile:
    """The case of a name."""
    return next(case for case in CASES if case.name == name)


def expected_files(case: CaseFile) -> dict[str, str]:
    """Generated files that a case shows, by path; none in a case that fails."""
    found = case.expectations.items()
    return {name.removeprefix("expected/"): text for name, text in found if name.startswith("expected/")}


def passing_cases() -> list[CaseFile]:
    """The cases that compile."""
    return [case for case in CASES if expected_files(case)]


def printed_by_cases() -> str:
    """Everything that the cases of generate and of the lint print."""
    printed = [case.expectations.get(stream, "") for case in CASES for stream in ("stdout", "stderr")]
    for file in sorted((ROOT / "tests" / "lint" / "cases").glob("*.yaml")):
        printed += re.findall(r".*\w\[[A-Z]{3}[0-9]{3}\] .*\n", file.read_text(encoding="utf-8"))
    return "".join(printed)


@cache
def compiled(case: CaseFile) -> Compiled:
    """A passing case, compiled."""
    with tempfile.TemporaryDirectory() as folder:
        return compile_table(case.write_inputs(Path(folder)) / "mapping.yaml")


def files_of(case: CaseFile) -> dict[str, str]:
    """Everything that a passing case compiles to."""
    return compiled(case).files


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
