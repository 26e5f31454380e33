"""A change of the schema (all messages and enums): the schema of an earlier state, and the current schema."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.nanopb import Bounds
from roverlink.generator.protos.schema import Schema


@dataclass(frozen=True, slots=True, eq=False)
class SchemaChange:
    """The schema of an earlier state, and the current schema.

    A change equals only itself, so that results about it can be cached.
    """

    before: Schema
    after: Schema
    of_ledger: bool = False
    """True if the earlier schema comes from the ledger (mapping.lock), which stores only names, numbers and types."""
    bounds_before: Bounds | None = None
    """The size limits of nanopb in the earlier state; None if they are unknown."""

    def earlier(self, span: Span, text: str) -> list[tuple[Span, str]]:
        """Return a list for `Diagnostic.also` with a place in the earlier state and a text.

        The list is empty if the earlier state is the ledger, because users do not edit the ledger.
        """
        return [] if self.of_ledger else [(span, text)]


def each_once(
    changes: Iterable[SchemaChange], compare: Callable[[SchemaChange], Iterable[Diagnostic]]
) -> Iterator[Diagnostic]:
    """Yield the diagnostics that ``compare`` returns for each change, without repetitions.

    The comparison with the ledger comes last, because the ledger has no places in .proto files.
    """
    seen = set()
    for change in sorted(changes, key=lambda change: change.of_ledger):
        for finding in compare(change):
            fault = finding.rule, finding.span, finding.message, finding.type, finding.number
            if fault not in seen:
                seen.add(fault)
                yield finding
