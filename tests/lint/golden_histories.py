"""Golden histories, the files below `histories/`: small repositories, each with the verdict that its history deserves.

A file holds a family: its `histories` by name, and what all of them have in common. Keys of a history:

- `why` gives the reason for the verdict.
- `run` is the command line; without it, it is the family's, or `lint --history protos`.
- `verdict` has the numbers with a finding, as `SEVERITY TYPE NUMBER`, joined by commas; hints are left out.
- `says` has texts that exactly one other finding contains. There may be no other findings.
- `pins` has the lines of `pins.txt` in the working tree, joined by commas; without it, they are the family's.
- Each other key is a commit with the files that it changes: `NAME`, `NAME on BRANCH` or `NAME on BRANCH merging OTHER`.
  A branch begins at the latest commit of main. Two states may follow the last commit: `staged` is written and added to
  the index, `working` is written to the working tree only.

The files of a state are texts by path, as `folded` describes them, null for a file that is deleted; a path without a
dot is that of a .proto file in `protos/`. A text alone is `protos/arm.proto`. The family's `first` are files of the
first commit, unless it has them itself. A verdict follows from the rules that users read, never from what the lint
prints today.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from folded import unfold
from repositories import RepositoryBuilder, git

_UNCOMMITTED = ("staged", "working")
_NO_COMMITS = {"why", "run", "verdict", "says", "pins", *_UNCOMMITTED}
_STEP = re.compile(r"(?P<name>\S+)(?: on (?P<branch>\S+))?(?: merging (?P<other>\S+))?")

Files = dict[str, str | None]


@dataclass(frozen=True)
class GoldenHistory:
    """A history in a file, with its verdict."""

    name: str
    family: dict[str, Any]
    entry: dict[str, Any]

    @property
    def command(self) -> list[str]:
        """Arguments of `roverlink` that ask for the verdict."""
        return str(self.entry.get("run", self.family.get("run", "lint --history protos"))).split()

    @property
    def verdict(self) -> set[str]:
        """Numbers that have a finding, as `SEVERITY TYPE NUMBER`."""
        return set(filter(None, self.entry.get("verdict", "").split(", ")))

    @property
    def says(self) -> list[str]:
        """Texts of findings that are about no number."""
        return list(self.entry.get("says", []))

    def write(self, folder: Path) -> Path:
        """Play the history into a repository, and return the folder of its working tree."""
        repository = RepositoryBuilder(folder)
        marks: dict[str, int] = {}
        files = _files(self.family.get("first"))
        for commit in filter(lambda key: key not in _NO_COMMITS, self.entry):
            step = _STEP.fullmatch(commit)
            assert step, commit
            branch, other = step["branch"] or "main", step["other"]
            if branch not in marks and "main" in marks:
                repository.branch(branch, marks["main"])
            parents = [marks[branch], marks[other]] if other else None
            files |= _files(self.entry[commit])
            marks[branch] = repository.commit(step["name"], files, branch=branch, parents=parents)
            files = {}
        repository.write()
        for state in _UNCOMMITTED:
            for path, text in _files(self.entry.get(state)).items():
                _leave(folder / path, text)
            if state == "staged" and state in self.entry:
                git(folder, "add", "--all")
        if pins := self.entry.get("pins", self.family.get("pins")):
            _leave(folder / "pins.txt", "".join(f"{pin}\n" for pin in pins.split(", ")))
        return folder


def _files(state: str | Files | None) -> Files:
    files = {"arm": state} if isinstance(state, str) else state or {}
    named = {path if "." in path else f"protos/{path}.proto": text for path, text in files.items()}
    return {path: text and unfold(text) if path.endswith(".proto") else text for path, text in named.items()}


def _leave(file: Path, text: str | None) -> None:
    if text is None:
        file.unlink()
    else:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(text.encode("utf-8", "surrogateescape"))


def _family(text: str) -> Any:
    # libyaml, ten times as fast, knows no byte that is no UTF-8
    return yaml.load(text, yaml.SafeLoader if r"\udc" in text else yaml.CSafeLoader)  # noqa: S506  # both are safe


def golden_histories() -> list[GoldenHistory]:
    """Read all golden histories, sorted by family."""
    families = sorted((Path(__file__).parent / "histories").glob("*.yaml"))
    return [
        GoldenHistory(f"{file.stem}_{name}", family, entry)
        for file in families
        for family in [_family(file.read_text(encoding="utf-8"))]
        for name, entry in family["histories"].items()
    ]
