"""What git knows of a repository, asked through its own program."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from pathlib import Path

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
# What a hook of git's is told of the repository that it runs in; the folder may be in another one.
_OF_A_HOOK = ("GIT_DIR", "GIT_WORK_TREE", "GIT_COMMON_DIR", "GIT_INDEX_FILE", "GIT_PREFIX")
_FILES = ("100644", "100755")  # the modes of files in a tree; there are links and submodules, too


class GitError(Exception):
    """git is not there, or says no; the text is its own."""


@dataclass(frozen=True, slots=True)
class Commit:
    """A commit, as a finding names it."""

    id: str
    date: str
    """Of its author, as ``2026-11-21``."""
    subject: str

    def __str__(self) -> str:
        return f"{self.id[:10]} {self.date} {self.subject}"


@dataclass(frozen=True, slots=True)
class Repository:
    """A folder within a git repository, from which paths are counted."""

    folder: Path

    def exists(self) -> bool:
        """Whether the folder is in a repository, be it one without a commit, that git can read."""
        try:
            self._run("rev-parse", "--git-dir")
        except GitError:
            return False
        return True

    def has(self, ref: str, path: str) -> bool:
        """Whether a commit has a file."""
        try:
            self._run("cat-file", "-e", f"{ref}:./{path}")
        except GitError:
            return False
        return True

    def called(self) -> set[str]:
        """What others may call the repository: its folder's name, and those that its remotes' addresses end with."""
        folder = (self.folder / self._run("rev-parse", "--git-common-dir").strip()).resolve()
        remotes = [line.split()[1] for line in self._run("remote", "--verbose").splitlines()]
        addresses = [str(folder).removesuffix("/.git"), *remotes]
        return {name_of_repository(address) for address in addresses}

    def resolve(self, ref: str) -> str:
        """The commit that a ref names. Raises `GitError` where it names none."""
        return self._run("rev-parse", "--verify", "--quiet", "--end-of-options", f"{ref}^{{commit}}").strip()

    def commit(self, ref: str) -> Commit:
        """The commit that a ref names. Raises `GitError` where it names none."""
        said = self._run("show", "--no-patch", "--format=%H%x00%at%x00%s", self.resolve(ref)).rstrip("\n")
        id, seconds, subject = said.split("\0")
        return commit_of(id, seconds, subject)

    def entries(self, commit: str) -> list[tuple[str, str, str]]:
        """Mode, object and path of all that stands below the folder in a commit; paths are relative to the folder."""
        listed = self._run("ls-tree", "-r", "-z", "--full-name", commit, ".").split("\0")
        prefix = self._run("rev-parse", "--show-prefix").strip()
        entries = (entry.split("\t", 1) for entry in listed if entry)
        return [(about.split()[0], about.split()[2], path.removeprefix(prefix)) for about, path in entries]

    def files(self, commit: str) -> list[str]:
        """The files below the folder in a commit, relative to it; links and submodules are not among them."""
        return [path for mode, _, path in self.entries(commit) if mode in _FILES]

    def contents(self, commit: str, paths: Iterable[str]) -> Iterator[tuple[str, bytes]]:
        """The bytes of files in a commit. Raises `GitError` where the clone does not have them."""
        paths = list(paths)
        asked = "".join(f"{commit}:./{path}\n" for path in paths)
        answer = self._run_bytes("cat-file", "--batch", input=asked.encode())
        position = 0
        for path in paths:
            head_end = answer.index(b"\n", position)
            about = answer[position:head_end].split()
            if about[-1] == b"missing":
                raise GitError(f"{path} is not in this clone")
            size = int(about[2])
            yield path, answer[head_end + 1 : head_end + 1 + size]
            position = head_end + 1 + size + 1

    def commit_of_line(self, path: str, line: int, commit: str | None = None) -> Commit | None:
        """The commit from which a line of a file is; None where it is not committed yet, or git does not say."""
        try:
            said = self._run("blame", "--porcelain", f"-L{line},{line}", *([commit] if commit else []), "--", path)
        except GitError:
            return None
        id, facts = said.split(None, 1)[0], dict(entry.partition(" ")[::2] for entry in said.splitlines()[1:])
        if not id.strip("0") or "summary" not in facts:
            return None
        return commit_of(id, facts["author-time"], facts["summary"])

    def _run(self, *arguments: str) -> str:
        return self._run_bytes(*arguments).decode("utf-8", errors="replace")

    def _run_bytes(self, *arguments: str, input: bytes = b"") -> bytes:
        command = ["git", "-C", str(self.folder), *arguments]
        try:
            done = subprocess.run(  # noqa: S603  # no shell
                command, input=input, capture_output=True, check=False, env=environment()
            )
        except OSError as error:
            raise GitError(f"git cannot be run: {error.strerror}") from error
        if done.returncode:
            raise GitError(done.stderr.decode("utf-8", errors="replace").strip())
        return done.stdout


def name_of_repository(address: str) -> str:
    """The name that the address of a repository ends with, be it a URL or a folder."""
    return re.split(r"[/:]", address.rstrip("/"))[-1].removesuffix(".git")


def environment() -> dict[str, str]:
    """The environment in which git finds the repository of the folder that it is asked about, also within a hook."""
    return {name: value for name, value in os.environ.items() if name not in _OF_A_HOOK}


def commit_of(id: str, seconds: str, subject: str) -> Commit:
    """A commit as git tells of it, without what a terminal would obey, or XML cannot hold."""
    return Commit(id, _date_of(seconds), "".join(letter if letter.isprintable() else "\ufffd" for letter in subject))


def _date_of(seconds: str) -> str:
    """The date of a time; empty where somebody's clock made it one that no calendar has."""
    try:
        return (_EPOCH + timedelta(seconds=int(seconds))).date().isoformat()
    except (ValueError, OverflowError):
        return ""
