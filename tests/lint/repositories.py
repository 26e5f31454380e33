"""Git repositories made up for tests, through ``git fast-import``: thousands of commits in no time, always the same."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

_FIRST = 1_770_000_000  # 2026-02-02
_DAY = 86_400

_ENVELOPE = """\
syntax = "proto3";

message PBEnvelope {{
  oneof payload {{
{members}
  }}
}}
"""


def envelope(*members: str) -> str:
    """An envelope, of members such as ``Imu imu = 1;``, or of any other lines."""
    return _ENVELOPE.format(members="\n".join(f"    {member}" for member in members))


def message(name: str, *fields: str) -> str:
    """A message in a file of its own, of fields such as ``float x``, numbered from 1 if they have no number."""
    numbered = (one if "=" in one else f"{one} = {number};" for number, one in enumerate(fields, 1))
    lines = "\n".join(f"  {one}" for one in numbered)
    return f'syntax = "proto3";\n\nmessage {name} {{\n{lines}\n}}\n'


PAYLOADS = {
    "imu.proto": message("Imu", "float accel_x", "float accel_y", "float accel_z"),
    "gps.proto": message("Gps", "double latitude", "double longitude", "uint32 satellites"),
    "ph.proto": message("Ph", "float acidity", "bool calibrated"),
    "load.proto": message("LoadCell", "int32 ticks", "string unit_name", "bytes raw"),
}
ENVELOPE_FILE = "components/common/envelope.proto"
_MEMBERS = {"I": "Imu imu", "G": "Gps gps", "P": "Ph ph", "L": "LoadCell load_cell"}


def members(text: str) -> list[str]:
    """Members of the envelope, such as ``I1 G2`` for ``Imu imu = 1;`` and ``Gps gps = 2;``."""
    return [f"{_MEMBERS[word[0]]} = {word[1:]};" for word in text.split()]


@dataclass
class RepositoryBuilder:
    """A repository that grows by commits, each a day after the one before it. Commits are called by their marks."""

    root: Path
    _stream: list[bytes] = field(default_factory=list)
    _heads: dict[str, int] = field(default_factory=dict)
    _mark: int = 0

    def commit(
        self,
        subject: str,
        files: Mapping[str, str | None] | None = None,
        *,
        branch: str = "main",
        parents: Sequence[int] | None = None,
    ) -> int:
        """A commit with these files changed, or deleted where they are None; the others are its first parent's.

        It is put on top of its branch, or on other parents. Returns its mark.
        """
        self._mark += 1
        when = f"A B <a@example.com> {_FIRST + self._mark * _DAY} +0000"
        head = self._heads.get(branch)
        parents = parents if parents is not None else [head] if head else []
        lines = [] if parents else [f"reset refs/heads/{branch}"]
        lines += [f"commit refs/heads/{branch}", f"mark :{self._mark}", f"author {when}", f"committer {when}"]
        self._stream.append("\n".join([*lines, f"data {len(subject.encode())}", subject]).encode())
        self._stream += [f"{'merge' if index else 'from'} :{mark}".encode() for index, mark in enumerate(parents)]
        for path, text in (files or {}).items():
            if text is None:
                self._stream.append(f"D {path}".encode())
            else:
                data = text.encode("utf-8", "surrogateescape")
                self._stream.append(f"M 100644 inline {path}\ndata {len(data)}\n".encode() + data)
        self._heads[branch] = self._mark
        return self._mark

    def commits(self, *states: Mapping[str, str | None]) -> RepositoryBuilder:
        """Commit changes of files one after the other, with the subjects 0, 1, ...; the repository itself."""
        for number, files in enumerate(states):
            self.commit(str(number), files)
        return self

    def play(self, history: str) -> dict[str, int]:
        """Commit states of the envelope, such as ``a: I1 / b: I1 G2 / c on a: I1 / d on b c: I1 G2``.

        Each commit is on top of the one before it if no others are named. The last one is the branch main. Others that
        nothing is built upon are branches of their own names. Returns the marks by the names of the commits.
        """
        marks: dict[str, int] = {}
        built_upon: set[str] = set()
        for step in history.split(" / "):
            head, _, text = step.partition(":")
            name, _, given = head.strip().partition(" on ")
            parents = given.split() or list(marks)[-1:]
            files = {ENVELOPE_FILE: envelope(*members(text)), **({} if marks else PAYLOADS)}
            marks[name] = self.commit(name, files, branch=name, parents=[marks[parent] for parent in parents])
            built_upon |= set(parents)
        self.branch("main")
        for merged in (*built_upon, name):
            self.delete_branch(merged)
        return marks

    def branch(self, name: str, mark: int | None = None) -> None:
        """A branch that begins at a commit: the last one, if none is given."""
        self._ref(f"refs/heads/{name}", mark)
        self._heads[name] = mark or self._mark

    def remote_branch(self, name: str, mark: int | None = None) -> None:
        """A branch of the remote ``origin``, as it is known here."""
        self._ref(f"refs/remotes/origin/{name}", mark)

    def _ref(self, name: str, mark: int | None) -> None:
        self._stream.append(f"reset {name}\nfrom :{mark or self._mark}\n".encode())

    def delete_branch(self, name: str) -> None:
        """Take the name of a branch away, as one does when it is merged."""
        self._stream.append(f"reset refs/heads/{name}\nfrom {'0' * 40}\n".encode())

    def write(self) -> Path:
        """Write the repository, and check out its branch main; the folder that it is in."""
        self.root.mkdir(parents=True, exist_ok=True)
        git(self.root, "init", "--quiet", "--initial-branch", "main")
        git(self.root, "fast-import", "--quiet", "--force", input=b"\n".join([*self._stream, b"done\n"]))
        if "main" in self._heads:
            git(self.root, "checkout", "--quiet", "--force", "main")
        return self.root


def git(root: Path, *arguments: str, input: bytes = b"") -> str:
    """What git says, whatever the user's settings are."""
    env = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    env |= {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    done = subprocess.run(["git", "-C", str(root), *arguments], input=input, capture_output=True, env=env)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout.decode()
