"""Findings about several earlier states, each fault once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lint.comparison.schema_change import Change


def each_once(changes: Iterable[Change], compare: Callable[[Change], Iterable[Diagnostic]]) -> Iterator[Diagnostic]:
    """What a comparison finds against each earlier state; what it finds against several, only as the richest knows it.

    The ledger knows least, so what it has in common with another state is said with that one's places.
    """
    seen = set()
    for change in sorted(changes, key=lambda change: change.of_ledger):
        for finding in compare(change):
            fault = finding.rule, finding.span, finding.message, finding.type, finding.number
            if fault not in seen:
                seen.add(fault)
                yield finding


def earlier(change: Change, span: Span, text: str) -> list[tuple[Span, str]]:
    """Where something stood; nothing for the ledger, which no one writes by hand."""
    return [] if change.of_ledger else [(span, text)]
