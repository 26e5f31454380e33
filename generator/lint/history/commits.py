"""Access to all commits and file contents of a git repository; needs git 2.31 or later.

No commit is checked out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from roverlink.generator.git import SUBMODULE, Commit, GitError, Repository, commit_of

# %P lists the parents. %at is the author's time, the date that people know the change by: a rebase changes the
# committer's. %an is the author's name.
_FIELDS = ("%H", "%P", "%at", "%an", "%s")
_LOG = (
    # The user's configuration must not change the output (git-config(1)): log.showRoot=false hides the files of the
    # first commit, log.showSignature adds lines, log.follow follows one file over renames, diff.renames writes two
    # paths in a line.
    *("-c", "log.showRoot=true", "-c", "log.showSignature=false"),
    # --sparse keeps commits that change no .proto file: without them, the graph would fall apart.
    # --exclude works on the next --all only, so it stands before it (git-rev-list(1)). A stash is nobody's published
    # state. --date-order shows no parent before all of its children: reversed, parents come before children.
    *("log", "--exclude=refs/stash", "--all", "--date-order", "--full-history", "--sparse", "--no-follow"),
    # Compare a merge with its first parent only. The commits of its other parents are listed themselves.
    # --raw prints the ids of the blobs, which are the keys of the cache, instead of texts. -z: no path is quoted.
    *("--raw", "--diff-merges=first-parent", "--no-renames", "--no-abbrev", "--no-relative", "-z", "--no-color"),
    *("--encoding=UTF-8", "--no-show-signature", f"--format={'%x00'.join(_FIELDS)}"),
)
_SPECIAL = re.compile(r"[*?\[\\]")  # in a glob
PROTOS = ":(top)*.proto"
"""Pattern (a pathspec of git) for all .proto files of the repository, also those outside the current folder."""

TAGS = "refs/tags/"
"""The beginning of the full names of tags."""


class Edit(NamedTuple):
    """The change of one file by a commit, compared with the commit's first parent."""

    path: str
    """Path of the file, relative to the top of the repository."""
    old: str | None
    """The id of the file's blob before the commit; None if the file did not exist."""
    new: str | None
    was_submodule: bool = False
    """True if the path was a submodule before the commit, and is none after it."""


@dataclass(frozen=True, slots=True)
class Revision:
    """A commit with its parents and the .proto files that it changed; or the index or the working tree of git."""

    id: str
    """Id of the commit; other texts stand for the index and the working tree."""
    commit: Commit
    parents: tuple[str, ...]
    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True)
class Ref:
    """A git ref: a name for a commit."""

    name: str
    """The full name, such as ``refs/heads/main``."""
    commit: str
    target: str
    """The full name of the ref that a symbolic ref points to; empty for other refs."""


class PastRepository(Repository):
    """A folder in a git repository, with access to all commits."""

    def revisions(self, also: Sequence[str] = ()) -> list[Revision]:
        """Return the commits of all refs (branches, tags and others) except stashes, and those of the commits ``also``.

        Parents come before children; otherwise the commits are sorted by time. The edits are those of .proto files, and
        of the submodules in whose place the folder is today.
        """
        words = self._run(*_LOG, *also, "--", PROTOS, *self._folder_itself()).split("\0")
        found, at = [], 0
        while at + len(_FIELDS) <= len(words):
            id, parents, *about = words[at : at + len(_FIELDS)]
            edits, at = edits_at(words, at + len(_FIELDS))
            edits = [edit for edit in edits if edit.was_submodule or edit.path.endswith(".proto")]
            found.append(Revision(id, commit_of(id, *about), tuple(parents.split()), tuple(edits)))
        return found[::-1]

    def _folder_itself(self) -> list[str]:
        """Return patterns for the folder and the folders around it, which do not match the files in them."""
        parts = _SPECIAL.sub(r"\\\g<0>", self.prefix()).split("/")[:-1]
        # A pathspec without a wildcard matches everything in a folder. In a glob, no `*` matches a slash
        # (gitglossary(7), pathspec).
        return [f":(top,glob){'/'.join(parts[:end])}*" for end in range(1, len(parts) + 1)]

    def refs(self) -> list[Ref]:
        """Return all refs with their commits, sorted by name. If HEAD is on no branch, HEAD comes first."""
        # `*objectname` is the object that an annotated tag points to (git-for-each-ref(1)).
        output = self._run("for-each-ref", "--format=%(refname)%00%(objectname)%00%(*objectname)%00%(symref)")
        fields = [line.split("\0") for line in output.splitlines()]
        refs = [Ref(name, peeled or id, target) for name, id, peeled, target in fields]
        try:
            head = self.resolve("HEAD")
        except GitError:
            return refs  # the current branch has no commit
        branches = {ref.commit for ref in refs if ref.name.startswith(("refs/heads/", "refs/remotes/"))}
        return refs if head in branches else [Ref("HEAD", head, ""), *refs]

    def boundary(self) -> frozenset[str]:
        """Return the ids of the commits in a shallow clone whose parents are missing; empty for a full clone."""
        if self._run("rev-parse", "--is-shallow-repository").strip() != "true":
            return frozenset()
        # The file lists the commits whose parents the clone lacks. In a linked worktree it is in the main repository's
        # folder, which --git-path knows.
        file = self.folder / self._run("rev-parse", "--git-path", "shallow").strip()
        return frozenset(file.read_text(encoding="ascii").split())


def edits_at(words: Sequence[str], at: int) -> tuple[list[Edit], int]:
    """Return the edits in git's output from the position ``at`` on, and the position after them.

    ``words`` is the output of a diff with the options ``--raw -z``, split at NUL.
    """
    edits = []
    # A raw line is `:<old mode> <new mode> <old id> <new id> <status>`, then NUL and the path (git-diff(1), RAW OUTPUT
    # FORMAT). In a log, git puts a line feed between the commit's format and the first of them.
    while at + 1 < len(words) and words[at].lstrip("\n").startswith(":"):
        edits.append(_edit(words[at].lstrip("\n"), words[at + 1]))
        at += 2
    return edits, at


def _edit(what: str, path: str) -> Edit:
    old_mode, new_mode, old, new = what[1:].split()[:4]
    was_submodule = old_mode == SUBMODULE and new_mode != SUBMODULE
    return Edit(path, old if _is_file(old_mode) else None, new if _is_file(new_mode) else None, was_submodule)


def _is_file(mode: str) -> bool:
    """Return True if a mode of git, such as ``100644``, means a regular file.

    A link, a submodule and a deleted file have other modes.
    """
    return mode.startswith("100")
