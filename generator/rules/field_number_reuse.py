"""A published field number is given to another payload.

An old board and a new rover would decode each other's bytes as something else, without any error. The ledger knows
every number that was ever published. A number is retired for the payload that had it, for no other.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.findings import Finding, Rule
from generator.ledger import Entry
from generator.subject import Subject
from generator.table import RetiredRow, Row

RULE = Rule("ENV102", "field-number-reuse")


def check(subject: Subject) -> Iterator[Finding]:
    """Rows, and retired ones, whose number the ledger has for another message."""
    for row in subject.table.rows:
        for entry in _others(row, subject):
            help = f"give {row.name} the number {subject.next_number()}; {entry.name} stays, or goes to `retired`"
            yield _finding(row, entry, help)
    for retired in subject.table.retired:
        for entry in _others(retired, subject):
            help = f"retire {{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
            yield _finding(retired, entry, help)


def _others(row: Row | RetiredRow, subject: Subject) -> Iterator[Entry]:
    """What else the number was published for."""
    entries = [entry for entry in subject.ledger.entries if entry.number == row.number]
    published = any(entry.proto == row.proto for entry in entries)
    for entry in entries:
        # Of two branches that took one number, the table says after the merge which keeps it.
        settled = entry.contested and published
        if entry.proto != row.proto and not settled:
            yield entry


def _finding(row: Row | RetiredRow, entry: Entry, help: str) -> Finding:
    message = f"field {row.number} was published for {entry.name} ({entry.proto}), not for {row.proto}"
    return RULE.at(row.at("number"), message, help, [(entry.span, "published here")])
