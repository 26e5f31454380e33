"""Which commit descends from which; commits that change nothing that is looked at are those that they come from."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from roverlink.generator.lint.history.commits import Revision


@dataclass(frozen=True, slots=True)
class Node:
    """A commit that changes a .proto file, or brings lines of history together that had changed some."""

    index: int
    """Parents have smaller ones."""
    parents: tuple[int, ...]
    """The first one is what `Revision.edits` are seen from."""
    revision: Revision


class Graph:
    """The nodes of history. The node `BEGINNING` is none of them: it is the empty tree that every line begins with."""

    BEGINNING = 0

    def __init__(self, revisions: Iterable[Revision]) -> None:
        self.nodes: list[Node] = []
        self._node_of: dict[str, int] = {}
        self._ancestors = [1]
        """Of each node, itself included, as bits: one test for a pair is then as good as free."""
        for revision in revisions:
            self._node_of[revision.commit.id] = self._add(revision)

    def __len__(self) -> int:
        return len(self._ancestors)

    def __getitem__(self, index: int) -> Node:
        return self.nodes[index - 1]

    def node_of(self, commit: str) -> int:
        """The node that a commit is or comes from without a change; `BEGINNING` where there is none."""
        return self._node_of.get(commit, self.BEGINNING)

    def precedes(self, one: int, other: int) -> bool:
        """Whether a node is an ancestor of another, or is that."""
        return bool(self._ancestors[other] >> one & 1)

    def merge_bases(self, one: int, other: int) -> list[int]:
        """The latest of the common ancestors."""
        common = self._ancestors[one] & self._ancestors[other]
        bases = []
        while common:
            latest = common.bit_length() - 1
            bases.append(latest)
            common &= ~self._ancestors[latest]
        return bases

    def _add(self, revision: Revision) -> int:
        parents = tuple(dict.fromkeys(self.node_of(id) for id in revision.parents)) or (self.BEGINNING,)
        if not revision.edits and all(self.precedes(parent, parents[0]) for parent in parents):
            return parents[0]
        index = len(self)
        ancestors = 1 << index
        for parent in parents:
            ancestors |= self._ancestors[parent]
        self._ancestors.append(ancestors)
        self.nodes.append(Node(index, parents, revision))
        return index


def depth(revisions: Collection[Revision], tips: Iterable[str]) -> int:
    """How many commits one can go back at most, by the shortest way from the nearest tip: that of a shallow clone."""
    parents = {revision.commit.id: revision.parents for revision in revisions}
    level = {tip for tip in tips if tip in parents}
    seen, steps = set(level), 0
    while level:
        steps += 1
        level = {parent for id in level for parent in parents[id] if parent in parents} - seen
        seen |= level
    return steps
