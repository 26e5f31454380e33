"""Walk over all commits, parents before children, that finds when each fact of each message begins and ends.

A fact is the declaration of a field or an enum value, without its place in the file. A line of history is a chain of
commits, such as a branch. A fact may begin and end several times, and at other commits on each line of history. So the
walk keeps, for each line, the lifetimes of facts that have not ended there. Rules for a merge:

- A fact begins at the merge only if no parent has it. Otherwise its lifetimes in the parents continue.
- A fact ends at the merge only if the merge itself deletes it. If a parent without the fact had it before, a commit on
  that line deleted it, and the merge only takes over the deletion: its lifetimes in the other parents have `faded`.
- If a fact began separately on both sides, the merge continues both lifetimes. They end together.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from roverlink.generator.lint.history.commit_graph import Graph, Node
from roverlink.generator.lint.history.numbered_types import NumberedType, NumberedTypes
from roverlink.generator.protos.schema import Fact

Declared = Mapping[str, NumberedType]
"""The declarations of one message or enum at one commit, by the path of the file. Usually there is only one."""
Lifetimes = frozenset[int]
"""Indices of the lifetimes of a fact (a declared field or enum value) that have not ended at a commit.

There are several if the fact began separately on branches that were merged later.
"""
Alive = Mapping[Fact, Lifetimes]

_NOTHING: Alive = {}


@dataclass(slots=True)
class Lifetime:
    """The time of a fact (a declared field or enum value), from the node that adds it to the nodes that delete it.

    A node is the index of a commit in the `Graph`. Different branches may delete the fact in different commits.
    """

    fact: Fact
    came: int
    path: str
    line: int
    went: list[int] = field(default_factory=list)
    faded: list[int] = field(default_factory=list)
    """Merge nodes at which the fact ended because a commit on another line of history had deleted it."""


@dataclass(slots=True)
class State:
    """All messages and enums at one commit, by full name, and the lifetimes of their facts (fields and values).

    The inner mappings are never changed.
    """

    declared: dict[str, Declared] = field(default_factory=dict)
    alive: dict[str, Alive] = field(default_factory=dict)

    def copy(self) -> State:
        """Return a copy that may be changed; the inner mappings are shared with this state."""
        return State(dict(self.declared), dict(self.alive))


@dataclass(slots=True)
class Lineage:
    """Result of the walk over the history: the lifetimes of all facts, and the changes of all messages and enums."""

    lifetimes: dict[str, list[Lifetime]] = field(default_factory=dict)
    """The lifetimes of all facts (fields and enum values) of each message and enum, by its full name."""
    changes: dict[str, dict[int, Declared]] = field(default_factory=dict)
    """The declarations of each message and enum, at each node where they differ from those at the first parent."""
    tips: dict[int, State] = field(default_factory=dict)


def sweep(graph: Graph, types_of: Callable[[str], NumberedTypes], tips: Collection[int]) -> Lineage:
    """Walk over all commits of the graph, parents first, and find when each field and enum value began and ended.

    ``types_of`` returns the messages and enums of a blob. The states at the nodes ``tips`` are kept for later queries.
    """
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
        """For each node, the number of children and tips that still need its state.

        The last child that needs a state may change it without making a copy.
        """
        for index in tips:
            self._needed[index] += 1
        for node in graph.nodes:
            for parent in node.parents:
                self._needed[parent] += 1
        self._tips = frozenset(tips)
        if Graph.BEGINNING in self._tips:
            self.lineage.tips[Graph.BEGINNING] = State()

    def visit(self, node: Node) -> None:
        """Find the facts (fields and enum values) that begin or end at a commit; its parents must have been visited."""
        # The edits are against the first parent (`--diff-merges=first-parent`), so the declarations of the other
        # parents are not needed. Their lifetimes are.
        others = [self._release(parent) for parent in node.parents[1:]]
        alive_there = [state.alive for state in others]
        state = self._take(node.parents[0])
        changed = self._edit(node, state)
        here = state.alive
        # Lines of history share the mappings of all messages that neither has changed since they diverged. So the
        # identity of two mappings tells that there is nothing to merge, without a look at their facts.
        for there in alive_there:
            if there is not here:
                changed |= {owner for owner, alive in there.items() if here.get(owner) is not alive}
                changed |= here.keys() - there.keys()
        # Sorted, because indices of lifetimes are handed out here, and the hash order of strings differs from run to
        # run.
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
        """Return the state at the node ``index``, as a state that the caller may change.

        This is a copy if other nodes still need the state.
        """
        state = self._release(index)
        return state.copy() if index in self._states else state

    def _release(self, index: int) -> State:
        state = self._states[index]
        self._needed[index] -= 1
        if not self._needed[index]:
            del self._states[index]
        return state

    def _edit(self, node: Node, state: State) -> set[str]:
        """Apply the changed files of a node to a state, and return the messages and enums whose facts changed."""
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
        """Begin and end lifetimes of facts at a node (a commit), and return the lifetimes that each fact has there.

        ``owner`` is the full name of the message or enum. ``befores`` has the lifetimes at each parent of the node.
        ``declared`` has the declarations at the node.
        """
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
        """Record that lifetimes of a fact (a field or enum value) end at a node (a commit).

        The node is added to ``went`` if it deletes the fact. It is added to ``faded`` if it is a merge, and a commit on
        another line of history has deleted the fact.
        """
        lacking = [parent for parent, before in zip(node.parents, befores) if fact not in before]
        for lifetime in lifetimes:
            known = any(self._graph.precedes(lifetime.came, parent) for parent in lacking)
            ended = lifetime.faded if known else lifetime.went
            if node.index not in ended:
                ended.append(node.index)


def _same(one: Declared, other: Declared) -> bool:
    """Return True if the same files declare the same facts of a message. The lines in the files may differ."""
    return one.keys() == other.keys() and all(
        declaration.facts.keys() == other[path].facts.keys() and declaration.broken == other[path].broken
        for path, declaration in one.items()
    )
