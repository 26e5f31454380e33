"""A change: a schema before and after."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.nanopb import Bounds
from roverlink.generator.protos.schema import Schema


@dataclass(frozen=True, slots=True)
class SchemaChange:
    """The old and the new schema."""

    before: Schema
    after: Schema
    of_ledger: bool = False
    """True if the old schema is the ledger's, which has only names, numbers and types."""
    bounds_before: Bounds | None = None
    """nanopb's bounds before; None if unknown."""

    def earlier(self, span: Span, text: str) -> list[tuple[Span, str]]:
        """Return a related place in the old state; none for the ledger, which nobody edits."""
        return [] if self.of_ledger else [(span, text)]


def each_once(
    changes: Iterable[SchemaChange], compare: Callable[[SchemaChange], Iterable[Diagnostic]]
) -> Iterator[Diagnostic]:
    """Compare with each earlier state, and report a fault only once if several states show it.

    The ledger comes last, because it has no places in .proto files.
    """
    seen = set()
    for change in sorted(changes, key=lambda change: change.of_ledger):
        for finding in compare(change):
            fault = finding.rule, finding.span, finding.message, finding.type, finding.number
            if fault not in seen:
                seen.add(fault)
                yield finding
