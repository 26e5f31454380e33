"""The history of all .proto files in a repository, and queries about the numbers in it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from functools import cache, cached_property, lru_cache
from itertools import groupby
from pathlib import Path

from roverlink.generator.git import Commit
from roverlink.generator.lint.history.blob_cache import BlobCache
from roverlink.generator.lint.history.branch_collisions import Branches
from roverlink.generator.lint.history.branch_names import branches, default_branch
from roverlink.generator.lint.history.commit_graph import Graph, depth
from roverlink.generator.lint.history.commits import TAGS, PastRepository, Ref, Revision
from roverlink.generator.lint.history.lineage import sweep
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.moved_files import (
    LostPast,
    blobs_to_compare,
    lost_pasts,
    moves_into,
    with_moved_files,
)
from roverlink.generator.lint.history.numbered_types import NumberedTypes, Pool, numbered_types
from roverlink.generator.lint.history.reuses import Reuses
from roverlink.generator.lint.history.uncommitted import CheckedOut, Uncommitted, is_uncommitted
from roverlink.generator.lint.history.usage_model import Collision, Reuse, TracedType, Usage
from roverlink.generator.lint.history.usages import TracedUsage, usages
from roverlink.generator.lint.history.word_renames import WordRenames
from roverlink.generator.protos.parser import parse

_SOME = 64  # states between two reports of progress
_FEW = 256  # messages whose usages are kept
_NO_TYPES: NumberedTypes = {}


def read_history(folder: Path, report: Callable[[int, int], None] | None = None, newest: str = "") -> History:
    """Read the history of all .proto files below a folder, from all refs and both sides of each merge.

    The newest state is that of the working tree, or in a hook of ``git commit`` that of the index. ``newest`` names
    another one: a git ref. Commits that were built upon this ref are left out then. ``report`` shows progress: it is
    called with the number of file states read so far, and their total number. Raises `GitError` if git fails.
    """
    git, checked_out = PastRepository(folder), CheckedOut(folder)
    last = (git.resolve(newest),) if newest else checked_out.parents()
    revisions, refs = git.revisions(last), git.refs()
    uncommitted = Uncommitted()
    if newest:
        revisions, refs = _up_to(last[0], revisions, refs)
    else:
        uncommitted = checked_out.uncommitted(last)
    states = _States(git, uncommitted.contents, report or _ignore_progress)
    root = git.prefix()
    revisions = [*revisions, *uncommitted.revisions]
    lost: list[LostPast] = []
    if root:
        states.read(blobs_to_compare(revisions, root))
        moves = moves_into(revisions, root, states.types_of)
        lost = lost_pasts(revisions, root, states.types_of, moves)
        revisions = with_moved_files(revisions, root, moves)
    states.read(edit.new for revision in revisions for edit in revision.edits if edit.new)
    states.save()
    tip = revisions[-1].id if uncommitted.revisions else (*last, "")[0]
    return History(revisions, refs, tip, bool(git.boundary()), states, lost)


def _up_to(last: str, revisions: Sequence[Revision], refs: Sequence[Ref]) -> tuple[list[Revision], list[Ref]]:
    """Return the revisions and refs without the commits that were built upon the commit ``last``."""
    later = set[str]()
    for revision in revisions:
        if any(parent == last or parent in later for parent in revision.parents):
            later.add(revision.id)
    return [revision for revision in revisions if revision.id not in later], [
        ref for ref in refs if ref.commit not in later
    ]


class History:
    """The meanings that each number of each message and enum had in the history of a repository.

    A message or enum is followed when its file, its package or its name changes (see `identities`). The functions that
    take a name ask for the messages and enums that have it in the newest state, or else that once had it.
    """

    def __init__(
        self,
        revisions: Sequence[Revision],
        refs: Sequence[Ref],
        newest: str,
        shallow: bool,
        states: _States,
        lost: Sequence[LostPast],
    ) -> None:
        graph = Graph(revisions)
        self._refs = refs
        self._nodes = {ref: graph.node_of(commit) for ref, commit in branches(refs).items()}
        places = self._nodes | ({newest: graph.node_of(newest)} if is_uncommitted(newest) else {})
        lineage = sweep(graph, states.types_of, frozenset(places.values()))
        tags = {ref.name: graph.node_of(ref.commit) for ref in refs if ref.name.startswith(TAGS)}
        default = default_branch(refs)
        released = {*tags.values(), *(graph.node_of(ref.commit) for ref in refs if ref.name == default)}
        self._record = Record(graph, lineage, graph.node_of(newest), self._nodes | tags, released)
        self._renames = WordRenames(self._record)

        # Not all are kept: the usages of thousands of messages on hundreds of branches take 100 MB.
        @lru_cache(_FEW)
        def traced(
            ids: tuple[int, ...], elsewhere: tuple[tuple[int, str], ...] = (), claimed: bool = False
        ) -> list[TracedUsage]:
            return usages(self._record, ids, places, claimed, elsewhere)

        self._traced = traced
        self.reuses_of = cache(self._find_reuses)
        """Function that takes the id of a message or enum, and returns the reuses of its numbers.

        A reuse is a pair of usages (meanings) of one number. Mere renames are included.
        """
        self.commits = sum(not is_uncommitted(revision.id) for revision in revisions)
        """The number of commits in the history."""
        self.shallow = shallow
        """True if the clone is shallow: its earliest commits are missing."""
        self.depth = depth(revisions, [ref.commit for ref in refs])
        """The number of commits from the newest to the oldest one."""
        self.lost = tuple(lost)
        """Files that were copied into the folder, and whose originals were deleted by other commits."""
        self.unread = tuple(sorted(_paths(revisions, states.unread)))
        """Paths of files with a state that could not be read, because it is missing, too large, or binary."""

    @cached_property
    def types(self) -> tuple[TracedType, ...]:
        """All messages and enums that existed at some time, sorted by name."""
        return tuple(sorted(self._record.types.values(), key=lambda each: (each.name, each.id)))

    @cached_property
    def types_by_name(self) -> dict[str, tuple[TracedType, ...]]:
        """The same as `types`, by the name that each type has in the newest state, or had last."""
        return {name: tuple(types) for name, types in groupby(self.types, key=lambda each: each.name)}

    @cached_property
    def messages(self) -> tuple[str, ...]:
        """All full names that messages had at some time."""
        return tuple(sorted({name for type in self.types if not type.enum for name in type.names}))

    @cached_property
    def enums(self) -> tuple[str, ...]:
        """All full names that enums had at some time."""
        return tuple(sorted({name for type in self.types if type.enum for name in type.names}))

    def numbers(self, name: str) -> dict[int, tuple[Usage, ...]]:
        """Return every number that a message or enum ever had, with its usages (meanings), the earliest first."""
        return _by_number(traced.usage for traced in self._traced_as(name))

    def numbers_of(self, id: int) -> dict[int, tuple[Usage, ...]]:
        """Return the same as `numbers` for the message or enum with an id."""
        return _by_number(traced.usage for traced in self._traced_with_namesakes(id))

    def types_of(self, id: int, usage: Usage) -> tuple[str, ...]:
        """Return the full names that the type of a usage ever had, the latest first.

        ``usage`` is one of `numbers_of` the message with the id. The name of a scalar or a map, and that of a type
        which no file declares, is the only one.
        """
        stretches = next(traced.stretches for traced in self._traced_with_namesakes(id) if traced.usage == usage)
        types: dict[int, None] = {}
        for owner, node in ((stretch.owner, stretch.lifetime.came) for stretch in reversed(stretches)):
            resolved = self._record.resolve(usage.type, owner, node)
            found = self._record.once_resolved(usage.type, owner, node) if resolved is None else [resolved]
            types |= dict.fromkeys(found)
        names = [name for type in types for name in self._record.types[type].names]
        return tuple(dict.fromkeys(names)) or (usage.type.lstrip("."),)

    def claims(self, name: str) -> dict[int, tuple[Usage, ...]]:
        """Return every number that a commented-out declaration of a message or enum ever had, with its meanings."""
        return _by_number(traced.usage for traced in self._traced_as(name, claimed=True))

    def removed(self, name: str) -> Iterator[tuple[Usage, list[Commit]]]:
        """Yield the usages (meanings) of numbers that a message once had, and has no more in its newest state.

        Each comes with the commits that removed it on the way to that state; there are none if the change is not
        committed yet.
        """
        graph, newest = self._record.graph, self._record.newest
        for id in self._record.named(name):
            kept = {fact.number for declared in self._record.declared(id, newest).values() for fact in declared.facts}
            for traced in self._traced((id,)):
                lifetimes = [
                    stretch.lifetime for stretch in traced.stretches if graph.precedes(stretch.lifetime.came, newest)
                ]
                if lifetimes and traced.usage.number not in kept:
                    ends = {node for lifetime in lifetimes for node in lifetime.went if graph.precedes(node, newest)}
                    commits = [graph[node].revision.commit for node in sorted(ends)]
                    yield traced.usage, [commit for commit in commits if commit.id]

    def files(self, name: str) -> set[str]:
        """Return the paths of all files that ever declared a message or enum, on any branch."""
        changes = self._record.lineage.changes
        return {place.path for id in self._ids(name) for declared in changes[id].values() for place in declared}

    def reuses(self, name: str) -> tuple[Reuse, ...]:
        """Return the reuses of the numbers of a message or enum."""
        return tuple(reuse for id in self._record.named(name) for reuse in self.reuses_of(id))

    def collisions(self, name: str) -> tuple[Collision, ...]:
        """Return the numbers to which branches have given different meanings since they diverged.

        These are numbers of a message, and of all messages and enums in it.
        """
        branches = Branches(self._record, self._nodes, default_branch(self._refs))
        return tuple(branches.collisions(self._ids(name)))

    def _ids(self, name: str) -> list[int]:
        """Return the ids of the types with a name, also of those that only branches or tags declare under it."""
        return [*self._record.named(name), *(id for id, _ in self._record.named_elsewhere(name))]

    def _traced_as(self, name: str, claimed: bool = False) -> list[TracedUsage]:
        """Return the usages of the types with a name, and of what branches and tags declare under it today."""
        return self._traced(tuple(self._record.named(name)), tuple(self._record.named_elsewhere(name)), claimed)

    def _traced_with_namesakes(self, id: int) -> list[TracedUsage]:
        """Return the usages of a message or enum, and of its namesakes on other branches."""
        return self._traced((id,), tuple(self._record.namesakes(id).items()))

    def _find_reuses(self, id: int) -> tuple[Reuse, ...]:
        return tuple(Reuses(self._record, id, self._traced_with_namesakes(id), self._renames).all())


def _by_number(found: Iterable[Usage]) -> dict[int, tuple[Usage, ...]]:
    return {number: tuple(group) for number, group in groupby(found, key=lambda usage: usage.number)}


class _States:
    """The states of .proto files: the messages and enums in each blob that was read."""

    def __init__(
        self, git: PastRepository, contents: Mapping[str, bytes | None], report: Callable[[int, int], None]
    ) -> None:
        self.unread = set[str]()
        """Ids of the blobs that could not be read."""
        self._git, self._contents, self._report = git, contents, report
        self._cache = BlobCache(git.folder)
        self._pool = Pool()
        self._known = self._cache.load(self._pool)
        self._types: dict[str, NumberedTypes] = {}
        self._parsed = False

    def types_of(self, blob: str | None) -> NumberedTypes:
        """Return the messages and enums of a blob; nothing for None, and for a blob that was not read."""
        return self._types.get(blob, _NO_TYPES) if blob else _NO_TYPES

    def read(self, blobs: Iterable[str]) -> None:
        """Read some blobs, from the cache as far as it has them."""
        blobs = list(dict.fromkeys(blobs))
        self._types |= {blob: self._known[blob] for blob in blobs if blob in self._known}
        new = [blob for blob in blobs if blob not in self._types and blob not in self.unread]
        for done, (blob, data) in enumerate(self._data(new), len(blobs) - len(new)):
            # A NUL byte means a binary file for git, too (gitattributes(5), `diff`: git looks at the beginning of the
            # content).
            if not isinstance(data, bytes) or b"\0" in data:
                self.unread.add(blob)
            else:
                # Comments of old files often have another encoding than UTF-8. Declarations are ASCII, so replaced
                # characters change only comments.
                self._types[blob] = numbered_types(parse(data.decode("utf-8", errors="replace")), self._pool)
                self._parsed = True
            if done % _SOME == 0:
                self._report(done, len(blobs))
        self._report(len(blobs), len(blobs))

    def save(self) -> None:
        """Write the cache, if new blobs were parsed."""
        if self._parsed:
            self._cache.save(self._types)

    def _data(self, blobs: Sequence[str]) -> Iterator[tuple[str, bytes | str | None]]:
        yield from ((blob, self._contents[blob]) for blob in blobs if blob in self._contents)
        yield from self._git.blobs([blob for blob in blobs if blob not in self._contents])


def _paths(revisions: Iterable[Revision], blobs: Set[str]) -> set[str]:
    return {edit.path for revision in revisions for edit in revision.edits if edit.new in blobs}


def _ignore_progress(done: int, total: int) -> None:
    """Do nothing. This takes the place of ``report`` if the caller of `read_history` does not want the progress."""
    del done, total
