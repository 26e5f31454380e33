"""A published field number is neither in use nor retired.

Its row was deleted. The number would look free, be given to another payload, and boards that still send the old one
would be misread. A payload that goes is moved to `retired`, which reserves its number and its name.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.findings import Finding, Rule
from generator.subject import Subject

RULE = Rule("ENV103", "field-number-vanished")


def check(subject: Subject) -> Iterator[Finding]:
    """Entries of the ledger whose number the table does not have."""
    table = subject.table
    for entry in subject.ledger.entries:
        if entry.number not in table.numbers:
            message = (
                f"field {entry.number} was published as {entry.name} ({entry.proto}) and is gone from {table.file}"
            )
            cure = f"{{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
            yield RULE.at(entry.span, message, f"put the row back, or add to `retired`: - {cure}")
