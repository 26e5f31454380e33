"""Relations in time between the usages (meanings) of one number: one after the other, or on different branches.

The graph of commits shows the order; the times of commits do not count.
"""

from __future__ import annotations

from bisect import bisect_left
from functools import cache
from itertools import combinations, islice
from typing import NamedTuple

from roverlink.generator.lint.history.continuations import Declarations
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.usage_model import Relation
from roverlink.generator.lint.history.usages import Stretch, TracedUsage
from roverlink.generator.protos.schema import Fact


class _Handover(NamedTuple):
    """A node (a commit) that ends a lifetime of a usage, and a lifetime of another usage that begins there or later."""

    ended: Stretch
    went: int
    successor: Stretch


class Relations:
    """Queries about the relations in time between usages of the numbers of one message or enum."""

    def __init__(self, record: Record, owner: int) -> None:
        self._record, self._graph = record, record.graph
        self._ends, self._begins = cache(_find_ends), cache(_find_begins)
        self._together: set[frozenset[Fact]] = set()
        for declared in record.lineage.changes[owner].values():
            self._note_together(declared)

    def _note_together(self, declared: Declarations) -> None:
        facts = {fact for declaration in declared.values() for fact in declaration.facts if not fact.claimed}
        # In almost every state, each number has one fact. Then there are no pairs, and the rest is not needed.
        if len({fact.number for fact in facts}) == len(facts):
            return
        uses: dict[int, list[Fact]] = {}
        for fact in facts:
            uses.setdefault(fact.number, []).append(fact)
        self._together.update(frozenset(pair) for same in uses.values() for pair in combinations(same, 2))

    def together(self, one: Fact, other: Fact) -> bool:
        """Return True if some commit declares both facts (fields or enum values)."""
        return frozenset((one, other)) in self._together

    def relation(self, earlier: TracedUsage, later: TracedUsage) -> Relation:
        """Return the relation of two usages in time: in one commit, one after the other, or on different branches."""
        if self.together(earlier.usage.fact, later.usage.fact):
            return Relation.TOGETHER
        return Relation.SUCCESSION if earlier is later or self._handover(earlier, later) else Relation.BRANCHES

    def handovers(self, earlier: TracedUsage, later: TracedUsage) -> list[int]:
        """Return the nodes (commits) that deleted the earlier usage (meaning) of a number and added the later usage."""
        ends = {went for went, _ in self._ends(earlier)}
        return [came for came in map(_came, later.stretches) if came in ends]

    def nodes(self, earlier: TracedUsage, later: TracedUsage) -> tuple[int, int]:
        """Return the last node (commit) that has the earlier usage, and the first node that has the later usage.

        If possible, the second node is a descendant of the first node.
        """
        if handover := self._handover(earlier, later):
            ended, went, successor = handover
            return self._record.before(ended.owner, ended.lifetime.fact, went), successor.lifetime.came
        stretch = earlier.stretches[-1]
        end = max(stretch.lifetime.went, default=None)
        last = stretch.lifetime.came if end is None else self._record.before(stretch.owner, stretch.lifetime.fact, end)
        return last, later.stretches[0].lifetime.came

    def nodes_of_content(self, use: TracedUsage) -> list[int]:
        """Return the nodes at which the content of a field's type may have changed.

        These are the nodes that change the type while the field exists, and the nodes that add the field.
        """
        nodes = set()
        for stretch in use.stretches:
            type = self._record.resolve(use.usage.type, stretch.owner, stretch.lifetime.came)
            known = self._record.once_resolved(use.usage.type, stretch.owner, stretch.lifetime.came)
            for id in known if type is None else [type]:
                changes = self._record.lineage.changes[id]
                nodes |= {node for node in changes if self._record.has(stretch.owner, stretch.lifetime.fact, node)}
            nodes.add(stretch.lifetime.came)
        return sorted(nodes)

    def _handover(self, earlier: TracedUsage, later: TracedUsage) -> _Handover | None:
        """Return the latest case in which the later usage begins after the earlier usage has ended; None if none.

        A usage can have several lifetimes, because a field can be removed and added again.
        """
        begins = self._begins(later)
        for went, stretch in self._ends(earlier):
            # Parents come before children, so nothing before this position follows.
            for successor in islice(begins, bisect_left(begins, went, key=_came), None):
                if self._graph.precedes(went, _came(successor)):
                    return _Handover(stretch, went, successor)
        return None


def _find_ends(use: TracedUsage) -> list[tuple[int, Stretch]]:
    """Return the nodes that end a lifetime of the usage, the latest first, each with the lifetime."""
    ends = [(went, stretch) for stretch in use.stretches for went in stretch.lifetime.went]
    return sorted(ends, key=lambda end: -end[0])


def _find_begins(use: TracedUsage) -> list[Stretch]:
    """Return the lifetimes of the usage, the earliest first."""
    return sorted(use.stretches, key=_came)


def _came(stretch: Stretch) -> int:
    return stretch.lifetime.came
