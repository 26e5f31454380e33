"""A published field number is given to another payload.

An old board and a new rover would decode each other's bytes as the wrong message, without an error. A number is
published when `roverlink generate` writes it to the ledger (mapping.lock), which keeps all numbers forever. With
`--against`, the numbers of the earlier state count as published, too. An entry under `retired` must name the payload
that had the number.

A message that only has another name is the same payload. If this is not certain, the diagnostic is a warning
(`roverlink explain WIR116`).

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

import dataclasses
from collections.abc import Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.comparison.judged_changes import judge_payload
from roverlink.generator.lint.comparison.judgement import Judgement, Meaning, least
from roverlink.generator.lint.context import Context
from roverlink.generator.lock import Entry, PastUse
from roverlink.generator.table import Numbered, RetiredRow

RULE = Rule("ENV102", "field-number-reuse", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row, retired row and signature whose number was published for another message."""
    # The ledger and the baseline may list the same payload. The ledger comes first, so its entry is kept.
    published = {(entry.number, entry.proto): entry for entry in reversed(context.published)}
    envelope = context.table.envelope.message
    for row in context.table.numbered:
        for entry in _others(row, published.values()):
            keep = (
                f"keep the row of {entry.name!r}, or move that row to `retired`"
                if context.table.proto.root
                else f"keep {entry.name!r}, or write `reserved {entry.number};`"
            )
            help = f"give {row.name!r} the number {context.next_number()}; {keep}"
            yield from _judged(context, row, entry, _finding(row, entry, help, envelope))
    for retired in context.table.retired:
        for entry in _others(retired, published.values()):
            help = f"write under `retired`: {{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
            yield _finding(retired, entry, help, envelope)


def _others(row: Numbered | RetiredRow, published: Iterable[Entry]) -> Iterator[Entry]:
    """Yield the published payloads that had the number of a row, and are not the row's payload."""
    entries = [entry for entry in published if entry.number == row.number]
    for_this = any(entry.proto == row.proto for entry in entries)
    for entry in entries:
        # If two branches took the same number, the merged table decides which payload keeps it. `generate` publishes a
        # number for a second payload only if this is the first one with another name.
        settled = for_this and (entry.contested or entry.gone)
        if entry.proto != row.proto and not settled:
            yield entry


def _judged(context: Context, row: Numbered, entry: Entry, finding: Diagnostic) -> Iterator[Diagnostic]:
    """Yield the diagnostic, as a warning if in doubt.

    Yield nothing if the row's message is the published one, renamed, or if the user has accepted the change.
    """
    old, new = PastUse(entry.proto, entry.name), PastUse(row.proto, row.name)
    if context.ledger.settles(context.table.envelope.message, row.number, old, new):
        return
    judged = (judge_payload(change, entry.proto, row.proto, entry.name, row.name) for change in context.changes)
    found = least([one for one in judged if one] or [Judgement(Meaning.OTHER)])
    if found.certain:
        yield finding
    elif found.meaning is not Meaning.RENAMED:
        message = f"{finding.message}: {found.reason}"
        yield dataclasses.replace(finding, severity=Severity.WARNING, message=message)


def _finding(row: Numbered | RetiredRow, entry: Entry, help: str, envelope: str) -> Diagnostic:
    message = f"field {row.number} was published for {entry.name!r} ({entry.proto}), but is given to {row.proto} here"
    also = [(entry.span, "published here")]
    rests_on = [row.at("number"), row.at("proto")]
    return RULE.at(row.at("number"), message, help, also, type=envelope, number=row.number, rests_on=rests_on)
