"""Golden histories, the files below `histories/`: small repositories, each with the verdict that its history deserves.

`case_file` describes the format of the files. The comment gives the reason for the verdict. A section `COMMIT/PATH` is
a file as a commit leaves it; one without content is deleted. Two states come after the last commit: `staged/PATH` is
written and added to the index, `working/PATH` is written to the working tree only.

Lines of the comment:

- `run:` is the command line. Without it, it is `lint --history protos`.
- `suite: slow` is for a variant of another history, which only the slow suite plays.
- `commits:` is followed by one line for each commit: `NAME`, `NAME on BRANCH` or `NAME on BRANCH merging OTHER`. A
  branch begins at the latest commit of main. Without it, the commits are on main, in the order of the sections.

The section `expected/verdict` has one line for each number with a finding: `SEVERITY TYPE NUMBER`, without hints. The
section `expected/says` has texts that exactly one other finding contains; `{commit NAME}` is the id of a commit.
There may be no other findings. A verdict follows from the rules that users read, never from what the lint prints today.
"""

from __future__ import annotations

import re
from pathlib import Path

from case_file import CaseFile
from repositories import RepositoryBuilder, git

_UNCOMMITTED = ("staged", "working")
_STEP = re.compile(r"(?P<name>\S+)(?: on (?P<branch>\S+))?(?: merging (?P<other>\S+))?")


class GoldenHistory(CaseFile):
    """A history in a file, with its verdict."""

    @property
    def command(self) -> list[str]:
        """Arguments of `roverlink` that ask for the verdict."""
        given = re.search(r"^run: (.+)$", self._comment, re.MULTILINE)
        return (given[1] if given else "lint --history protos").split()

    @property
    def slow(self) -> bool:
        """True for a history that only the slow suite plays."""
        return re.search(r"^suite: slow$", self._comment, re.MULTILINE) is not None

    @property
    def verdict(self) -> set[str]:
        """Numbers that have a finding, as `SEVERITY TYPE NUMBER`."""
        return set(self._sections["expected/verdict"].decode().splitlines())

    def says(self, commits: dict[str, str]) -> list[str]:
        """Return the texts of findings that are about no number; `commits` has the id of each commit by name."""
        said = self._sections.get("expected/says", b"").decode().splitlines()
        return [re.sub(r"\{commit (\S+)\}", lambda match: commits[match[1]], line) for line in said]

    def write(self, folder: Path) -> Path:
        """Play the history into a repository, and return the folder of its working tree."""
        repository = RepositoryBuilder(folder)
        marks: dict[str, int] = {}
        for step in self._steps:
            branch, other = step["branch"] or "main", step["other"]
            if branch not in marks and "main" in marks:
                repository.branch(branch, marks["main"])
            parents = [marks[branch], marks[other]] if other else None
            files = {path: text or None for path, text in self._files(step["name"]).items()}
            marks[branch] = repository.commit(step["name"], files, branch=branch, parents=parents)
        repository.write()
        git(folder, "checkout", "--quiet", "--force", "main")
        for state in _UNCOMMITTED:
            self._leave_uncommitted(folder, state)
        return folder

    @property
    def _steps(self) -> list[re.Match[str]]:
        _, _, given = self._comment.partition("commits:\n")
        states = dict.fromkeys(name.partition("/")[0] for name in self._sections)
        lines = given.splitlines() or [name for name in states if name not in (*_UNCOMMITTED, "expected")]
        return [match for line in lines if (match := _STEP.fullmatch(line.strip()))]

    def _files(self, state: str) -> dict[str, str]:
        prefix = f"{state}/"
        return {
            name.removeprefix(prefix): content.decode("utf-8", "surrogateescape")
            for name, content in self._sections.items()
            if name.startswith(prefix)
        }

    def _leave_uncommitted(self, folder: Path, state: str) -> None:
        for path, text in self._files(state).items():
            file = folder / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(text.encode("utf-8", "surrogateescape")) if text else file.unlink()
        if state == "staged":
            git(folder, "add", "--all")


def golden_histories() -> list[GoldenHistory]:
    """Read all golden histories, sorted by name."""
    return [GoldenHistory(path) for path in sorted((Path(__file__).parent / "histories").glob("*.txtar"))]
