"""A published field number is given to another payload.

An old board and a new rover would decode each other's bytes as the wrong message, without an error. A number is
published when `roverlink generate` writes it to the ledger (mapping.lock), which keeps all numbers forever. With
`--against`, the numbers of the earlier state count as published, too. An entry under `retired` must name the payload
that had the number.

Bad::

    # mapping.lock says `12: gps_info SensorBoardGPSInfo`
    messages:
      - {number: 12, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}

Good::

    messages:
      - {number: 22, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}
    retired:
      - {number: 12, name: gps_info, proto: SensorBoardGPSInfo}
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.lock import Entry
from roverlink.generator.table import RetiredRow, Row

RULE = Rule("ENV102", "field-number-reuse", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row and retired row whose number was published for another message."""
    # The ledger and the baseline may list the same payload. The ledger comes first, so its entry is kept.
    published = {(entry.number, entry.proto): entry for entry in reversed(context.published)}
    envelope = context.table.envelope.message
    for row in context.table.rows:
        for entry in _others(row, published.values()):
            help = f"give {row.name!r} the number {context.next_number()}"
            help = f"{help}; keep the row of {entry.name!r}, or move that row to `retired`"
            yield _finding(row, entry, help, envelope)
    for retired in context.table.retired:
        for entry in _others(retired, published.values()):
            help = f"write under `retired`: {{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
            yield _finding(retired, entry, help, envelope)


def _others(row: Row | RetiredRow, published: Iterable[Entry]) -> Iterator[Entry]:
    """Yield the published payloads that had the number of a row, and are not the row's payload."""
    entries = [entry for entry in published if entry.number == row.number]
    for_this = any(entry.proto == row.proto for entry in entries)
    for entry in entries:
        # If two branches took the same number, the merged table decides which payload keeps it.
        settled = entry.contested and for_this
        if entry.proto != row.proto and not settled:
            yield entry


def _finding(row: Row | RetiredRow, entry: Entry, help: str, envelope: str) -> Diagnostic:
    message = f"field {row.number} was published for {entry.name!r} ({entry.proto}), but is given to {row.proto} here"
    also = [(entry.span, "published here")]
    rests_on = [row.at("number"), row.at("proto")]
    return RULE.at(row.at("number"), message, help, also, type=envelope, number=row.number, rests_on=rests_on)
