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
            git(self.root, "reset", "--quiet", "--hard")
        return self.root


def git(root: Path, *arguments: str, input: bytes = b"") -> str:
    """What git says, whatever the user's settings are."""
    env = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    env |= {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    done = subprocess.run(["git", "-C", str(root), *arguments], input=input, capture_output=True, env=env)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout.decode()
