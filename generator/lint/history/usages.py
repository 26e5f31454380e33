"""Usages (meanings) of numbers: each usage combines the lifetimes of equal facts in the history."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from roverlink.generator.lint.history.lineage import Alive, Lifetime
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.uncommitted import UNCOMMITTED
from roverlink.generator.lint.history.usage_model import Interval, Usage
from roverlink.generator.protos.schema import Fact


@dataclass(frozen=True, slots=True)
class Stretch:
    """A time during which the message or enum ``owner`` (an id) had a fact, and the branches that still have the fact.

    A fact is the declaration of a field or an enum value.
    """

    owner: int
    lifetime: Lifetime
    live_at: tuple[str, ...]

    @property
    def order(self) -> tuple[int, str, int]:
        """A sort key: the earliest lifetime comes first."""
        return self.lifetime.came, self.lifetime.path, self.lifetime.line


@dataclass(frozen=True, slots=True, eq=False)
class TracedUsage:
    """One meaning of a number (a usage), with all times during which its declaration existed."""

    usage: Usage
    stretches: tuple[Stretch, ...]


def usages(
    record: Record,
    owners: Sequence[int],
    branches: Mapping[str, int],
    claimed: bool,
    elsewhere: Iterable[tuple[int, str]] = (),
) -> list[TracedUsage]:
    """Return the usages (meanings) of all numbers of a message or enum, sorted by number and age.

    ``owners`` are the ids of the message or enum; several if several files declare its name. ``elsewhere`` are the ids
    of types that other branches declare under its full name, each with this name: only what they had under this name
    counts. If ``claimed`` is True, only the usages in commented-out declarations are returned, and otherwise only those
    in real declarations.
    """
    named = dict(elsewhere)
    broken = record.only_in_broken_files((*owners, *named))
    stretches: dict[Fact, list[Stretch]] = {}
    for owner in (*owners, *named):
        refs, facts = branches, None
        if name := named.get(owner):
            refs = {ref: node for ref, node in branches.items() if name in record.names_at(owner, node)}
            facts = record.facts_under(owner, name)
        live_at = _live_at(record, owner, refs)
        for index, lifetime in record.lifetimes(owner):
            if lifetime.fact.claimed == claimed and (facts is None or lifetime.fact in facts):
                stretch = Stretch(owner, lifetime, tuple(live_at.get(index, ())))
                stretches.setdefault(lifetime.fact, []).append(stretch)
    found = [
        _traced(record, sorted(parts, key=lambda part: part.order), fact in broken) for fact, parts in stretches.items()
    ]
    return sorted(found, key=lambda traced: (traced.usage.number, traced.stretches[0].order, traced.usage.fact))


def _live_at(record: Record, owner: int, branches: Mapping[str, int]) -> dict[int, list[str]]:
    """Return the branches on which each lifetime of the message ``owner`` has not ended, by the lifetime's index.

    The working tree or the index is named only if no branch has the lifetime's fact.
    """
    # Most branches share the mapping of a message that none of them has changed.
    refs_of = defaultdict[int, list[str]](list)
    alive_by_id: dict[int, Alive] = {}
    for ref, node in branches.items():
        alive = record.lineage.tips[node].get(owner)
        if alive and ref not in UNCOMMITTED:
            refs_of[id(alive)].append(ref)
            alive_by_id[id(alive)] = alive
    found = defaultdict[int, list[str]](list)
    for key, refs in refs_of.items():
        for lifetimes in alive_by_id[key].values():
            for index in lifetimes:
                found[index] += refs
    for ref in branches.keys() & UNCOMMITTED:
        for lifetimes in record.lineage.tips[branches[ref]].get(owner, {}).values():
            for index in lifetimes - found.keys():
                found[index] = [ref]
    return found


def _traced(record: Record, stretches: Sequence[Stretch], broken: bool) -> TracedUsage:
    fact = stretches[0].lifetime.fact
    refs = sorted({ref for stretch in stretches for ref in stretch.live_at})
    went = max((node for stretch in stretches for node in stretch.lifetime.went), default=None)
    usage = Usage(
        number=fact.number,
        type=fact.type,
        name=fact.name,
        label=fact.label,
        oneof=fact.oneof,
        json_name=fact.json_name,
        intervals=tuple(_interval(record, stretch) for stretch in stretches),
        live_at=tuple(refs),
        went=None if refs or went is None else record.graph[went].revision.commit,
        broken=broken,
    )
    return TracedUsage(usage, tuple(stretches))


def _interval(record: Record, stretch: Stretch) -> Interval:
    lifetime = stretch.lifetime
    came = record.graph[lifetime.came].revision.commit
    went = tuple(record.graph[node].revision.commit for node in lifetime.went)
    return Interval(came, went, lifetime.path, lifetime.line)
