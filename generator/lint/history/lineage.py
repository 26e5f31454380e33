"""Walk over all commits, parents before children, that finds when each fact of each type begins and ends.

A type is a message or an enum, which keeps its id when its full name or its file changes (see `identities`). A fact is
the declaration of a field or an enum value, without its place in the file. A line of history is a chain of commits,
such as a branch. A fact may begin and end several times, and at other commits on each line of history. So the walk
keeps, for each line, the lifetimes of facts that have not ended there. Rules for a merge:

- A fact begins at the merge only if no parent has it. Otherwise its lifetimes in the parents continue.
- A fact ends at the merge only if the merge itself deletes it. If a parent without the fact had it before, a commit on
  that line deleted it, and the merge only takes over the deletion.
- If a fact began separately on both sides, the merge continues both lifetimes. They end together.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from roverlink.generator.lint.history.commit_graph import Graph, Lines, Node
from roverlink.generator.lint.history.continuations import Declarations, Place
from roverlink.generator.lint.history.identities import Labels, identities
from roverlink.generator.lint.history.numbered_types import NumberedType, NumberedTypes
from roverlink.generator.protos.schema import Fact

Lifetimes = frozenset[int]
"""Indices of the lifetimes of a fact (a declared field or enum value) that have not ended at a commit.

There are several if the fact began separately on branches that were merged later.
"""
Alive = Mapping[Fact, Lifetimes]

_NOTHING: Alive = {}
_NOWHERE: Declarations = {}
_UNLABELLED: Labels = {}


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


@dataclass(slots=True)
class State:
    """All messages and enums at one commit, by id, and the lifetimes of their facts (fields and values).

    The inner mappings are never changed.
    """

    labels: dict[str, Labels] = field(default_factory=dict)
    """The ids of the types in each file, by path."""
    declared: dict[int, Declarations] = field(default_factory=dict)
    """The declarations of each type. Usually there is only one."""
    alive: dict[int, Alive] = field(default_factory=dict)

    def copy(self) -> State:
        """Return a copy that may be changed; the inner mappings are shared with this state."""
        return State(dict(self.labels), dict(self.declared), dict(self.alive))


@dataclass(slots=True)
class Lineage:
    """Result of the walk over the history: the lifetimes of all facts, and the changes of all messages and enums."""

    lifetimes: dict[int, list[Lifetime]] = field(default_factory=dict)
    """The lifetimes of all facts (fields and enum values) of each message and enum, by the type's id."""
    changes: dict[int, dict[int, Declarations]] = field(default_factory=dict)
    """The declarations of each message and enum, at each node where they differ from those at the first parent."""
    tips: dict[int, Mapping[int, Alive]] = field(default_factory=dict)
    """The lifetimes of the facts that the last commits of the branches have, by node and by the type's id."""


def sweep(graph: Graph, types_of: Callable[[str | None], NumberedTypes], tips: Collection[int]) -> Lineage:
    """Walk over all commits of the graph, parents first, and find when each field and enum value began and ended.

    ``types_of`` returns the messages and enums of a blob. The facts at the nodes ``tips`` are kept for later queries.
    """
    walk = _Sweep(graph, types_of, tips)
    for node in graph.nodes:
        walk.visit(node)
    return walk.lineage


