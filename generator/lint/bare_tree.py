"""A tree of .proto files without a mapping.yaml, as a table.

Its rows are the members of the envelope, so the rules about numbers and names work as they do on a real table.
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
    """The envelope's message, as given on the command line."""

    file: str
    """The envelope's file, relative to the tree; empty for none."""
    message: str


def table_of_tree(envelope: EnvelopeName) -> Table:
    """Return a table without rows; `with_members` adds them from the envelope."""
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
    """Add a row for each member of the envelope to the table of a tree; return any other table unchanged.

    The message may be named without its package. Raises `DiagnosticsError`, with ``findings`` in front, if the envelope
    is not declared, unless it is among the messages of the ``past``.
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
    """Raise `DiagnosticsError` if the envelope's message was not named."""
    if not table.envelope.message:
        message = "the envelope's message is not named; nothing was linted"
        raise DiagnosticsError([*findings, NO_ENVELOPE_MESSAGE.at(table.envelope.span, message, "add --message NAME")])


def _full_name(envelope: EnvelopeSettings, schema: Schema) -> str:
    """Return the full name of the envelope's message, if only one message has that name."""
    named = _named(envelope.message, schema.messages)
    return named[0] if len(named) == 1 and envelope.message not in named else envelope.message


def _named(name: str, messages: Iterable[str]) -> list[str]:
    """Return the messages with a name in any package; none for an empty name."""
    return [message for message in messages if name and f".{message}".endswith(f".{name}")]


def _no_envelope(settings: EnvelopeSettings, schema: Schema, elsewhere: ProtoMessage | None) -> Diagnostic:
    """Return a diagnostic for an envelope that was named wrongly."""
    name, file = settings.message, settings.file
    in_file = [message.full_name for message in schema.messages.values() if message.span.file == file]
    known = _named(name, schema.messages) or in_file
    help = f"use --message {' or --message '.join(known)}" if known else "add --message NAME"
    if elsewhere is not None:
        message = f"the message {name!r} is declared in {elsewhere.span.file}, not in {file}"
        help = f"use --envelope {elsewhere.span.file}"
    elif not name:
        message = "the envelope's message is not named"
    else:
        message = f"no message {name!r} is declared in a file that compiles"
    return NO_ENVELOPE_MESSAGE.at(settings.span, message, help)


def _largest_oneof(envelope: ProtoMessage) -> str:
    """Return the oneof with the most members. Without any oneof this is empty, and all fields are payloads."""
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
