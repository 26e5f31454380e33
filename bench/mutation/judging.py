"""Judging: run the tests that cover a mutant's line against it."""

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET  # reads what pytest wrote
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.errors import BenchError
from bench.mutation.mutants import Mutant

_PHASE = re.compile(r" \((setup|call|teardown)\)$|\|(setup|run|teardown)$")
_OPTIONS = ("-q", "-m", "not exhaustive")
"""Options of pytest for the tests that judge, which are those of `make test-all`."""
_GRACE_S = 60.0
"""Seconds that a run may take beyond ten times what its tests took before."""
_CONFIG = """\
[run]
parallel = True
relative_files = True
context = ${PYTEST_CURRENT_TEST-}
patch = subprocess
data_file = ${MUTATION_DATA}
source =
"""


@dataclass(frozen=True)
class Verdict:
    """Judgement of the tests about a mutant."""

    mutant: Mutant
    tests: int
    """Tests that judged; none if no test covers the line."""
    killer: str
    """First test that failed, "timeout", or empty if the mutant survived."""


class Coverage:
    """Tests that run each line, and the seconds that each test took."""

    def __init__(self, root: Path, data: Path, report: Path) -> None:
        """Read the coverage of the tests of the checkout ``root``, and the report of their run."""
        from coverage import CoverageData  # only here: the rest of bench does without

        read = CoverageData(str(data))
        read.read()
        self._of_line = {
            (file, line): {test for context in contexts for test in _tests_of(context)}
            for file in read.measured_files()
            for line, contexts in read.contexts_by_lineno(file).items()
        }
        self._root, self._seconds = root, dict(_passed_tests(report))
        self._breadth: dict[str, int] = {}
        for tests in self._of_line.values():
            for test in tests:
                self._breadth[test] = self._breadth.get(test, 0) + 1

    def judges(self, mutant: Mutant, budget_s: float, killer: str) -> list[str]:
        """Return the tests that cover a line, as many as fit in the budget.

        The test that killed the mutant earlier comes first, then those that cover least else. Lines that run at import
        are judged by the tests of the whole file.
        """
        line = mutant.line_in((self._root / mutant.path).read_text(encoding="utf-8"))
        covering = self._of_line.get((mutant.path, line or 0), set())
        if not mutant.in_function:
            covering = {test for (path, _), tests in self._of_line.items() if path == mutant.path for test in tests}
        chosen, used = list[str](), 0.0
        known = covering & self._seconds.keys()
        for test in sorted(known, key=lambda test: (test != killer, self._breadth[test], test)):
            if not chosen or used + self._seconds[test] <= budget_s:
                chosen.append(test)
                used += self._seconds[test]
        return chosen

    def seconds(self, tests: Sequence[str]) -> float:
        """Return the time that tests took, in seconds."""
        return sum(self._seconds[test] for test in tests)

    def forget(self, tests: Iterable[str]) -> None:
        """Let these tests judge no more."""
        for test in tests:
            self._seconds.pop(test, None)


def _tests_of(context: str) -> list[str]:
    return [_PHASE.sub("", part) for part in re.split(r"\|(?!run$|setup$|teardown$)", context) if "::" in part]


def _passed_tests(report: Path) -> list[tuple[str, float]]:
    cases = ET.parse(report).getroot().iter("testcase")  # noqa: S314  # what pytest wrote
    return [
        (f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name')}", float(case.get("time", "0")))
        for case in cases
        if not {child.tag for child in case} & {"skipped", "failure", "error"}
    ]


def record(root: Path, out: Path, folders: Iterable[str]) -> None:
    """Run the default and the slow tests once, and write which lines of the folders each of them runs."""
    out.mkdir(parents=True, exist_ok=True)
    # Coverage removes old data first: every file whose name begins with that of the data and a dot.
    config, data = out / "recording.ini", out / "coverage"
    config.write_text(_CONFIG + "".join(f"    {folder}\n" for folder in folders), encoding="utf-8")
    options = [
        "--cov",
        f"--cov-config={config}",
        "--cov-context=test",
        "--cov-report=",
        f"--junitxml={out / 'junit.xml'}",
    ]
    command = [sys.executable, "-m", "pytest", *_OPTIONS, "-n", "auto", "--dist", "worksteal", *options]
    done = subprocess.run(command, cwd=root, env={**os.environ, "MUTATION_DATA": str(data)}, check=False)  # noqa: S603
    if done.returncode not in (0, 1):  # 1: some tests failed, which do not judge
        raise BenchError(f"the tests were not recorded (exit code {done.returncode}); pip install 'pytest-cov>=7'")


class Workplace:
    """Copy of the checkout in which mutants are judged, one at a time."""

    def __init__(self, root: Path, folder: Path) -> None:
        self._folder = folder
        # Its packages, before the installed ones; the root has this program.
        self._paths = [folder, folder / "rover", folder / "check_launch", root]
        shutil.rmtree(folder, ignore_errors=True)
        for name in _git(root, "ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0")[:-1]:
            source, target = root / name, folder / name
            if source.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(source, target, follow_symlinks=False)
        _git(folder, "init", "--quiet")

    def judge(self, mutant: Mutant, tests: Sequence[str], seconds: float) -> str:
        """Return the first of the tests that fails with the fault, "timeout", or nothing if all pass."""
        file = self._folder / mutant.path
        sound = file.read_text(encoding="utf-8")
        faulty = mutant.apply(sound)
        if faulty is None:
            raise BenchError(f"{mutant.path}:{mutant.line}: the line has changed: {mutant.text.strip()}")
        file.write_text(faulty, encoding="utf-8")
        try:
            failed = self._failed(tests, _GRACE_S + 10 * seconds, "-x")
        finally:
            file.write_text(sound, encoding="utf-8")
        return failed[0] if failed else ""

    def unsound(self, tests: Sequence[str], seconds: float) -> list[str]:
        """Return the tests that fail here without any fault; they cannot judge."""
        return self._failed(tests, _GRACE_S + 10 * seconds)

    def _failed(self, tests: Sequence[str], limit_s: float, *options: str) -> list[str]:
        chosen = self._folder.with_suffix(".tests.json")
        chosen.write_text(json.dumps(tests), encoding="utf-8")
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(map(str, self._paths)),
            "PYTHONDONTWRITEBYTECODE": "1",
            "MUTATION_TESTS": str(chosen),
        }
        files = sorted({test.partition("::")[0] for test in tests})
        plugins = ("-p", "no:cacheprovider", "-p", "bench.mutation.selection")
        with subprocess.Popen(  # noqa: S603  # the tests of this checkout
            [sys.executable, "-m", "pytest", *_OPTIONS, "-rfE", "--no-header", "--tb=no", *plugins, *options, *files],
            cwd=self._folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,  # with the programs that the tests start
        ) as process:
            try:
                said, _ = process.communicate(timeout=limit_s)
            except subprocess.TimeoutExpired:
                return ["timeout"]
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
        if process.returncode == 0:
            return []
        lines = [line.partition(" ")[2] for line in said.splitlines() if line.startswith(("FAILED ", "ERROR "))]
        found = [max((test for test in tests if line.startswith(test)), key=len, default=line) for line in lines]
        return found or [f"exit code {process.returncode}"]


def _git(folder: Path, *words: str) -> str:
    command = ["git", *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout  # noqa: S603
