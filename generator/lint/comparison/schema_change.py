"""A schema before and after, and findings about several of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.nanopb import Bounds
from roverlink.generator.protos.schema import Schema


@dataclass(frozen=True, slots=True)
class SchemaChange:
    """The protos as they were, and as they are."""

    before: Schema
    after: Schema
    of_ledger: bool = False
    """True if the earlier state is the ledger, which has only names, numbers and types of what can travel."""
    bounds_before: Bounds | None = None
    """nanopb's bounds as they were; None where they are not known."""

    def earlier(self, span: Span, text: str) -> list[tuple[Span, str]]:
        """Return the place where something stood; none for the ledger, which no one writes by hand."""
        return [] if self.of_ledger else [(span, text)]


def each_once(
    changes: Iterable[SchemaChange], compare: Callable[[SchemaChange], Iterable[Diagnostic]]
) -> Iterator[Diagnostic]:
    """Compare with each earlier state; of a finding against several, yield only that of the richest.

    The ledger knows least, so what it has in common with another state is said with that one's places.
    """
    seen = set()
    for change in sorted(changes, key=lambda change: change.of_ledger):
        for finding in compare(change):
            fault = finding.rule, finding.span, finding.message, finding.type, finding.number
            if fault not in seen:
                seen.add(fault)
                yield finding
