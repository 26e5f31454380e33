"""Two payloads of the envelope have the same field number.

The receiver cannot tell the two payloads apart. A retired number is taken forever, because boards that send the old
payload may still be in use.

Bad::

    messages:
      - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
      - {number: 12, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}

Good::

    messages:
      - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
      - {number: 22, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Numbered, RetiredRow

RULE = Rule("ENV101", "field-number-taken", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row, retired row and signature whose number belongs to another row."""
    table = context.table
    holders: dict[int, RetiredRow] = {}

    def at(row: Numbered | RetiredRow, message: str, help: str, also: tuple[Span, str]) -> Diagnostic:
        return RULE.at(row.at("number"), message, help, [also], type=table.envelope.message, number=row.number)

    for retired in table.retired:
        first = holders.setdefault(retired.number, retired)
        if first is not retired:
            message = f"field {retired.number} is retired twice"
            yield at(retired, message, "keep one of the two entries", (first.at("number"), "first retired here"))
    rows = _owners(context)
    published = {(entry.proto, entry.name): entry.number for entry in context.published}
    next_number = context.next_number()
    for row in table.numbered:
        old = published.get((row.proto, row.name))
        help = f"use {next_number}, the next number that was never used"
        if old is not None and old not in table.numbers:
            help = f"give {row.name!r} back its published number {old}"
        if row.number in holders:
            gone = holders[row.number]
            message = f"field {row.number} was {gone.name!r} ({gone.proto}) and is retired"
            yield at(row, message, help, (gone.at("number"), "retired here"))
        elif rows[row.number] is not row:
            taken = rows[row.number]
            message = f"field {row.number} is already taken by {taken.name!r} ({taken.proto})"
            yield at(row, message, help, (taken.at("number"), "first used here"))


def _owners(context: Context) -> dict[int, Numbered]:
    """Return the owner of each number: the row for which it was published, or else the first row that has it."""
    owners: dict[int, Numbered] = {}
    published = {(entry.number, entry.proto) for entry in context.published}
    # The row that had the number first is right, even if the other one stands above it in the file.
    for row in sorted(context.table.numbered, key=lambda row: (row.number, row.proto) not in published):
        owners.setdefault(row.number, row)
    return owners
