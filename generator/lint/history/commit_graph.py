"""Graph of the commits that change .proto files, with the order in which they follow each other.

A commit that changes no .proto file has no node of its own; the node of its parent stands for it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Protocol, TypeVar

from roverlink.generator.lint.history.commits import Revision

# A commit can have two parents (a merge), and branches may never be merged. So only the graph of commits shows which
# commit is before another one. Dates do not show it, because clocks differ and a rebase keeps the author's date.
#
# The graph is made once and searched often: for every two usages of a number, the lint asks which one came first. Two
# choices make this fast:
# - Commits that change no .proto file have no node. Few commits of a robot's repository change the protos.
# - The ancestors of a node are a bit set in one integer. n nodes take about n * n / 16 bytes: 6 MB for 10,000 nodes.
#
# Nodes are numbered in the order of `git log --date-order`, reversed: parents always have smaller numbers.


class _Copyable(Protocol):
    def copy(self: _State) -> _State:
        """Return a copy that may be changed."""


_State = TypeVar("_State", bound=_Copyable)


@dataclass(frozen=True, slots=True)
class Node:
    """A commit that changes a .proto file, or a merge of branches that changed some files."""

    index: int
    """The node's number. It is larger than the numbers of the node's parents."""
    parents: tuple[int, ...]
    """The indices of the parents' nodes. `Revision.edits` are the changes since the first parent."""
    revision: Revision


class Graph:
    """The nodes of the history, each with an index. A node is a commit that changes .proto files.

    The index `BEGINNING` stands for the empty repository before the first commit.
    """

    BEGINNING = 0

    def __init__(self, revisions: Iterable[Revision]) -> None:
        self.nodes: list[Node] = []
        self._node_of: dict[str, int] = {}
        self._ancestors = [1]
        """For each node, an integer whose set bits are the node itself and its ancestors.

        This makes `precedes` fast.
        """
        for revision in revisions:
            self._node_of[revision.id] = self._add(revision)

    def __len__(self) -> int:
        return len(self._ancestors)

    def __getitem__(self, index: int) -> Node:
        return self.nodes[index - 1]

    def node_of(self, commit: str) -> int:
        """Return the index of a commit's node; `BEGINNING` if no .proto file existed at the commit."""
        return self._node_of.get(commit, self.BEGINNING)

    def precedes(self, one: int, other: int) -> bool:
        """Return True if the node ``one`` is an ancestor of the node ``other``, or the same node."""
        return bool(self._ancestors[other] >> one & 1)

    def past(self, nodes: Iterable[int]) -> int:
        """Return an integer whose set bits are some nodes and all their ancestors."""
        found = 0
        for node in nodes:
            found |= self._ancestors[node]
        return found

    def on_first_parents(self, one: int, other: int) -> bool:
        """Return True if the way from the node ``other`` back along first parents leads to the node ``one``."""
        begin, end = self._intervals[one]
        return begin <= self._intervals[other][0] < end

    @cached_property
    def _intervals(self) -> list[tuple[int, int]]:
        """For each node, the range of positions in the tree of first parents that its descendants there have."""
        sizes = [1] * len(self)
        for node in reversed(self.nodes):
            sizes[node.parents[0]] += sizes[node.index]
        # The first child of a node gets the position behind the node, each further child the one behind its sibling.
        begins, free = [0] * len(self), [1] * len(self)
        for node in self.nodes:
            parent = node.parents[0]
            begins[node.index] = free[parent]
            free[parent] += sizes[node.index]
            free[node.index] = begins[node.index] + 1
        return [(begin, begin + size) for begin, size in zip(begins, sizes)]

    def merge_bases(self, one: int, other: int) -> list[int]:
        """Return the latest common ancestors of two nodes (commits), as ``git merge-base --all`` does."""
        common = self._ancestors[one] & self._ancestors[other]
        bases = []
        while common:
            # Children have larger numbers than their parents. So no other common ancestor descends from the largest
            # one, and it is a merge base. Its ancestors are none: a merge base is not reachable from another one.
            latest = common.bit_length() - 1
            bases.append(latest)
            common &= ~self._ancestors[latest]
        return bases

    def _add(self, revision: Revision) -> int:
        # Parents without changes of their own share one node, and then the merge has one parent here.
        parents = tuple(dict.fromkeys(self.node_of(id) for id in revision.parents)) or (self.BEGINNING,)
        # A merge without edits still joins two lines, unless the first parent already descends from the others.
        if not revision.edits and all(self.precedes(parent, parents[0]) for parent in parents):
            return parents[0]
        index = len(self)
        self._ancestors.append(1 << index | self.past(parents))
        self.nodes.append(Node(index, parents, revision))
        return index


class Lines(Generic[_State]):
    """The states at those nodes whose children were not visited yet, in a walk over the graph with parents first."""

    def __init__(self, graph: Graph, beginning: _State) -> None:
        self._states = {Graph.BEGINNING: beginning}
        self._needed = [0] * len(graph)
        """For each node, the number of children that still need its state.

        The last child that needs a state may change it without making a copy.
        """
        for node in graph.nodes:
            for parent in node.parents:
                self._needed[parent] += 1

    def take(self, index: int) -> _State:
        """Return the state at the node ``index``, as a state that the caller may change.

        This is a copy if other nodes still need the state.
        """
        state = self.release(index)
        return state.copy() if index in self._states else state

    def release(self, index: int) -> _State:
        """Return the state at the node ``index`` for a child that only reads it."""
        state = self._states[index]
        self._needed[index] -= 1
        if not self._needed[index]:
            del self._states[index]
        return state

    def keep(self, index: int, state: _State) -> None:
        """Keep the state at the node ``index`` as long as other nodes need it."""
        if self._needed[index]:
            self._states[index] = state


def depth(revisions: Collection[Revision], tips: Iterable[str]) -> int:
    """Return the depth of the history: the number of commits from the newest to the oldest commit.

    ``tips`` are the last commits of the branches. For each commit, the way to the nearest tip is counted; the result is
    the largest count.
    """
    parents = {revision.id: revision.parents for revision in revisions}
    level = {tip for tip in tips if tip in parents}
    seen, steps = set(level), 0
    while level:
        steps += 1
        level = {parent for id in level for parent in parents[id] if parent in parents} - seen
        seen |= level
    return steps
