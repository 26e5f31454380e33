"""A published field number is given to another payload.

An old board and a new rover would decode each other's bytes as something else, without any error. The ledger knows
every number that was ever published.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.findings import Finding, Rule
from generator.subject import Subject

RULE = Rule("ENV102", "field-number-reuse")


def check(subject: Subject) -> Iterator[Finding]:
    """Rows whose number the ledger has for another message."""
    for row in subject.table.rows:
        entries = [entry for entry in subject.ledger.entries if entry.number == row.number]
        published = any(entry.proto == row.proto for entry in entries)
        for entry in entries:
            # Of two branches that took one number, the table says after the merge which keeps it.
            settled = entry.contested and published
            if entry.proto != row.proto and not settled:
                message = f"field {row.number} was published for {entry.name} ({entry.proto}), not for {row.proto}"
                help = f"give {row.name} the number {subject.next_number()}; {entry.name} stays, or goes to `retired`"
                yield RULE.at(row.at("number"), message, help, [(entry.span, "published here")])
