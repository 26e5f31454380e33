"""Relations in time between the usages (meanings) of one number: one after the other, or on different branches.

The graph of commits shows the order; the times of commits do not count.
"""

from __future__ import annotations

from itertools import combinations

from roverlink.generator.lint.history.continuations import Declarations
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.usage_model import Relation
from roverlink.generator.lint.history.usages import Stretch, TracedUsage
from roverlink.generator.protos.schema import Fact


class Relations:
    """Queries about the relations in time between usages of the numbers of one message or enum."""

    def __init__(self, record: Record, owner: int) -> None:
        self._record, self._graph = record, record.graph
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
        return Relation.SUCCESSION if earlier is later or self._handovers(earlier, later) else Relation.BRANCHES

    def hands_over(self, earlier: TracedUsage, later: TracedUsage) -> bool:
        """Return True if one commit deleted the earlier usage (meaning) of a number and added the later usage."""
        return any(went == stretch.lifetime.came for _, went, stretch in self._handovers(earlier, later))

    def nodes(self, earlier: TracedUsage, later: TracedUsage) -> tuple[int, int]:
        """Return the last node (commit) that has the earlier usage, and the first node that has the later usage.

        If possible, the second node is a descendant of the first node.
        """
        handovers = self._handovers(earlier, later)
        if handovers:
            stretch, went, successor = max(handovers, key=lambda each: (each[1], -each[2].lifetime.came))
            return self._record.before(stretch.owner, stretch.lifetime.fact, went), successor.lifetime.came
        stretch = earlier.stretches[-1]
        ended = max(stretch.lifetime.went, default=None)
        last = (
            stretch.lifetime.came if ended is None else self._record.before(stretch.owner, stretch.lifetime.fact, ended)
        )
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

    def _handovers(self, earlier: TracedUsage, later: TracedUsage) -> list[tuple[Stretch, int, Stretch]]:
        """Return each case in which the later usage begins after the earlier usage has ended.

        A usage can have several lifetimes, because a field can be removed and added again. Each item has a lifetime
        (`Stretch`) of the earlier usage, the node of git's history (a commit) that ends this lifetime, and a lifetime
        of the later usage that begins at this commit or at a descendant of it.
        """
        return [
            (stretch, went, successor)
            for stretch in earlier.stretches
            for went in stretch.lifetime.went
            for successor in later.stretches
            if self._graph.precedes(went, successor.lifetime.came)
        ]
