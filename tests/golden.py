"""Golden cases, the files below `generator/cases/`: users' projects, and what `roverlink generate` makes of each.

`case_file` describes the format. Of a project that compiles, a case shows:

- `lines/PATH`: the lines of a generated file that the case is about, in the order in which they stand there. What the
  crosscheck judges, the names, types and order of fields, is left to it; `generated/` shows whole files.
- a line of `generator/cases/digests.txt`, with one digest for all files of each kind (protoc's excepted): it tells
  which projects a change of the generator reaches. To see how, run `python tests/golden.py FOLDER` before and after the
  change: it writes all files of all cases. Then compare the two folders.

Of a project that does not compile, or that draws a warning, a case shows what is printed: `stderr` is the whole text,
`found` is the text without quoted source lines, blank lines and the summary, and says a help that stands below several
diagnostics in a row once, as `help for these 3: ...`. The project stays as it was.

A new case: write the sentence and the project, add an empty section `found` where it should fail, run
`pytest tests/generator/test_cases.py --update-cases`, and review what was filled in. Run the same command after a
change of the generator; the diff of the cases is then the change as a user sees it.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from case_file import CaseFile, case_files, usual_table

from roverlink.__main__ import main
from roverlink.generator.pipeline import Compiled, compile_table

ROOT = Path(__file__).parents[1]
PROBE_TABLE = usual_table(
    "messages:\n  - {number: 1, name: probe, proto: Probe, topic: probe, direction: board_to_ros}\n"
)
"""Table of the smallest project: one message of a board."""
PROBE_PROTO = 'syntax = "proto3";\n\nmessage Probe {\n  float depth_m = 1;\n}\n'
"""The .proto file of this message."""
_FOLDER = ROOT / "tests" / "generator" / "cases"
CASES = case_files(_FOLDER)
DIGESTS = _FOLDER / "digests.txt"
_LEFT_OUT = re.compile(r"^(?: *\d* \|.*|\d+ (?:error|warning|hint).*|)\n", re.MULTILINE)
"""What the section `found` leaves out: a quoted source line, the summary, a blank line."""
_DIAGNOSTIC = re.compile(r"^(\S.*\n(?:  (?!help: ).*\n)*)(?:  help: (.*\n))?", re.MULTILINE)


@dataclass(frozen=True)
class Outcome:
    """What a command said, and how it ended."""

    code: int
    stdout: str
    stderr: str


def case(name: str) -> CaseFile:
    """The case of a name."""
    return next(case for case in CASES if case.name == name)


def passing_cases() -> list[CaseFile]:
    """The cases that compile."""
    printed = {case: "".join(case.expectations.get(stream, "") for stream in ("stderr", "found")) for case in CASES}
    return [case for case, text in printed.items() if exit_code(text) == 0]


def exit_code(printed: str) -> int:
    """The exit code that the severities of the printed diagnostics ask for."""
    return 2 if ": fatal[" in printed else int(": error[" in printed)


def in_brief(printed: str) -> str:
    """The printed text as a section `found` has it."""
    brief = ""
    for help, same in groupby(_DIAGNOSTIC.findall(_LEFT_OUT.sub("", printed)), key=itemgetter(1)):
        diagnostics = [text for text, _ in same]
        whose = f" for these {len(diagnostics)}" if len(diagnostics) > 1 else ""
        brief += "".join(diagnostics) + (f"  help{whose}: {help}" if help else "")
    return brief


def digests(files: Mapping[str, bytes]) -> str:
    """Digests of generated files, one for all files with the same suffix; the files that protoc writes do not count."""
    kinds: dict[str, bytes] = {}
    for path, content in sorted(files.items()):
        if "/pb2/" not in path:
            suffix = Path(path).suffix
            kinds[suffix] = kinds.get(suffix, b"") + b"%s\n%s" % (path.encode(), content)
    return " ".join(f"{suffix}:{sha256(content).hexdigest()[:8]}" for suffix, content in sorted(kinds.items()))


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


if __name__ == "__main__":
    for one in passing_cases():
        for path, text in files_of(one).items():
            target = Path(sys.argv[1], one.name, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
