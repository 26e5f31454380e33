"""Rules that compare the envelope's message with the table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.number_ranges import covers
from roverlink.generator.protos.parser import resolve_type
from roverlink.generator.protos.schema import ProtoMessage
from roverlink.generator.table import LinkSettings, Row, Table

_GENERATE = "run `roverlink generate`, which writes the envelope's file from the table"


@dataclass(frozen=True, slots=True)
class _Member:
    """A field of the envelope, as protoc or the tolerant parser read it."""

    number: int
    name: str
    type: str
    oneof: str
    span: Span

    def __str__(self) -> str:
        return f"the member `{self.name} = {self.number}` ({self.type})"


@dataclass(frozen=True, slots=True)
class _HelpTexts:
    """The help texts of the diagnostics. They depend on the owner of the envelope's file."""

    missing: str
    differs: str
    no_row: str
    retired: str


_OF_OWNER = {
    "mapping": _HelpTexts(
        missing=_GENERATE,
        differs=_GENERATE,
        no_row="add a row for the member under `messages`, or run `roverlink generate`, which removes the member",
        retired="run `roverlink generate`, which removes the member",
    ),
    "proto": _HelpTexts(
        missing="correct the number of the row, or add the member in the envelope's repository",
        differs="correct the row, or the member in the envelope's repository",
        no_row="add a row for the member under `messages`",
        retired="remove the member in the envelope's repository",
    ),
}


class EnvelopeDisagrees(LintRule, id="ENV105"):
    """The envelope's file and the table disagree.

    The bridge decodes by the table, and the boards encode by the envelope's file. Where they differ, one payload is
    read as another without an error. If the table owns the file (`owner: mapping`), the file is old or was edited. If
    another repository owns it (`owner: proto`), the file is right and the table is wrong.

    Bad::

        # mapping.yaml
        messages:
          - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}

        # envelope.proto
        oneof payload {
          SensorBoardGPSInfo gps_info = 13;
        }

    Good::

        # envelope.proto
        oneof payload {
          SensorBoardGPSInfo gps_info = 12;
        }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each difference between the table's rows and the envelope's file.

        If the table owns the file, retired rows whose number or name the file does not reserve are reported, too.
        """
        if context.table.envelope.owner == "proto":
            yield from _check_of_another_owner(context)
        elif context.files:  # no files: the table was not read from a disk
            yield from _check_written_file(context)


def _check_of_another_owner(context: Context) -> Iterator[Diagnostic]:
    table, schema, name = context.table, context.schema, context.table.envelope.message
    is_read = schema.files or context.files
    if not is_read or not name or not table.proto.root:  # without a table, the rows are made from the members
        return
    envelope = schema.messages.get(name)
    if envelope is not None:
        yield from _compare(context, _compiled_members(envelope))
        yield from _compare_signature(envelope, table)
    elif table.whole and not any(context.declared(name)):  # if its file does not compile, protoc reports that
        yield EnvelopeDisagrees.at(
            table.envelope.at("message"), f"{table.envelope.file} declares no message {name!r}", type=name
        )


def _check_written_file(context: Context) -> Iterator[Diagnostic]:
    table, name = context.table, context.table.envelope.message
    path = table.envelope.file
    if not path or not name:
        return
    if path not in context.files:
        message = f"the file {path!r} is missing in the folder {table.proto.root!r}"
        yield EnvelopeDisagrees.at(table.envelope.at("file"), message, _GENERATE, type=name)
        return
    envelope = next((found for file, found in context.declared(name) if file == path), None)
    if envelope is None:
        yield EnvelopeDisagrees.at(
            table.envelope.at("message"), f"{path} declares no message {name!r}", _GENERATE, type=name
        )
        return
    members = _written_members(envelope, context)
    yield from _compare(context, members)
    yield from _compare_signature(envelope, table)
    yield from _unreserved(envelope, {member.number for member in members}, table)


def _compiled_members(envelope: ProtoMessage) -> list[_Member]:
    """Return the members of the envelope that are messages, as protoc read them.

    In the envelope of another repository, the oneof may also contain numbers and strings. These cannot have a row.
    """
    messages = [field for field in envelope.fields if field.type == "message"]
    return [_Member(field.number, field.name, field.wire_type, field.oneof, field.span) for field in messages]


def _written_members(envelope: ProtoMessage, context: Context) -> list[_Member]:
    path = context.table.envelope.file
    declared = {message.full_name for file in context.files.values() for message in file.messages}
    return [
        _Member(
            field.number,
            field.name,
            resolve_type(field.type, envelope.full_name, declared) or field.type.removeprefix("."),
            field.oneof,
            context.place(path, field.span.line, field.span.column),
        )
        for field in envelope.fields
    ]


