"""Collisions of branches: numbers to which branches that are not merged yet have given different meanings."""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence, Set
from itertools import combinations, product

from roverlink.generator.lint.comparison.judgement import Judgement, Meaning, gravest
from roverlink.generator.lint.history.commits import Ref
from roverlink.generator.lint.history.lineage import Lifetime
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.node_judgement import FactAtNode, judge_facts
from roverlink.generator.lint.history.usage_model import Allocation, Collision
from roverlink.generator.lint.names.value_names import shared_words
from roverlink.generator.protos.schema import Fact

_LOCAL, _REMOTE = "refs/heads/", "refs/remotes/"
_DEFAULTS = tuple(f"{place}{name}" for name in ("main", "master") for place in (_LOCAL, f"{_REMOTE}origin/"))


def branches(refs: Sequence[Ref]) -> dict[str, str]:
    """Return the last commit of each local and remote branch, by ref. HEAD is included if it is on no branch."""
    # A symbolic ref, such as refs/remotes/origin/HEAD, is a second name of a branch that is listed itself.
    return {
        ref.name: ref.commit
        for ref in refs
        if not ref.target and (ref.name == "HEAD" or ref.name.startswith((_LOCAL, _REMOTE)))
    }


def default_branch(refs: Sequence[Ref]) -> str | None:
    """Return the full ref of the default branch, into which others are merged; None if there is none."""
    names = branches(refs)
    # `git clone` writes refs/remotes/<remote>/HEAD: a symbolic ref to the default branch of the remote (git-remote(1),
    # set-head). A repository that was made with `git init` has none, and then the usual names decide.
    heads = {ref.name: ref.target for ref in refs if ref.name.startswith(_REMOTE) and ref.name.endswith("/HEAD")}
    of_remotes = [heads.pop(f"{_REMOTE}origin/HEAD", ""), *heads.values()]
    return next((name for name in (*of_remotes, *_DEFAULTS) if name in names), None)


