"""The envelope's file and the table disagree.

Where the envelope belongs to another repository (`owner: proto`), its file says what is on the wire; a table that says
otherwise would make the bridge read one payload as another.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.findings import Finding, Rule
from generator.protos import ProtoField
from generator.subject import Subject
from generator.table import Row

RULE = Rule("ENV105", "envelope-disagrees")


def check(subject: Subject) -> Iterator[Finding]:
    """Rows and oneof members that are not each other's."""
    table, schema = subject.table, subject.schema
    if table.envelope.owner != "proto" or schema is None:
        return
    envelope = schema.messages.get(table.envelope.message)
    if envelope is None:
        file = table.envelope.file
        yield RULE.at(table.envelope.at("message"), f"{file} declares no message {table.envelope.message}")
        return
    members = {field.number: field for field in envelope.fields if field.oneof == table.envelope.oneof}
    if not members:
        yield RULE.at(table.envelope.at("oneof"), f"{envelope.full_name} has no oneof {table.envelope.oneof}")
        return
    for row in table.rows:
        yield from _compare(row, members.get(row.number))
    retired = {row.number for row in table.retired}
    for number, field in members.items():
        member = f"{field.name} = {number} ({field.wire_type})"
        if number in retired:
            yield RULE.at(field.span, f"{member} is retired in {table.file}", "remove it where the envelope is kept")
        elif number not in table.numbers:
            yield RULE.at(field.span, f"{member} has no row in {table.file}", "add a row for it under `messages`")


def _compare(row: Row, field: ProtoField | None) -> Iterator[Finding]:
    if field is None:
        message = f"the envelope has no member {row.number}, which {row.name} names"
        yield RULE.at(row.at("number"), message, "correct the number, or add the member where the envelope is kept")
        return
    also = [(field.span, "the member")]
    if field.wire_type != row.proto:
        yield RULE.at(row.at("proto"), f"member {row.number} carries {field.wire_type}, not {row.proto}", "", also)
    if field.name != row.name:
        yield RULE.at(row.at("name"), f"member {row.number} is called {field.name}, not {row.name}", "", also)
