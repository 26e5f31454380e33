"""States of the .proto files that are not committed yet: git's index, and the working tree.

The history treats them as two more commits on top of the checked-out one: first the index, then the working tree. So a
reuse of a number is found before the commit. In a hook of ``git commit``, the index is the newest state: it is what
the commit will contain.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha1
from pathlib import Path

from roverlink.generator import source_files
from roverlink.generator.git import Commit, GitError, Repository
from roverlink.generator.lint.history.commits import PROTOS, Edit, Revision, edits_at

_INDEX, _WORKING_TREE = "the index", "the working tree"
UNCOMMITTED = frozenset({_INDEX, _WORKING_TREE})
"""The ids of the revisions that stand for the index and the working tree."""
_DIFF = ("--raw", "-z", "--no-abbrev", "--no-renames", "--no-relative")


@dataclass(frozen=True, slots=True)
class Uncommitted:
    """The states that are not committed yet, as revisions without a commit, the newest last."""

    revisions: tuple[Revision, ...] = ()
    contents: Mapping[str, bytes | None] = field(default_factory=dict)
    """Contents of the files that only the working tree has, by the blob ids in the revisions.

    The content of a file that cannot be read is None.
    """


def is_uncommitted(revision: str) -> bool:
    """Return True if the id of a revision stands for the index or the working tree."""
    return revision in UNCOMMITTED


class CheckedOut(Repository):
    """The checked-out commit of a repository, with its index and its working tree."""

    def parents(self) -> tuple[str, ...]:
        """Return the commits on which the next commit will be built: HEAD, and those that are being merged."""
        try:
            head = self.resolve("HEAD")
        except GitError:
            return ()  # the current branch has no commit
        merged = self.folder / self._run("rev-parse", "--git-path", "MERGE_HEAD").removesuffix("\n")
        return (head, *(merged.read_text(encoding="ascii").split() if merged.is_file() else ()))

    def uncommitted(self, parents: tuple[str, ...]) -> Uncommitted:
        """Read the changed .proto files in the index, and those in the working tree.

        ``parents`` are the commits from `parents`. In a hook of ``git commit``, the working tree is not read.
        """
        if self._run("rev-parse", "--is-inside-work-tree").strip() != "true":
            return Uncommitted()
        hook = self._index_of_hook()
        revisions: list[Revision] = []
        staged = self._staged(parents, hook)
        if staged or len(parents) > 1:
            revisions.append(Revision(_INDEX, _as_commit(_INDEX), parents, tuple(staged)))
            parents = (_INDEX,)
        if hook:
            return Uncommitted(tuple(revisions))
        edits, contents = self._changed()
        if edits:
            revisions.append(Revision(_WORKING_TREE, _as_commit(_WORKING_TREE), parents, tuple(edits)))
        return Uncommitted(tuple(revisions), contents)

    def tree_of_hook(self) -> str:
        """Return the id of the tree that ``git commit`` is about to commit, in one of its hooks; empty elsewhere."""
        hook = self._index_of_hook()
        return self._run("write-tree", index=hook).strip() if hook else ""

    def _staged(self, parents: tuple[str, ...], hook: str) -> list[Edit]:
        """Return the .proto files of the index that differ from HEAD. ``hook`` is the index file of a hook, if any."""
        # git knows the empty tree, even if the repository does not contain it.
        head = parents[0] if parents else self._run("hash-object", "-t", "tree", "--stdin").strip()
        words = self._run("diff-index", "--cached", *_DIFF, head, "--", PROTOS, index=hook).split("\0")
        # A file with conflicts has no blob in the index; the working tree has its content.
        unmerged = {path for about, path in zip(words[::2], words[1::2]) if about.endswith("U")}
        return [edit for edit in edits_at(words, 0)[0] if edit.path not in unmerged]

    def _changed(self) -> tuple[list[Edit], dict[str, bytes | None]]:
        """Return the .proto files of the working tree that differ from the index, and their contents by blob id.

        New files count, unless git ignores them.
        """
        output = self._run("diff-files", *_DIFF, "--", PROTOS)
        before = {edit.path: edit.old for edit in edits_at(output.split("\0"), 0)[0]}
        new = self._run("ls-files", "-z", "--full-name", "--others", "--exclude-standard", "--", PROTOS)
        before |= dict.fromkeys(path for path in new.split("\0") if path)
        top = Path(self._run("rev-parse", "--show-toplevel").removesuffix("\n"))
        contents = {path: _content(top, path) for path in before if _is_file(top / path)}
        ids = {path: _id(path, data) for path, data in contents.items()}
        edits = [Edit(path, old, ids.get(path)) for path, old in sorted(before.items()) if old != ids.get(path)]
        return edits, {ids[path]: data for path, data in contents.items()}

    def _index_of_hook(self) -> str:
        """Return the path of the index that a hook of ``git commit`` looks at; empty outside such a hook."""
        # git sets the variable for a hook (githooks(5)). With `git commit FILE`, it is not the usual index. The hook
        # can belong to another repository than the linted folder.
        file = os.environ.get("GIT_INDEX_FILE", "")
        if not file:
            return ""
        folder = self._run("rev-parse", "--absolute-git-dir").removesuffix("\n")
        return os.path.abspath(file) if os.path.realpath(os.path.dirname(file)) == folder else ""


def _as_commit(state: str) -> Commit:
    """Return what stands in place of the commit for a change that only the index or the working tree has."""
    return Commit("", "", f"a change in {state} that is not committed yet")


def _is_file(path: Path) -> bool:
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except OSError:
        return False


def _content(top: Path, path: str) -> bytes | None:
    try:
        return source_files.read(top, path)
    except OSError:
        return None


def _id(path: str, data: bytes | None) -> str:
    """Return the id of a file's content: that of git's blob with this content; for no content, another text."""
    return f"unread {path}" if data is None else sha1(b"blob %d\0%b" % (len(data), data)).hexdigest()  # noqa: S324