def _compare(context: Context, members: list[_Member]) -> Iterator[Diagnostic]:
    """Compare the table's rows with the envelope's members, and yield a diagnostic for each difference."""
    table = context.table
    name, oneof = table.envelope.message, table.envelope.oneof
    help_texts = _OF_OWNER[table.envelope.owner]
    payloads = {member.number: member for member in members if member.oneof == oneof}
    if not payloads and table.rows:
        help = _GENERATE if table.envelope.owner == "mapping" else "correct `oneof` under `envelope`"
        yield EnvelopeDisagrees.at(
            table.envelope.at("oneof"), f"the message {name!r} has no oneof {oneof!r}", help, type=name
        )
        return
    # Another rule (ENV106) reports payloads outside of the oneof.
    beside = {(member.number, member.type) for member in members if member.oneof != oneof}
    rows = [row for row in _expected(table) if (row.number, row.proto) not in beside]
    for row in rows:
        yield from _compare_row(row, payloads, table, help_texts)
    strayed = [row for row in rows if row.number not in payloads]
    for member in payloads.values():
        if not any(_is_moved(row, member, table) for row in strayed):
            yield from _without_row(member, context, help_texts)


def _expected(table: Table) -> tuple[Row | LinkSettings, ...]:
    """Return the members that the envelope's file must have.

    If another repository owns the file, another rule (LNK101) reports a missing link message.
    """
    return table.members if table.envelope.owner == "mapping" else table.rows


def _is_moved(row: Row | LinkSettings, member: _Member, table: Table) -> bool:
    """Return True if the row and the member have the same name, and no row has the member's number."""
    return member.name == row.name and member.number not in table.numbers


def _compare_row(
    row: Row | LinkSettings, payloads: Mapping[int, _Member], table: Table, help_texts: _HelpTexts
) -> Iterator[Diagnostic]:
    member = payloads.get(row.number)
    rests_on = [row.at("number"), row.at("proto")]
    if member is None:
        message = f"the envelope has no member with number {row.number}, the number of the row {row.name!r}"
        also = []
        for moved in (other for other in payloads.values() if _is_moved(row, other, table)):
            message = f"member {row.name!r} has the number {moved.number}, not {row.number}"
            also = [(moved.span, "the member is here")]
        yield EnvelopeDisagrees.of_row(table, row, "number", message, help_texts.missing, also, rests_on=rests_on)
        return
    also = [(member.span, "the member is here")]
    if member.type != row.proto:
        message = f"member {row.number} of the envelope has the type {member.type!r}, but the row says {row.proto!r}"
        yield EnvelopeDisagrees.of_row(table, row, "proto", message, help_texts.differs, also, rests_on=rests_on)
    if member.name != row.name:
        message = f"member {row.number} of the envelope is called {member.name!r}, but the row says {row.name!r}"
        rests_on.append(row.at("name"))
        yield EnvelopeDisagrees.of_row(table, row, "name", message, help_texts.differs, also, rests_on=rests_on)


def _without_row(member: _Member, context: Context, help_texts: _HelpTexts) -> Iterator[Diagnostic]:
    table, number = context.table, member.number
    envelope = table.envelope.message
    if number in {row.number for row in table.retired}:
        message = f"{member} is still in the envelope, but its number is retired in {table.file}"
        yield EnvelopeDisagrees.at(member.span, message, help_texts.retired, type=envelope, number=number)
    elif table.whole and number not in table.numbers:
        message = f"{member} of the envelope has no row in {table.file}"
        rests_on = [row.at("number") for row in table.rows if row.proto == member.type]
        rests_on += [entry.span for entry in context.published if entry.number == number]
        yield EnvelopeDisagrees.at(
            member.span, message, help_texts.no_row, type=envelope, number=number, rests_on=rests_on
        )


def _compare_signature(envelope: ProtoMessage, table: Table) -> Iterator[Diagnostic]:
    """Yield a diagnostic if the table declares a signature, and the envelope's file does not declare the same field."""
    signing = table.signing
    if signing is None:
        return
    wanted = f"{signing.proto} {signing.name} = {signing.number};"
    fields = [field for field in envelope.fields if signing.number == field.number or signing.name == field.name]
    facts = {(field.type, field.name, field.number, field.repeated, field.oneof) for field in fields}
    if facts != {(signing.proto, signing.name, signing.number, False, "")}:
        help = _GENERATE
        if table.envelope.owner == "proto":
            help = f"add `{wanted}` to the message outside of the oneof, in the envelope's repository"
        message = f"the message {envelope.full_name!r} does not declare `{wanted}`"
        also = [(field.span, f"{field.name!r} has the number {field.number}") for field in fields if field.span.line]
        yield EnvelopeDisagrees.at(
            signing.at("number"),
            message,
            help,
            also,
            type=envelope.full_name,
            number=signing.number,
            rests_on=[signing.at("number")],
        )


def _unreserved(envelope: ProtoMessage, used: set[int], table: Table) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each retired row whose number or name the envelope's file does not reserve."""
    for row in table.retired:
        free = [] if covers(envelope.reserved, row.number) else [f"the number {row.number}"]
        free += [f"the name {row.name!r}"] if row.name not in envelope.reserved_names else []
        if free and row.number not in used:
            message = f"{row.name!r} is retired, but {table.envelope.file} does not reserve {' and '.join(free)}"
            yield EnvelopeDisagrees.of_row(table, row, "number", message, _GENERATE)
