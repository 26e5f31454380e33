"""A tree of .proto files without a mapping.yaml, as a table that says nothing but where the envelope is.

Its rows are the members of the envelope, so that the rules for numbers and names see them as they see a table's.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.lint.input_rules import NO_ENVELOPE_MESSAGE
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.table import FORMAT_VERSION, EnvelopeSettings, ProtoSettings, RosSettings, Row, Table


@dataclass(frozen=True, slots=True)
class EnvelopeName:
    """Which message carries the payloads, as the command line says it."""

    file: str
    """Relative to the tree; empty for none."""
    message: str


def table_of_tree(envelope: EnvelopeName) -> Table:
    """A table without rows; `with_members` gives it those of the envelope."""
    file = str(PurePosixPath(envelope.file)) if envelope.file else ""
    here = Span(file or ".")
    return Table(
        file=file,
        whole=False,
        numbers=frozenset(),
        version=FORMAT_VERSION,
        proto=ProtoSettings(span=here, root=""),
        envelope=EnvelopeSettings(span=here, file=file, message=envelope.message, oneof="", owner="proto"),
        ros=RosSettings(span=here, package=""),
        peers=(),
        rows=(),
    )


def with_members(table: Table, schema: Schema, findings: Sequence[Diagnostic] = (), past: Iterable[str] = ()) -> Table:
    """The table of a tree with a row for each member of its envelope; any other table as it is.

    The envelope's message may be named without its package. Raises `DiagnosticsError` where there is no such envelope,
    after the ``findings`` that may be why, unless it is among the messages of the ``past``.
    """
    if table.proto.root or not (table.envelope.message or table.envelope.file):
        return table
    name = _full_name(table.envelope, schema)
    envelope = schema.messages.get(name)
    if envelope is None and _named(table.envelope.message, past):
        return table
    if envelope is None or table.envelope.file not in ("", envelope.span.file):
        raise DiagnosticsError([*findings, _no_envelope(table.envelope, schema, envelope)])
    oneof = _largest_oneof(envelope)
    members = [field for field in envelope.fields if field.oneof == oneof]
    return dataclasses.replace(
        table,
        envelope=dataclasses.replace(table.envelope, message=name, oneof=oneof, span=envelope.span),
        numbers=frozenset(field.number for field in members),
        rows=tuple(_row(field) for field in members),
    )


def must_have_envelope(table: Table, findings: Sequence[Diagnostic]) -> None:
    """Raises `DiagnosticsError` where nobody said which message the envelope is."""
    if not table.envelope.message:
        message = "which message is the envelope was not said; nothing was looked at"
        raise DiagnosticsError([*findings, NO_ENVELOPE_MESSAGE.at(table.envelope.span, message, "say --message")])


def _full_name(envelope: EnvelopeSettings, schema: Schema) -> str:
    """The full name of the envelope's message, where one message alone has the name."""
    named = _named(envelope.message, schema.messages)
    return named[0] if len(named) == 1 and envelope.message not in named else envelope.message


def _named(name: str, messages: Iterable[str]) -> list[str]:
    """The messages of a name, whatever package they are in; none for no name."""
    return [message for message in messages if name and f".{message}".endswith(f".{name}")]


def _no_envelope(settings: EnvelopeSettings, schema: Schema, elsewhere: ProtoMessage | None) -> Diagnostic:
    """What is wrong with the words that name the envelope."""
    name, file = settings.message, settings.file
    in_file = [message.full_name for message in schema.messages.values() if message.span.file == file]
    known = _named(name, schema.messages) or in_file
    help = f"say --message {' or --message '.join(known)}" if known else "say --message"
    if elsewhere is not None:
        message = f"{name} is declared in {elsewhere.span.file}, not in {file}"
        help = f"say --envelope {elsewhere.span.file}"
    elif not name:
        message = "which of its messages is the envelope was not said"
    else:
        message = f"no message {name} is declared in a file that compiles"
    return NO_ENVELOPE_MESSAGE.at(settings.span, message, help)


def _largest_oneof(envelope: ProtoMessage) -> str:
    """The oneof with the most members; empty where there is none, and then every field is a payload."""
    counted = Counter(field.oneof for field in envelope.fields if field.oneof)
    return counted.most_common(1)[0][0] if counted else ""


def _row(field: ProtoField) -> Row:
    spans = {"number": field.at("number"), "name": field.at("name"), "proto": field.at("type")}
    return Row(
        span=field.span,
        spans=spans,
        number=field.number,
        name=field.name,
        proto=field.wire_type,
        ros=field.wire_type.rpartition(".")[2],
        topic="",
        direction="",
    )
