"""A new row skips numbers.

A skipped number looks as if it had been used once, and every reader has to check that. Large numbers also cost bytes: a
number above 15 takes one more byte in every datagram.

Bad::

    # the largest number that was ever used is 21
    messages:
      - {number: 30, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}

Good::

    messages:
      - {number: 22, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.lock import NAME

RULE = Rule("TAB106", "number-skipped", __doc__, Severity.HINT)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each new row with a larger number than the next free one.

    If nothing has been published yet, nothing is reported.
    """
    published = {entry.number for entry in context.published}
    if not published:
        return
    table = context.table
    # A payload whose published number is missing in the table is not new: ENV103 reports it.
    moved = {entry.proto for entry in context.published if entry.number not in table.numbers}
    new = {row.number: row for row in reversed(table.members) if row.number not in published and row.proto not in moved}
    # Only numbers above all old ones are certain to have never been used.
    old = published | (table.numbers - new.keys())
    smallest = max(old)
    for number in sorted(number for number in new if number > max(old)):
        smallest = context.free_number(smallest + 1, besides=new.keys())
        if number > smallest:
            row = new[number]
            message = f"field {number} skips numbers that were never used; the next number is {smallest}"
            help = f"give {row.name!r} the number {smallest}, and restore {NAME} if it has {number} already"
            rests_on = [row.at("number"), row.at("proto")]
            yield RULE.at(
                row.at("number"), message, help, type=table.envelope.message, number=number, rests_on=rests_on
            )
