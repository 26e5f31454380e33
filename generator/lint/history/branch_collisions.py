"""Collisions of branches: numbers to which branches that are not merged yet have given different payloads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from roverlink.generator.lint.history.commits import Ref
from roverlink.generator.lint.history.judged_facts import differ
from roverlink.generator.lint.history.lineage import Lifetime
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.usage_model import Allocation, Collision
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
    told = [heads.pop(f"{_REMOTE}origin/HEAD", ""), *heads.values()]
    return next((name for name in (*told, *_DEFAULTS) if name in names), None)


def branch_name(ref: str) -> str:
    """Return the short name of a branch from its ref: ``main``, or ``origin/main`` for a remote branch."""
    return ref.removeprefix(_LOCAL).removeprefix(_REMOTE)


class Branches:
    """Comparison of the branches of a repository: finds numbers of one message that mean different payloads.

    ``owners`` are the ids of the message; several if several files declare its name. ``nodes`` has the graph's node of
    each branch's last commit.
    """

    def __init__(self, record: Record, owners: Sequence[int], nodes: Mapping[str, int]) -> None:
        self._record, self._owners, self._nodes = record, owners, nodes

    def collisions(self, default: str | None) -> list[Collision]:
        """Return the numbers to which branches have given different payloads since they diverged.

        A branch that is merged into the default branch is ignored. The local and the remote copy of a branch are not
        compared with each other. If one branch was built upon another, the two have no collision.
        """
        graph = self._record.graph
        trunk = self._nodes.get(default, 0) if default else 0
        open_refs = [ref for ref, node in self._nodes.items() if ref == default or not graph.precedes(node, trunk)]
        found: dict[int, dict[Fact, set[str]]] = {}
        for one, other in combinations(open_refs, 2):
            if _short(one) != _short(other):
                for number, fact, rival in self._between(self._nodes[one], self._nodes[other]):
                    uses = found.setdefault(number, {})
                    uses.setdefault(fact, set()).add(one)
                    uses.setdefault(rival, set()).add(other)
        return [
            Collision(number, tuple(self._allocation(fact, sorted(refs)) for fact, refs in sorted(uses.items())))
            for number, uses in sorted(found.items())
        ]

    def _between(self, one: int, other: int) -> Iterator[tuple[int, Fact, Fact]]:
        """Yield each number to which two branches have given different payloads, with both payloads.

        ``one`` and ``other`` are the nodes of the branches' last commits. Payloads that existed when the branches
        diverged are left out.
        """
        graph = self._record.graph
        # Criss-cross merges have several merge bases (git-merge-base(1)). Both branches know the declarations of each
        # merge base.
        known = set().union(*(self._facts(base) for base in graph.merge_bases(one, other)))
        ours, theirs = self._facts(one) - known, self._facts(other) - known
        old = {fact.number for fact in known}  # both sides may have renamed a payload that existed before
        # A fact on both sides is no collision: one branch picked it from the other one.
        for fact in sorted(ours - theirs):
            for rival in sorted(rival for rival in theirs - ours if rival.number == fact.number):
                new = fact.number not in old and fact.name != rival.name
                if new or differ((fact.type, fact.name), (rival.type, rival.name)):
                    yield fact.number, fact, rival

    def _facts(self, node: int) -> set[Fact]:
        return {
            fact
            for owner in self._owners
            for declaration in self._record.declared(owner, node).values()
            for fact in declaration.facts
            if not fact.claimed
        }

    def _allocation(self, fact: Fact, refs: Sequence[str]) -> Allocation:
        lifetime = next(lifetime for ref in refs for lifetime in self._lifetimes(fact, self._nodes[ref]))
        came = self._record.graph[lifetime.came].revision.commit
        return Allocation(tuple(refs), fact.type, fact.name, came, lifetime.path, lifetime.line)

    def _lifetimes(self, fact: Fact, node: int) -> Iterator[Lifetime]:
        """Yield the lifetimes of a fact (a declared field) that have not ended at the node, the latest first."""
        for owner in self._owners:
            lifetimes = self._record.lineage.tips[node].get(owner, {}).get(fact, frozenset())
            yield from (self._record.lineage.lifetimes[owner][index] for index in sorted(lifetimes, reverse=True))


def _short(ref: str) -> str:
    """Return a branch's name from its ref, without the remote: ``main`` for ``refs/remotes/origin/main``."""
    return ref.removeprefix(_REMOTE).partition("/")[2] if ref.startswith(_REMOTE) else ref.removeprefix(_LOCAL)
