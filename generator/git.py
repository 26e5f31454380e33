"""Access to a git repository through the ``git`` program.

- Inside a git hook, the variable ``GIT_DIR`` overrides the folder that is passed to git. Such variables are removed.
- ``git ls-tree`` lists links and submodules too; only the modes 100644 and 100755 are files.
- A clone may lack objects (``--depth``, ``--filter``); reading them raises `GitError`.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from pathlib import Path

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
# git sets these variables for a hook (githooks(5)). They select the hook's repository; the folder may be in another.
_OF_A_HOOK = ("GIT_DIR", "GIT_WORK_TREE", "GIT_COMMON_DIR", "GIT_INDEX_FILE", "GIT_PREFIX")
_FILES = ("100644", "100755")  # modes of regular files; a link has 120000, a submodule 160000


class GitError(Exception):
    """Raised when git is not installed or reports an error; the text is git's error message."""


@dataclass(frozen=True, slots=True)
class Commit:
    """Id, date and subject of a commit, which diagnostics show."""

    id: str
    date: str
    """The author's date, such as ``2026-11-21``."""
    subject: str

    def __str__(self) -> str:
        return f"{self.id[:10]} {self.date} {self.subject}" if self.id else self.subject


UNCOMMITTED = Commit("", "", "a change that is not committed yet")
"""Stands in place of the commit for a change that only the index or the working tree has."""


@dataclass(frozen=True, slots=True)
class Repository:
    """A folder in a git repository. All paths that the methods take or return are relative to this folder."""

    folder: Path

    def exists(self) -> bool:
        """Return True if the folder is in a git repository, even if the repository has no commits."""
        try:
            self._run("rev-parse", "--git-dir")
        except GitError:
            return False
        return True

    def has(self, ref: str, path: str) -> bool:
        """Return True if a file exists in a commit. The ref may be a commit id, a branch or a tag."""
        try:
            self._run("cat-file", "-e", f"{ref}:./{path}")
        except GitError:
            return False
        return True

    def names(self) -> set[str]:
        """Return the names by which other projects may know the repository.

        These are the name of its folder, and the last part of each remote's address: ``rover`` for ``.../rover.git``.
        """
        folder = (self.folder / self._run("rev-parse", "--git-common-dir").strip()).resolve()
        remotes = [line.split()[1] for line in self._run("remote", "--verbose").splitlines()]
        addresses = [str(folder).removesuffix("/.git"), *remotes]
        return {name_of_repository(address) for address in addresses}

    def resolve(self, ref: str) -> str:
        """Return the full id of the commit that a ref names. Raises `GitError` if the ref names none."""
        # A ref may come from the command line. After --end-of-options git takes `-x` as a ref, not as an option
        # (gitcli(7)). `^{commit}` peels an annotated tag, and refuses a blob or a tree (gitrevisions(7)).
        return self._run("rev-parse", "--verify", "--quiet", "--end-of-options", f"{ref}^{{commit}}").strip()

    def commit(self, ref: str) -> Commit:
        """Return the commit that a ref names. Raises `GitError` if the ref names none."""
        # NUL, which no subject can contain, separates the fields. `%at` is the author's time: a rebase changes the
        # committer's.
        said = self._run("show", "--no-patch", "--format=%H%x00%at%x00%s", self.resolve(ref)).rstrip("\n")
        id, seconds, subject = said.split("\0")
        return commit_of(id, seconds, subject)

    def reachable(self, commit: str) -> frozenset[str]:
        """Return the ids of a commit and of all its ancestors, as far as the clone contains them."""
        return frozenset(self._run("rev-list", commit).split())

    def entries(self, commit: str) -> list[tuple[str, str, str]]:
        """Return mode, object id and path of each file, link and submodule below the folder in a commit."""
        # -z: without it, git quotes a path with unusual characters (git-ls-tree(1), OUTPUT FORMAT).
        listed = self._run("ls-tree", "-r", "-z", "--full-name", commit, ".").split("\0")
        prefix = self._run("rev-parse", "--show-prefix").strip()
        entries = (entry.split("\t", 1) for entry in listed if entry)
        return [(about.split()[0], about.split()[2], path.removeprefix(prefix)) for about, path in entries]

    def files(self, commit: str) -> list[str]:
        """Return the paths of the files below the folder in a commit, without links and submodules."""
        return [path for mode, _, path in self.entries(commit) if mode in _FILES]

    def contents(self, commit: str, paths: Iterable[str]) -> Iterator[tuple[str, bytes]]:
        """Yield path and content of the given files in a commit.

        Raises `GitError` if the clone does not contain a file.
        """
        paths = list(paths)
        # One process for all files: starting git once per file would cost more than reading it. A path with `./` in
        # front is relative to the current folder, others to the top of the repository (gitrevisions(7)).
        asked = "".join(f"{commit}:./{path}\n" for path in paths)
        # The answer to each line is `<id> <type> <size> LF <content> LF`, or `<what was asked> missing LF`
        # (git-cat-file(1), BATCH OUTPUT). A content may contain line feeds, so only the size tells where it ends.
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

    def commits_of_lines(self, path: str, commit: str | None = None) -> list[Commit | None]:
        """Return the commit that last changed each line of a file.

        ``commit`` selects an earlier state of the file. A line is None if its change is uncommitted. The list is empty
        if git cannot tell.
        """
        try:
            # A .gitattributes of a stranger must not select a program of the user's configuration (gitattributes(5)).
            said = self._run("blame", "--no-textconv", "--porcelain", *([commit] if commit else []), "--", path)
        except GitError:
            return []
        # Each line of the file has a head, which begins with the commit's id; then, where the commit is named for the
        # first time, lines that begin with a keyword; and a tab with the content (git-blame(1), THE PORCELAIN FORMAT).
        # The id of a line that is not committed yet consists of zeros.
        found: list[Commit | None] = []
        known: dict[str, Commit | None] = {}
        id, facts = "", dict[str, str]()
        for line in said.split("\n"):
            if line.startswith("\t"):
                if id not in known:
                    committed = id.strip("0") and "summary" in facts
                    known[id] = commit_of(id, facts["author-time"], facts["summary"]) if committed else None
                found.append(known[id])
                id, facts = "", {}
            elif not id:
                id = line.partition(" ")[0]
            else:
                keyword, _, value = line.partition(" ")
                facts[keyword] = value
        return found

    def _run(self, *arguments: str, index: str = "") -> str:
        return self._run_bytes(*arguments, index=index).decode("utf-8", errors="replace")

    def _run_bytes(self, *arguments: str, input: bytes = b"", index: str = "") -> bytes:
        """Return what git prints. ``index`` is the path of another index file than the usual one."""
        variables = environment() | ({"GIT_INDEX_FILE": index} if index else {})
        try:
            done = subprocess.run(  # noqa: S603  # no shell
                command(self.folder, *arguments), input=input, capture_output=True, check=False, env=variables
            )
        except OSError as error:
            raise GitError(f"git cannot be run: {error.strerror}") from error
        if done.returncode:
            raise GitError(done.stderr.decode("utf-8", errors="replace").strip())
        return done.stdout