def branch_name(ref: str) -> str:
    """Return the short name of a branch from its ref: ``main``, or ``origin/main`` for a remote branch."""
    return ref.removeprefix(_LOCAL).removeprefix(_REMOTE)


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
        found = [(owners, collision) for owners in self._changed() for collision in self._collisions_of(owners)]
        if found:
            inside = {id for node in set(self._open.values()) for id in self._record.reachable(envelopes, node)}
            yield from sorted(
                (collision for owners, collision in found if not inside.isdisjoint(owners)),
                key=lambda collision: (collision.owner, collision.number),
            )

    def _changed(self) -> list[set[int]]:
        """Return the messages and enums that differ between open branches.

        An item has several ids if branches have declared the same full name independently of each other.
        """
        tips = [self._record.lineage.tips[node] for node in set(self._open.values())]
        # Branches share the mapping of a type that none of them has changed, so that its identity tells most of it.
        changed = {id for tip in tips for id in tip if any(other.get(id) is not tip[id] for other in tips)}
        names = {id: self._names(id) for id in sorted(changed)}
        ids: dict[str, set[int]] = {}
        for id, of_id in names.items():
            for name in of_id:
                ids.setdefault(name, set()).add(id)
        groups = []
        while names:
            group, waiting = set[int](), [next(iter(names))]
            while waiting:
                if (id := waiting.pop()) not in group:
                    group.add(id)
                    waiting += [other for name in names.pop(id) for other in ids[name]]
            groups.append(group)
        return groups

    def _names(self, id: int) -> set[str]:
        """Return the full names of a message or enum on the open branches."""
        return {place.name for node in set(self._open.values()) for place in self._record.declared(id, node)}

    def _collisions_of(self, owners: Set[int]) -> Iterator[Collision]:
        """Yield the collisions of a message or enum, whose ids on the branches are ``owners``."""
        refs: dict[frozenset[Fact], list[str]] = {}
        for ref, node in self._open.items():
            refs.setdefault(frozenset(self._facts(owners, node)), []).append(ref)
        uses: dict[tuple[str, int], dict[Fact, set[str]]] = {}
        judged: dict[tuple[str, int], list[Judgement]] = {}
        for ours, theirs in combinations(refs, 2):
            rivals = _rivals(ours, theirs)
            for one, other in product(refs[ours], refs[theirs]) if rivals else ():
                if _short(one) != _short(other):
                    for name, fact, rival, judgement in self._between(
                        owners, rivals, self._open[one], self._open[other]
                    ):
                        of_number = uses.setdefault((name, fact.number), {})
                        of_number.setdefault(fact, set()).add(one)
                        of_number.setdefault(rival, set()).add(other)
                        judged.setdefault((name, fact.number), []).append(judgement)
        for (name, number), facts in uses.items():
            allocations = (self._allocation(owners, fact, sorted(facts[fact])) for fact in sorted(facts))
            found = gravest(judged[name, number])
            yield Collision(name, number, tuple(allocations), found.certain, found.reason)

    def _between(
        self, owners: Set[int], rivals: Sequence[tuple[Fact, Fact]], one: int, other: int
    ) -> Iterator[tuple[str, Fact, Fact, Judgement]]:
        """Yield each two facts by which two branches gave one number different meanings, with the judgement.

        The first item is the full name of the message or enum. ``rivals`` are the facts of the two branches with the
        same number. ``one`` and ``other`` are the nodes of the branches' last commits. Facts that existed when the
        branches diverged are left out.
        """
        names_at, ours, theirs = self._record.names_at, self._facts(owners, one), self._facts(owners, other)
        for owner, their_owner in product(sorted(owners), repeat=2):
            shared = names_at(owner, one) & names_at(their_owner, other)
            if owner != their_owner and not shared:
                continue
            known = self._known(owners, owner if owner == their_owner else None, shared, one, other)
            name = self._record.types[owner].name if owner == their_owner else min(shared)
            for fact, rival in rivals:
                if ours[fact].owner == owner and theirs[rival].owner == their_owner:
                    judged = self._judge_rivals(ours, theirs, known, fact, rival)
                    if judged is not None:
                        yield name, fact, rival, judged

    def _known(
        self, owners: Set[int], owner: int | None, names: Set[str], one: int, other: int
    ) -> dict[Fact, FactAtNode]:
        """Return the facts that two branches had in common when they diverged.

        These are the facts of the message or enum ``owner``, and of all that had one of the full names ``names``. A
        type that only one of the branches renamed has nothing in common with the type that the other one has added.
        """
        # Criss-cross merges have several merge bases (git-merge-base(1)). Both branches know the declarations of each
        # merge base.
        return {
            fact: at
            for base in self._graph.merge_bases(one, other)
            for id in owners
            if id == owner or not names.isdisjoint(self._record.names_at(id, base))
            for fact, at in self._facts({id}, base).items()
        }

    def _judge_rivals(
        self,
        ours: Mapping[Fact, FactAtNode],
        theirs: Mapping[Fact, FactAtNode],
        known: Mapping[Fact, FactAtNode],
        fact: Fact,
        rival: Fact,
    ) -> Judgement | None:
        """Judge two facts with one number on two branches; None if it keeps its meaning, or none of them is new."""
        if fact in known or rival in known or _are_aliases(fact, ours, theirs, known):
            return None
        judged = self._judge(ours[fact], theirs[rival], ours, theirs)
        # Both sides may have renamed a field that existed before. As in `Reuses`, a chain of renames with doubts
        # proves nothing, but it does not prove the contrary either.
        passes = _is_uncertain if judged.certain else _keeps
        linked = any(
            passes(self._judge(at, ours[fact], known, ours)) and passes(self._judge(at, theirs[rival], known, theirs))
            for old, at in known.items()
            if old.number == fact.number
        )
        return None if _keeps(judged) or linked else judged

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

    def _facts(self, owners: Set[int], node: int) -> dict[Fact, FactAtNode]:
        return {
            fact: FactAtNode(owner, fact, node)
            for owner in sorted(owners)
            for declaration in self._record.declared(owner, node).values()
            for fact in declaration.facts
            if not fact.claimed
        }

    def _allocation(self, owners: Set[int], fact: Fact, refs: Sequence[str]) -> Allocation:
        lifetime = next(lifetime for ref in refs for lifetime in self._lifetimes(owners, fact, self._open[ref]))
        came = self._graph[lifetime.came].revision.commit
        return Allocation(tuple(refs), fact.type, fact.name, came, lifetime.path, lifetime.line)

    def _lifetimes(self, owners: Set[int], fact: Fact, node: int) -> Iterator[Lifetime]:
        """Yield the lifetimes of a fact that have not ended at the node, the latest first."""
        for owner in sorted(owners):
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


def _short(ref: str) -> str:
    """Return a branch's name from its ref, without the remote: ``main`` for ``refs/remotes/origin/main``."""
    return ref.removeprefix(_REMOTE).partition("/")[2] if ref.startswith(_REMOTE) else ref.removeprefix(_LOCAL)
