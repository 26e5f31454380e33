"""Relations in time between the usages of one number, by the graph of commits."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import combinations

from roverlink.generator.lint.history.lineage import Declared
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.usage_model import Relation
from roverlink.generator.lint.history.usages import Stretch, TracedUsage
from roverlink.generator.protos.schema import Fact


class Relations:
    """Queries about the usages of the numbers of one message or enum."""

    def __init__(self, record: Record, owners: Sequence[str]) -> None:
        self._record, self._graph = record, record.graph
        self._times = cache(self._find_times)
        self._together: set[frozenset[Fact]] = set()
        for owner in owners:
            for declared in record.lineage.changes.get(owner, {}).values():
                self._note_together(declared)

    def _note_together(self, declared: Declared) -> None:
        facts = {fact for declaration in declared.values() for fact in declaration.facts if not fact.claimed}
        # Almost every state gives each number once. This test spares the pairs of all other states.
        if len({fact.number for fact in facts}) == len(facts):
            return
        uses: dict[int, list[Fact]] = {}
        for fact in facts:
            uses.setdefault(fact.number, []).append(fact)
        self._together.update(frozenset(pair) for same in uses.values() for pair in combinations(same, 2))

    def together(self, one: Fact, other: Fact) -> bool:
        """Return True if both facts were declared together at some commit."""
        return frozenset((one, other)) in self._together

    def relation(self, earlier: TracedUsage, later: TracedUsage) -> Relation:
        """Return if two usages existed together, one after the other, or on different branches."""
        if self.together(earlier.usage.fact, later.usage.fact):
            return Relation.TOGETHER
        return Relation.SUCCESSION if earlier is later or self._handovers(earlier, later) else Relation.BRANCHES

    def hands_over(self, earlier: TracedUsage, later: TracedUsage) -> bool:
        """Return True if one commit deleted the earlier usage and added the later one."""
        return any(went == stretch.lifetime.came for _, went, stretch in self._handovers(earlier, later))

    def nodes(self, earlier: TracedUsage, later: TracedUsage) -> tuple[int, int]:
        """Return the last node that has the earlier usage, and the first node that has the later one.

        If possible, both nodes are on the same line of history.
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
            for name in [type] if type else self._record.of_simple_name(use.usage.type):
                changes = self._record.lineage.changes[name]
                nodes |= {node for node in changes if self._record.has(stretch.owner, stretch.lifetime.fact, node)}
            nodes.add(stretch.lifetime.came)
        return sorted(nodes)

    def overlap(self, one: TracedUsage, other: TracedUsage) -> bool:
        """Return True if both usages existed at the same time, on any branch."""
        return any(
            max(came, other_came) < min(went, other_went)
            for came, went in self._times(one)
            for other_came, other_went in self._times(other)
        )

    def _find_times(self, use: TracedUsage) -> list[tuple[float, float]]:
        """Return the start and the end of each lifetime of a usage, in seconds since 1970.

        The end is infinite if the fact still exists.
        """
        return [self._time(stretch) for stretch in use.stretches]

    def _time(self, stretch: Stretch) -> tuple[float, float]:
        lifetime = stretch.lifetime
        # Separate branches have no order in the graph, so only the clocks of the committers can tell if both were in
        # use at once.
        ends = [self._graph[node].revision.time for node in (*lifetime.went, *lifetime.faded)]
        lasts = stretch.live_at or not ends
        return self._graph[lifetime.came].revision.time, float("inf") if lasts else max(ends)

    def _handovers(self, earlier: TracedUsage, later: TracedUsage) -> list[tuple[Stretch, int, Stretch]]:
        """Return each pair of lifetimes of which the second begins at or after the end of the first.

        The first is a lifetime of the earlier usage, the second of the later one. Between the two stands the node at
        which the first ends.
        """
        return [
            (stretch, went, successor)
            for stretch in earlier.stretches
            for went in stretch.lifetime.went
            for successor in later.stretches
            if self._graph.precedes(went, successor.lifetime.came)
        ]
