"""Spans put together into usages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from roverlink.generator.lint.history.lineage import Span
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.usage_model import Confidence, Interval, Usage
from roverlink.generator.protos.schema import Fact


@dataclass(frozen=True, slots=True)
class Stretch:
    """A span of one message, as far as usages are concerned."""

    owner: str
    span: Span
    live_at: tuple[str, ...]

    @property
    def order(self) -> tuple[int, str, int]:
        """The earliest first."""
        return self.span.came, self.span.path, self.span.line


@dataclass(frozen=True, slots=True, eq=False)
class TracedUsage:
    """A usage, with the stretches that it consists of."""

    usage: Usage
    stretches: tuple[Stretch, ...]


def usages(record: Record, owners: Sequence[str], branches: Mapping[str, int], claimed: bool) -> list[TracedUsage]:
    """Return the usages of the numbers of a message or enum, whichever package it was in; by number, then by age."""
    confidence = record.confidence(owners)
    stretches: dict[Fact, list[Stretch]] = {}
    for owner in owners:
        live_at = _live_at(record, owner, branches)
        for index, span in record.spans(owner):
            if span.fact.claimed == claimed:
                stretch = Stretch(owner, span, tuple(live_at.get(index, ())))
                stretches.setdefault(span.fact, []).append(stretch)
    found = [
        _traced(record, sorted(parts, key=lambda part: part.order), confidence[fact])
        for fact, parts in stretches.items()
    ]
    return sorted(found, key=lambda traced: (traced.usage.number, traced.stretches[0].order, traced.usage.fact))


def _live_at(record: Record, owner: str, branches: Mapping[str, int]) -> dict[int, list[str]]:
    """The branches on which each span lasts."""
    found: dict[int, list[str]] = {}
    for ref, node in branches.items():
        for spans in record.past.tips[node].alive.get(owner, {}).values():
            for index in spans:
                found.setdefault(index, []).append(ref)
    return found


def _traced(record: Record, stretches: Sequence[Stretch], confidence: Confidence) -> TracedUsage:
    fact = stretches[0].span.fact
    refs = sorted({ref for stretch in stretches for ref in stretch.live_at})
    went = max((node for stretch in stretches for node in stretch.span.went), default=None)
    usage = Usage(
        number=fact.number,
        type=fact.type,
        name=fact.name,
        label=fact.label,
        oneof=fact.oneof,
        intervals=tuple(_interval(record, stretch) for stretch in stretches),
        live_at=tuple(refs),
        went=None if refs or went is None else record.graph[went].revision.commit,
        confidence=confidence,
    )
    return TracedUsage(usage, tuple(stretches))


def _interval(record: Record, stretch: Stretch) -> Interval:
    span = stretch.span
    came = record.graph[span.came].revision.commit
    went = tuple(record.graph[node].revision.commit for node in span.went)
    return Interval(came, went, span.path, span.line)