class _Sweep:
    def __init__(self, graph: Graph, types_of: Callable[[str | None], NumberedTypes], tips: Collection[int]) -> None:
        self.lineage = Lineage()
        self._graph, self._types_of = graph, types_of
        self._labels = identities(graph, types_of)
        self._lines = Lines(graph, State())
        self._tips = frozenset(tips)
        if Graph.BEGINNING in self._tips:
            self.lineage.tips[Graph.BEGINNING] = {}

    def visit(self, node: Node) -> None:
        """Find the facts (fields and enum values) that begin or end at a commit; its parents must have been visited."""
        # The edits are against the first parent (`--diff-merges=first-parent`), so the declarations of the other
        # parents are not needed. Their lifetimes are.
        others = [self._lines.release(parent) for parent in node.parents[1:]]
        alive_there = [state.alive for state in others]
        state = self._lines.take(node.parents[0])
        changed = self._edit(node, state)
        here = state.alive
        # Lines of history share the mappings of all messages that neither has changed since they diverged. So the
        # identity of two mappings usually tells that there is nothing to merge, without a look at their facts.
        for there in alive_there:
            if there is not here:
                changed |= {
                    type
                    for type, alive in there.items()
                    if type not in here or (here[type] is not alive and here[type] != alive)
                }
                changed |= here.keys() - there.keys()
        for type in changed:
            befores = [alive.get(type, _NOTHING) for alive in (here, *alive_there)]
            here[type] = self._settle(node, type, befores, state.declared.get(type, _NOWHERE))
        self._lines.keep(node.index, state)
        if node.index in self._tips:
            self.lineage.tips[node.index] = dict(state.alive)  # a child may change the state

    def _edit(self, node: Node, state: State) -> set[int]:
        """Apply the changed files of a node to a state, and return the messages and enums whose facts changed."""
        before: dict[int, Declarations] = {}
        labels_here = self._labels.get(node.index, {})
        for edit in node.revision.edits:
            was = state.labels.get(edit.path, _UNLABELLED)
            self._replace(state, edit.path, labels_here.get(edit.path, was), self._types_of(edit.new), before)
        edited = {edit.path for edit in node.revision.edits}
        for path in labels_here.keys() - edited:  # another parent of a merge gave the name to another type
            types = {name: state.declared[id][Place(path, name)] for name, id in state.labels[path].items()}
            self._replace(state, path, labels_here[path], types, before)
        changed = set()
        for type, was_declared in before.items():
            if not _same(was_declared, state.declared[type]):
                self.lineage.changes.setdefault(type, {})[node.index] = state.declared[type]
                changed.add(type)
        return changed

    def _replace(
        self, state: State, path: str, labels: Labels, types: NumberedTypes, before: dict[int, Declarations]
    ) -> None:
        """Replace the types of a file in a state, and add the former declarations of the changed ones to ``before``."""
        was = state.labels.get(path, _UNLABELLED)
        for name, id in was.items():
            if labels.get(name) != id:
                self._declare(state, id, Place(path, name), None, before)
        for name, id in labels.items():
            self._declare(state, id, Place(path, name), types[name], before)
        if labels:
            state.labels[path] = labels
        else:
            state.labels.pop(path, None)

    def _declare(
        self, state: State, id: int, place: Place, type: NumberedType | None, before: dict[int, Declarations]
    ) -> None:
        was = state.declared.get(id, _NOWHERE)
        known = was.get(place)
        if type is not None and known is not None and _equal(known, type):
            return
        before.setdefault(id, was)
        others = {other: declared for other, declared in was.items() if other != place}
        state.declared[id] = others if type is None else {**others, place: type}

    def _settle(self, node: Node, type: int, befores: list[Alive], declared: Declarations) -> Alive:
        """Begin and end lifetimes of facts at a node (a commit), and return the lifetimes that each fact has there.

        ``type`` is the id of the message or enum. ``befores`` has the lifetimes at each parent of the node.
        ``declared`` has the declarations at the node.
        """
        lifetimes = self.lineage.lifetimes.setdefault(type, [])
        after: dict[Fact, Lifetimes] = {}
        for (path, _), declaration in declared.items():
            for fact, offset in zip(declaration.facts, declaration.offsets):
                if fact not in after:
                    held = [before[fact] for before in befores if fact in before]
                    if not held:
                        held.append(frozenset((len(lifetimes),)))
                        lifetimes.append(Lifetime(fact, node.index, path, declaration.line + offset))
                    first, *others = held
                    after[fact] = first.union(*others) if others else first
        for before in befores:
            for fact in before.keys() - after.keys():
                self._end(node, fact, befores, [lifetimes[index] for index in sorted(before[fact])])
        return after

    def _end(self, node: Node, fact: Fact, befores: list[Alive], lifetimes: list[Lifetime]) -> None:
        """Record that lifetimes of a fact (a field or enum value) end at a node (a commit).

        A merge is left out for those lifetimes that a commit on another line of history has ended.
        """
        lacking = [parent for parent, before in zip(node.parents, befores) if fact not in before]
        for lifetime in lifetimes:
            known = any(self._graph.precedes(lifetime.came, parent) for parent in lacking)
            if not known and node.index not in lifetime.went:
                lifetime.went.append(node.index)


def _same(one: Declarations, other: Declarations) -> bool:
    """Return True if the same files declare the same facts of a message. The lines in the files may differ."""
    return one.keys() == other.keys() and all(_equal(type, other[place]) for place, type in one.items())


def _equal(one: NumberedType, other: NumberedType) -> bool:
    return one is other or (one.facts == other.facts and one.broken == other.broken)
