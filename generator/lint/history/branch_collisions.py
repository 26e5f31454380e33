"""Collisions of branches: numbers to which branches that are not merged yet have given different meanings."""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence, Set
from itertools import combinations, product
from typing import NamedTuple

from roverlink.generator.lint.comparison.judgement import Judgement, Meaning, gravest
from roverlink.generator.lint.history.branch_names import short_name
from roverlink.generator.lint.history.lineage import Lifetime
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.node_judgement import FactAtNode, judge_facts
from roverlink.generator.lint.history.usage_model import Allocation, Collision
from roverlink.generator.lint.names.value_names import shared_words
from roverlink.generator.protos.schema import Fact


class _Subject(NamedTuple):
    """A message or enum on several branches."""

    ids: frozenset[int]
    name: str = ""
    """The full name that several types have; then each of the ids counts only where it has this name.

    Empty for a single type, which is followed through its names.
    """


class Branches:
    """Comparison of the open branches of a repository: finds numbers that were given to different fields or values.

    ``nodes`` has the graph's node of each branch's last commit. ``default`` is the default branch, if there is one. A
    branch that is merged into the default branch is not open.
    """

    def __init__(self, record: Record, nodes: Mapping[str, int], default: str | None) -> None:
        self._record, self._graph = record, record.graph
        trunk = nodes.get(default, 0) if default else 0
        self._open = {
            ref: node for ref, node in nodes.items() if ref == default or not record.graph.precedes(node, trunk)
        }

    def collisions(self, envelopes: Sequence[int]) -> Iterator[Collision]:
        """Yield the numbers to which branches have given different meanings since they diverged, sorted by name.

        ``envelopes`` are the ids of the envelope's message. It and all messages and enums that it can contain on one of
        the branches are compared. The local and the remote copy of a branch are not compared with each other. If one
        branch was built upon another, the two have no collision.
        """
        found = [(subject.ids, each) for subject in self._changed() for each in self._collisions_of(subject)]
        if found:
            inside = {id for node in set(self._open.values()) for id in self._record.reachable(envelopes, node)}
            yield from sorted(
                (collision for ids, collision in found if not inside.isdisjoint(ids)),
                key=lambda collision: (collision.owner, collision.number),
            )

    def _changed(self) -> Iterator[_Subject]:
        """Yield the messages and enums that differ between open branches.

        Each type is followed through its names. Types of one name are also compared by this name: branches may have
        given it to types of their own.
        """
        nodes = set(self._open.values())
        tips = [self._record.lineage.tips[node] for node in nodes]
        # Branches share the mapping of a type that none of them has changed, so that its identity tells most of it.
        changed = {id for tip in tips for id in tip if any(other.get(id) is not tip[id] for other in tips)}
        ids: dict[str, set[int]] = {}
        for id in sorted(changed):
            yield _Subject(frozenset((id,)))
            for name in {name for node in nodes for name in self._record.names_at(id, node)}:
                ids.setdefault(name, set()).add(id)
        yield from (_Subject(frozenset(of_name), name) for name, of_name in ids.items() if len(of_name) > 1)

    def _collisions_of(self, subject: _Subject) -> Iterator[Collision]:
        """Yield the collisions of a message or enum."""
        refs: dict[frozenset[Fact], list[str]] = {}
        for ref, node in self._open.items():
            refs.setdefault(frozenset(self._facts(subject, node)), []).append(ref)
        uses: dict[int, dict[Fact, set[str]]] = {}
        judged: dict[int, list[Judgement]] = {}
        for ours, theirs in combinations(refs, 2):
            rivals = _rivals(ours, theirs)
            for one, other in product(refs[ours], refs[theirs]) if rivals else ():
                if short_name(one) != short_name(other):
                    for fact, rival, judgement in self._between(subject, rivals, self._open[one], self._open[other]):
                        of_number = uses.setdefault(fact.number, {})
                        of_number.setdefault(fact, set()).add(one)
                        of_number.setdefault(rival, set()).add(other)
                        judged.setdefault(fact.number, []).append(judgement)
        name = subject.name or self._record.types[min(subject.ids)].name
        naming = [commit for id in sorted(subject.ids) if subject.name for commit in self._record.naming(id, name)]
        for number, facts in uses.items():
            allocations = (self._allocation(subject, fact, sorted(facts[fact])) for fact in sorted(facts))
            found = gravest(judged[number])
            yield Collision(name, number, tuple(allocations), found.certain, found.reason, tuple(naming))

    def _between(
        self, subject: _Subject, rivals: Sequence[tuple[Fact, Fact]], one: int, other: int
    ) -> Iterator[tuple[Fact, Fact, Judgement]]:
        """Yield each two facts by which two branches gave one number different meanings, with the judgement.

        ``rivals`` are the facts of the two branches with the same number. ``one`` and ``other`` are the nodes of the
        branches' last commits. Facts that existed when the branches diverged are left out.
        """
        if subject.name and not self._owners(subject, one).isdisjoint(self._owners(subject, other)):
            return  # a type that both branches know is a subject of its own
        ours, theirs = self._facts(subject, one), self._facts(subject, other)
        # Criss-cross merges have several merge bases (git-merge-base(1)). Both branches know the declarations of each
        # merge base.
        bases = [self._facts(subject, base) for base in self._graph.merge_bases(one, other)]
        known = {fact: at for base in bases for fact, at in base.items()}
        for fact, rival in rivals:
            if fact in known or rival in known or _are_aliases(fact, ours, theirs, known):
                continue
            judged = self._judge(ours[fact], theirs[rival], ours, theirs)
            # Both sides may have renamed a field that existed before. As in `Reuses`, a chain of renames with doubts
            # proves nothing, but it does not prove the contrary either.
            passes = _is_uncertain if judged.certain else _keeps
            linked = any(
                passes(self._judge(at, ours[fact], known, ours))
                and passes(self._judge(at, theirs[rival], known, theirs))
                for old, at in known.items()
                if old.number == fact.number
            )
            if not _keeps(judged) and not linked:
                yield fact, rival, judged

    def _judge(
        self,
        old: FactAtNode,
        new: FactAtNode,
        beside_old: Collection[Fact],
        beside_new: Collection[Fact],
    ) -> Judgement:
        """Judge two facts, which may both still exist. So it does not matter which of them is the new one."""
        values = [fact.name for fact in (*beside_old, *beside_new) if not fact.type]
        shared = shared_words(self._record.types[old.owner].name.rpartition(".")[2], values) if values else frozenset()
        return gravest(
            judge_facts(self._record, one, other, _moved(other.fact, beside), at_once=True, shared=shared).judgement
            for one, other, beside in ((old, new, beside_old), (new, old, beside_new))
        )

    def _owners(self, subject: _Subject, node: int) -> set[int]:
        """Return the ids of the types that a subject means at a node."""
        return {id for id in subject.ids if not subject.name or subject.name in self._record.names_at(id, node)}

    def _facts(self, subject: _Subject, node: int) -> dict[Fact, FactAtNode]:
        return {
            fact: FactAtNode(owner, fact, node)
            for owner in sorted(self._owners(subject, node))
            for declaration in self._record.declared(owner, node).values()
            for fact in declaration.facts
            if not fact.claimed
        }

    def _allocation(self, subject: _Subject, fact: Fact, refs: Sequence[str]) -> Allocation:
        lifetime = next(lifetime for ref in refs for lifetime in self._lifetimes(subject, fact, self._open[ref]))
        came = self._graph[lifetime.came].revision.commit
        return Allocation(tuple(refs), fact.type, fact.name, came, lifetime.path, lifetime.line)

    def _lifetimes(self, subject: _Subject, fact: Fact, node: int) -> Iterator[Lifetime]:
        """Yield the lifetimes of a fact that have not ended at the node, the latest first."""
        for owner in sorted(self._owners(subject, node)):
            lifetimes = self._record.lineage.tips[node].get(owner, {}).get(fact, frozenset())
            yield from (self._record.lineage.lifetimes[owner][index] for index in sorted(lifetimes, reverse=True))