def command(folder: Path, *arguments: str) -> list[str]:
    """Return the command line that runs git in a folder."""
    # Files of a pull request can form a bare repository: HEAD, config, objects, refs. Without the option, git would use
    # that repository, and its config can name programs to run (git-config(1), safe.bareRepository; git 2.38 or later).
    return ["git", "-c", "safe.bareRepository=explicit", "-C", str(folder), *arguments]


def commit_of_line(commits: Sequence[Commit | None], line: int) -> Commit | None:
    """Return the commit of a line, which counts from 1, from the commits of all lines; None if it is not known."""
    return commits[line - 1] if 0 < line <= len(commits) else None


def name_of_repository(address: str) -> str:
    """Return the name of a repository: the last part of its address (a URL or a folder) without ``.git``."""
    return re.split(r"[/:]", address.rstrip("/"))[-1].removesuffix(".git")


def environment() -> dict[str, str]:
    """Return the environment variables for git, without those that git sets when it runs a hook."""
    return {name: value for name, value in os.environ.items() if name not in _OF_A_HOOK}


def commit_of(id: str, seconds: str, subject: str) -> Commit:
    """Return a commit, given its id, the author's time in seconds since 1970, and its subject.

    Unprintable characters of the subject are replaced: a terminal might obey them, and XML forbids some.
    """
    return Commit(id, _date_of(seconds), "".join(letter if letter.isprintable() else "\ufffd" for letter in subject))


def _date_of(seconds: str) -> str:
    """Return the date of a Unix time as ``2026-11-21``; empty if Python cannot represent the date."""
    try:
        return (_EPOCH + timedelta(seconds=int(seconds))).date().isoformat()
    except (ValueError, OverflowError):
        return ""
