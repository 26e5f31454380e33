"""A published field number is neither in use nor retired.

Its row was deleted, so the number looks free. If another payload gets it, the rover misreads boards that send the old
payload. Move the row to `retired` instead, which reserves its number and its name.

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
from roverlink.generator.lock import NAME

RULE = Rule("ENV103", "field-number-vanished", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each published payload whose number no row and no retired row has."""
    table = context.table
    if not table.whole:
        return  # the missing number may be in a row that could not be read
    # The ledger and the baseline may list the same payload. The ledger comes first, so its entry is kept.
    published = {(entry.number, entry.proto): entry for entry in reversed(context.published)}
    for entry in published.values():
        if entry.number in table.numbers:
            continue
        message = (
            f"field {entry.number} was published as {entry.name!r} ({entry.proto}), but is missing in {table.file}"
        )
        entry_text = f"{{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
        back = f"`signing: {{number: {entry.number}}}`" if entry.proto == "bytes" else "the row"
        help = f"put {back} back, or add to `retired`: - {entry_text}"
        of_ledger = entry in context.ledger.entries
        span = entry.span if of_ledger else Span(table.file)  # an earlier state cannot be edited
        also = [] if of_ledger else [(entry.span, "published here")]
        moved = [row.at("number") for row in table.members if row.proto == entry.proto]
        if of_ledger and moved:
            help += f"; if no program has used {entry.number} yet, restore the earlier {NAME}"
        yield RULE.at(span, message, help, also, type=table.envelope.message, number=entry.number, rests_on=moved)
