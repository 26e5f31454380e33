"""A published field number is neither in use nor retired.

Its row was deleted. The number would look free, be given to another payload, and boards that still send the old one
would be misread. A payload that goes is moved to `retired`, which reserves its number and its name.

Bad::

    # mapping.lock says `12: gps_info SensorBoardGPSInfo`; no row has the number 12
    retired: []

Good::

    retired:
      - {number: 12, name: gps_info, proto: SensorBoardGPSInfo}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span
from roverlink.generator.lint.context import Context

RULE = Rule("ENV103", "field-number-vanished", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Payloads that were published and whose number the table does not have."""
    table = context.table
    if not table.whole:
        return  # the number may be among what could not be read
    # One payload may be known from several places, the ledger first; it is one fact.
    published = {(entry.number, entry.proto): entry for entry in reversed(context.published)}
    for entry in published.values():
        if entry.number in table.numbers:
            continue
        message = f"field {entry.number} was published as {entry.name} ({entry.proto}) and is gone from {table.file}"
        cure = f"{{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
        help = f"put the row back, or add to `retired`: - {cure}"
        of_ledger = entry in context.ledger.entries
        span = entry.span if of_ledger else Span(table.file)  # nobody can mend an earlier state
        also = [] if of_ledger else [(entry.span, "published here")]
        moved = [row.at("number") for row in table.rows if row.proto == entry.proto]
        yield RULE.at(span, message, help, also, type=table.envelope.message, number=entry.number, rests_on=moved)