def _rivals(ours: Set[Fact], theirs: Set[Fact]) -> list[tuple[Fact, Fact]]:
    """Return each two facts of two branches that have the same number."""
    # A fact on both sides is no collision: one branch picked it from the other one.
    by_number: dict[int, list[Fact]] = {}
    for fact in sorted(theirs - ours):
        by_number.setdefault(fact.number, []).append(fact)
    return [(fact, rival) for fact in sorted(ours - theirs) for rival in by_number.get(fact.number, ())]


def _are_aliases(value: Fact, ours: Iterable[Fact], theirs: Iterable[Fact], known: Container[Fact]) -> bool:
    """Return True if the number of an enum value has a name that both branches know (``allow_alias``).

    Then the other names of the number are aliases of this one.
    """
    one, other = ({fact for fact in facts if fact.number == value.number} for facts in (ours, theirs))
    return not value.type and (not one.isdisjoint(other) or any(fact in known for fact in one | other))


def _keeps(judged: Judgement) -> bool:
    return judged.meaning in (Meaning.SAME, Meaning.RENAMED)


def _is_uncertain(judged: Judgement) -> bool:
    return not judged.certain


def _moved(fact: Fact, others: Iterable[Fact]) -> bool:
    """Return True if a fact with another number has the name of ``fact``."""
    return any(other.name == fact.name and other.number != fact.number for other in others)
