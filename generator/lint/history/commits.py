"""A repository with its whole past, read in a few runs of git (2.31 or later), whatever its size.

Nothing is checked out. Where blobs were left out of a clone, git fetches those that are asked for.
"""

from __future__ import annotations

import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from roverlink.generator.git import Commit, GitError, Repository, commit_of, environment

_FIELDS = ("%H", "%P", "%ct", "%at", "%s")
_LOG = (
    *("-c", "log.showRoot=true", "-c", "log.showSignature=false"),
    # All of the commits, also those that change no .proto file, since they tie the others together.
    *("log", "--exclude=refs/stash", "--all", "--date-order", "--full-history", "--sparse", "--no-follow"),
    # What a merge changes is asked against its first parent; what its other parents have is known from their own past.
    *("--raw", "--diff-merges=first-parent", "--no-renames", "--no-abbrev", "--relative", "-z", "--no-color"),
    *("--encoding=UTF-8", "--no-show-signature", f"--format={'%x00'.join(_FIELDS)}", "--", "*.proto"),
)
_BATCH = 256  # ids that git is asked for at once; they fit into a pipe with room to spare
_LARGEST = 4_194_304  # bytes of a file that somebody may have written


@dataclass(frozen=True, slots=True)
class Edit:
    """What a commit did to one file, seen from its first parent."""

    path: str
    old: str | None
    """The blob that was there; None if there was none."""
    new: str | None


@dataclass(frozen=True, slots=True)
class Revision:
    """A commit with its place in history."""

    commit: Commit
    parents: tuple[str, ...]
    time: int
    """When it was committed, in seconds."""
    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True)
class Ref:
    """A name for a commit."""

    name: str
    """In full: ``refs/heads/main``."""
    commit: str
    target: str
    """The ref that it stands for; empty if it stands for itself."""


class PastRepository(Repository):
    """A folder within a git repository, with its past."""

    def revisions(self) -> list[Revision]:
        """All commits that any ref leads to, parents before children, else by time; a stash is nobody's history."""
        words = self._run(*_LOG).split("\0")
        found, at = [], 0
        while at + len(_FIELDS) <= len(words):
            id, parents, time, written, subject = words[at : at + len(_FIELDS)]
            at += len(_FIELDS)
            edits = []
            while at + 1 < len(words) and words[at].lstrip("\n").startswith(":"):
                edits.append(_edit(words[at].lstrip("\n"), words[at + 1]))
                at += 2
            commit = commit_of(id, written, subject)
            found.append(Revision(commit, tuple(parents.split()), int(time), tuple(edits)))
        return found[::-1]

    def refs(self) -> list[Ref]:
        """The refs that lead to commits, sorted; HEAD among them where it is on no branch."""
        said = self._run("for-each-ref", "--format=%(refname)%00%(objectname)%00%(*objectname)%00%(symref)")
        fields = [line.split("\0") for line in said.splitlines()]
        refs = [Ref(name, peeled or id, target) for name, id, peeled, target in fields]
        try:
            head = self.resolve("HEAD")
        except GitError:
            return refs  # nothing is committed on the current branch
        branches = {ref.commit for ref in refs if ref.name.startswith(("refs/heads/", "refs/remotes/"))}
        return refs if head in branches else [Ref("HEAD", head, ""), *refs]

    def boundary(self) -> frozenset[str]:
        """The commits at which a shallow clone ends; empty for a full one."""
        if self._run("rev-parse", "--is-shallow-repository").strip() != "true":
            return frozenset()
        file = self.folder / self._run("rev-parse", "--git-path", "shallow").strip()
        return frozenset(file.read_text(encoding="ascii").split())

    def blobs(self, ids: Sequence[str]) -> Iterator[tuple[str, bytes | None]]:
        """The contents of blobs, in their order; None for one that is not there, or is too large to be looked at."""
        if not ids:
            return
        command = ["git", "-C", str(self.folder), "cat-file", "--batch"]
        try:
            git = subprocess.Popen(  # noqa: S603  # no shell
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment()
            )
        except OSError as error:
            raise GitError(f"git cannot be run: {error.strerror}") from error
        with git:
            left = iter(ids)
            while batch := list(islice(left, _BATCH)):
                yield from _answers(git, batch)


def _answers(git: subprocess.Popen[bytes], ids: Sequence[str]) -> Iterator[tuple[str, bytes | None]]:
    assert git.stdin is not None, "it was asked for"  # noqa: S101  # for mypy
    assert git.stdout is not None, "it was asked for"  # noqa: S101  # for mypy
    try:
        git.stdin.write("".join(f"{id}\n" for id in ids).encode("ascii"))
        git.stdin.flush()
    except BrokenPipeError as error:
        raise GitError("git cat-file ended early") from error
    for id in ids:
        head = git.stdout.readline().split()
        if not head:
            raise GitError("git cat-file ended early")
        if len(head) < 3:  # "missing"
            yield id, None
            continue
        data = git.stdout.read(int(head[2]) + 1)[:-1]
        yield id, data if len(data) <= _LARGEST and head[1] == b"blob" else None


def _edit(what: str, path: str) -> Edit:
    old_mode, new_mode, old, new = what[1:].split()[:4]
    return Edit(path, old if _is_file(old_mode) else None, new if _is_file(new_mode) else None)


def _is_file(mode: str) -> bool:
    """Whether a mode is that of a regular file, and neither of nothing, of a link, nor of a submodule."""
    return mode.startswith("100")
