"""The history of all .proto files in a repository, and queries about the numbers in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from itertools import groupby
from pathlib import Path

from roverlink.generator.lint.history.blob_cache import BlobCache
from roverlink.generator.lint.history.branch_collisions import Branches, branches, default_branch
from roverlink.generator.lint.history.commit_graph import Graph, depth
from roverlink.generator.lint.history.commits import PastRepository, Ref, Revision
from roverlink.generator.lint.history.lineage import sweep
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.numbered_types import NumberedTypes, numbered_types
from roverlink.generator.lint.history.reuses import Reuses
from roverlink.generator.lint.history.usage_model import Collision, Reuse, Usage
from roverlink.generator.lint.history.usages import TracedUsage, usages
from roverlink.generator.protos.parser import parse

_SOME = 64  # states between two reports of progress


def read_history(repository: Path, report: Callable[[int, int], None] | None = None) -> History:
    """Read the history of all .proto files below a folder, from all refs and both sides of each merge.

    ``report`` shows progress: it is called with the number of file states read so far, and their total number. Raises
    `GitError` if git fails.
    """
    git = PastRepository(repository)
    refs, boundary, revisions = git.refs(), git.boundary(), git.revisions()
    types, unread = _types(git, revisions, report or _ignore_progress)
    return History(revisions, refs, bool(boundary), types, unread)


class History:
    """The meanings that each number of each message and enum had in the history of a repository.

    Messages and enums are found by name, with or without package. If a message or enum moved to another package, its
    old and new names have the same history. The names of the .proto files do not matter.
    """

    def __init__(
        self,
        revisions: Sequence[Revision],
        refs: Sequence[Ref],
        shallow: bool,
        types: Mapping[str, NumberedTypes],
        unread: frozenset[str],
    ) -> None:
        graph = Graph(revisions)
        self._refs = refs
        self._nodes = {ref: graph.node_of(commit) for ref, commit in branches(refs).items()}
        lineage = sweep(graph, lambda blob: types.get(blob, {}), frozenset(self._nodes.values()))
        self._record = Record(graph, lineage)
        self._traced = cache(self._find_traced)
        self.reuses = cache(self._find_reuses)
        """Function that takes the name of a message or enum, and returns the reuses of its numbers.

        A reuse is a pair of usages (meanings) of one number. Mere renames are included.
        """
        self.commits = len(revisions)
        """The number of commits in the history."""
        self.shallow = shallow
        """True if the clone is shallow: its earliest commits are missing."""
        self.depth = depth(revisions, [ref.commit for ref in refs])
        """The number of commits from the newest to the oldest one."""
        self.unread = tuple(sorted(_paths(revisions, unread)))
        """Paths of files with a state that could not be read, because it is missing, too large, or binary."""

    @property
    def messages(self) -> tuple[str, ...]:
        """Full names of all messages that existed at some time."""
        return tuple(sorted(name for name, enum in self._kinds() if not enum))

    @property
    def enums(self) -> tuple[str, ...]:
        """Full names of all enums that existed at some time."""
        return tuple(sorted(name for name, enum in self._kinds() if enum))

    def names(self, name: str) -> tuple[str, ...]:
        """Return the full names that a message or enum had. There are several if its package changed."""
        return tuple(self._record.owners(name))

    def numbers(self, name: str) -> dict[int, tuple[Usage, ...]]:
        """Return every number that a message or enum ever had, with its usages (meanings), the earliest first."""
        return _by_number(traced.usage for traced in self._traced(name, False))

    def claims(self, name: str) -> dict[int, tuple[Usage, ...]]:
        """Return every number that a commented-out declaration of a message or enum ever had, with its meanings."""
        return _by_number(traced.usage for traced in self._traced(name, True))

    def collisions(self, name: str) -> tuple[Collision, ...]:
        """Return the numbers of a message to which branches have given different payloads since they diverged."""
        found = Branches(self._record, self._record.owners(name), self._nodes)
        return tuple(found.collisions(default_branch(self._refs)))

    def _find_reuses(self, name: str) -> tuple[Reuse, ...]:
        return tuple(Reuses(self._record, self._record.owners(name), self._traced(name, False)).all())

    def _find_traced(self, name: str, claimed: bool) -> list[TracedUsage]:
        return usages(self._record, self._record.owners(name), self._nodes, claimed)

    def _kinds(self) -> set[tuple[str, bool]]:
        return {
            (name, declaration.enum)
            for name, changes in self._record.lineage.changes.items()
            for declared in changes.values()
            for declaration in declared.values()
        }


def _by_number(found: Iterable[Usage]) -> dict[int, tuple[Usage, ...]]:
    return {number: tuple(group) for number, group in groupby(found, key=lambda usage: usage.number)}


def _types(
    git: PastRepository, revisions: Sequence[Revision], report: Callable[[int, int], None]
) -> tuple[dict[str, NumberedTypes], frozenset[str]]:
    """Return the messages and enums in each blob, by the blob's id, and the ids of blobs that could not be read."""
    blobs = list(dict.fromkeys(edit.new for revision in revisions for edit in revision.edits if edit.new))
    blob_cache = BlobCache(git.folder)
    known = blob_cache.load()
    types = {blob: known[blob] for blob in blobs if blob in known}
    new, unread = [blob for blob in blobs if blob not in known], set[str]()
    for done, (blob, data) in enumerate(git.blobs(new), len(types)):
        # A NUL byte means a binary file for git, too (gitattributes(5), `diff`: git looks at the beginning of the
        # content).
        if isinstance(data, str) or b"\0" in data:
            unread.add(blob)
        else:
            # Comments of old files often have another encoding than UTF-8. Declarations are ASCII, so replaced
            # characters change only comments.
            types[blob] = numbered_types(parse(data.decode("utf-8", errors="replace")))
        if done % _SOME == 0:
            report(done, len(blobs))
    report(len(blobs), len(blobs))
    # Nothing new was read: do not write the same cache again.
    if len(unread) < len(new):
        blob_cache.save(types)
    return types, frozenset(unread)


def _paths(revisions: Iterable[Revision], blobs: frozenset[str]) -> set[str]:
    return {edit.path for revision in revisions for edit in revision.edits if edit.new in blobs}


def _ignore_progress(done: int, total: int) -> None:
    """Do nothing. This takes the place of ``report`` if the caller of `read_history` does not want the progress."""
    del done, total
