"""A name in the envelope is given twice.

Two members of one oneof cannot share a name, nor can two handlers: names that differ only in capitals or underscores
would become the same class. A retired name is taken for ever, as its number is.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.findings import Finding, Rule
from generator.naming import camel_case
from generator.subject import Subject
from generator.table import Row

RULE = Rule("TAB101", "name-taken")


def check(subject: Subject) -> Iterator[Finding]:
    """Rows whose name an earlier row or a retired one has."""
    table = subject.table
    retired = {row.name: row for row in table.retired}
    seen: dict[str, Row] = {}
    for row in table.rows:
        first = seen.setdefault(camel_case(row.name).lower(), row)
        if first is not row:
            message = f"the name {row.name} is already taken by field {first.number} ({first.proto})"
            yield RULE.at(row.at("name"), message, "choose another name", [(first.at("name"), "first used here")])
        elif row.name in retired:
            gone = retired[row.name]
            message = f"the name {row.name} was that of field {gone.number} ({gone.proto}) and is retired"
            yield RULE.at(row.at("name"), message, "choose another name", [(gone.at("name"), "retired here")])
