"""One walk over history, parents before children: what each message says at each commit, and since when.

Where something came and went is a question of one line of history, so each line carries what is alive on it, as
lifetimes. The rules for commits with several parents:

- a fact comes with a merge only if no parent had it; otherwise it goes on as what it was in those that had it;
- a fact goes with a merge only if the merge itself drops it. Where a parent that lacks it had known it once, somebody
  on that line took it away before, and the merge only carries that over: there, that lifetime has `faded`;
- so does a merge by which it goes on as two lifetimes, since it had come on each side for itself. They go together.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from roverlink.generator.lint.history.commit_graph import Graph, Node
from roverlink.generator.lint.history.numbered_types import NumberedType, NumberedTypes
from roverlink.generator.protos.schema import Fact

Declared = Mapping[str, NumberedType]
"""The declarations of one message or enum in one state, by file: mostly one."""
Lifetimes = frozenset[int]
"""Indices of the lifetimes that a fact is alive by: one, unless it came on several lines that were merged."""
Alive = Mapping[Fact, Lifetimes]

_NOTHING: Alive = {}


@dataclass(slots=True)
class Lifetime:
    """From one coming of a fact to all its goings."""

    fact: Fact
    came: int
    path: str
    line: int
    went: list[int] = field(default_factory=list)
    faded: list[int] = field(default_factory=list)
    """Merges that carried over that it had gone."""


@dataclass(slots=True)
class State:
    """What all messages and enums are at one commit. What is in the two mappings is shared, and never changed."""

    declared: dict[str, Declared] = field(default_factory=dict)
    alive: dict[str, Alive] = field(default_factory=dict)

    def copy(self) -> State:
        """A state that can be changed."""
        return State(dict(self.declared), dict(self.alive))


@dataclass(slots=True)
class Lineage:
    """What the walk finds."""

    lifetimes: dict[str, list[Lifetime]] = field(default_factory=dict)
    """Of each message and enum."""
    changes: dict[str, dict[int, Declared]] = field(default_factory=dict)
    """What each of them became at the nodes at which it is not what it is at their first parent."""
    tips: dict[int, State] = field(default_factory=dict)


def sweep(graph: Graph, types_of: Callable[[str], NumberedTypes], tips: Collection[int]) -> Lineage:
    """Walk over all nodes. Of the ``tips``, the states are kept."""
    walk = _Sweep(graph, types_of, tips)
    for node in graph.nodes:
        walk.visit(node)
    return walk.lineage


class _Sweep:
    def __init__(self, graph: Graph, types_of: Callable[[str], NumberedTypes], tips: Collection[int]) -> None:
        self.lineage = Lineage()
        self._graph, self._types_of = graph, types_of
        self._states = {Graph.BEGINNING: State()}
        self._needed = [0] * len(graph)
        """How often each state is still to be built upon; the last one to do so need not copy it."""
        for index in tips:
            self._needed[index] += 1
        for node in graph.nodes:
            for parent in node.parents:
                self._needed[parent] += 1
        self._tips = frozenset(tips)
        if Graph.BEGINNING in self._tips:
            self.lineage.tips[Graph.BEGINNING] = State()

    def visit(self, node: Node) -> None:
        """Find out what comes and goes at a node whose parents were visited."""
        others = [self._release(parent) for parent in node.parents[1:]]
        alive_there = [state.alive for state in others]
        state = self._take(node.parents[0])
        changed = self._edit(node, state)
        here = state.alive
        for there in alive_there:
            if there is not here:
                changed |= {owner for owner, alive in there.items() if here.get(owner) is not alive}
                changed |= here.keys() - there.keys()
        for owner in sorted(changed):
            befores = [alive.get(owner, _NOTHING) for alive in (here, *alive_there)]
            after = self._settle(node, owner, befores, state.declared.get(owner, {}))
            here[owner] = after
        self._states[node.index] = state
        if node.index in self._tips:
            self.lineage.tips[node.index] = state
        if not self._needed[node.index]:
            del self._states[node.index]

    def _take(self, index: int) -> State:
        """A parent's state, to be changed."""
        state = self._release(index)
        return state.copy() if index in self._states else state

    def _release(self, index: int) -> State:
        state = self._states[index]
        self._needed[index] -= 1
        if not self._needed[index]:
            del self._states[index]
        return state

    def _edit(self, node: Node, state: State) -> set[str]:
        """Put what a node's files declare into a state; the messages and enums of which that changes any fact."""
        before: dict[str, Declared] = {}
        for edit in node.revision.edits:
            old = self._types_of(edit.old) if edit.old else {}
            new = self._types_of(edit.new) if edit.new else {}
            for owner in {**old, **new}:
                declared = dict(state.declared.get(owner, {}))
                before.setdefault(owner, state.declared.get(owner, {}))
                declared.pop(edit.path, None)
                if owner in new:
                    declared[edit.path] = new[owner]
                state.declared[owner] = declared
        changed = set()
        for owner, was in before.items():
            if not _same(was, state.declared[owner]):
                self.lineage.changes.setdefault(owner, {})[node.index] = state.declared[owner]
                changed.add(owner)
        return changed

    def _settle(self, node: Node, owner: str, befores: list[Alive], declared: Declared) -> Alive:
        """What is alive of a message at a node, after what was at its parents."""
        lifetimes = self.lineage.lifetimes.setdefault(owner, [])
        after: dict[Fact, Lifetimes] = {}
        for path, declaration in declared.items():
            for fact, line in declaration.facts.items():
                if fact not in after:
                    held = [before[fact] for before in befores if fact in before]
                    if not held:
                        lifetimes.append(Lifetime(fact, node.index, path, line))
                        held = [frozenset((len(lifetimes) - 1,))]
                    after[fact] = held[0].union(*held[1:]) if len(held) > 1 else held[0]
        for before in befores:
            for fact in before.keys() - after.keys():
                self._end(node, fact, befores, [lifetimes[index] for index in sorted(before[fact])])
        return after

    def _end(self, node: Node, fact: Fact, befores: list[Alive], lifetimes: list[Lifetime]) -> None:
        """A fact is not there any more: note for its lifetimes whether it is this node that takes it away."""
        lacking = [parent for parent, before in zip(node.parents, befores) if fact not in before]
        for lifetime in lifetimes:
            known = any(self._graph.precedes(lifetime.came, parent) for parent in lacking)
            ended = lifetime.faded if known else lifetime.went
            if node.index not in ended:
                ended.append(node.index)


def _same(one: Declared, other: Declared) -> bool:
    """Whether two states say the same of all numbers, in the same files, on whichever lines."""
    return one.keys() == other.keys() and all(
        declaration.facts.keys() == other[path].facts.keys() and declaration.broken == other[path].broken
        for path, declaration in one.items()
    )
