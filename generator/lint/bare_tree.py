"""Table that is made from a folder of .proto files, so that the lint also works without a mapping.yaml.

Each member of the envelope's oneof becomes a row of the table. So the rules about numbers and names work as they do on
a table that was read from mapping.yaml.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.lint.input_rules import NoEnvelopeMessage
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.table import FORMAT_VERSION, EnvelopeSettings, ProtoSettings, RosSettings, Row, Table
from roverlink.suggestions import nearest_names

_MOST_NAMED = 3  # messages that are suggested if no name is similar to the one that the user gave


@dataclass(frozen=True, slots=True)
class EnvelopeName:
    """Name and file of the envelope's message, as the user gave them on the command line."""

    file: str
    """Path of the envelope's file, relative to the folder of .proto files; empty if the user did not give it."""
    message: str


def table_of_tree(envelope: EnvelopeName) -> Table:
    """Return the table for a folder of .proto files, still without rows.

    `with_members` adds the rows when the .proto files have been read.
    """
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


def with_members(
    table: Table,
    schema: Schema,
    findings: Sequence[Diagnostic] = (),
    past: Collection[str] = (),
    *,
    required: bool = False,
) -> Table:
    """Add a row for each member of the envelope to a table that was made by `table_of_tree`.

    A table from mapping.yaml is returned unchanged, and one without an envelope, too, unless it is ``required``. The
    user may name the envelope's message without its package. ``past`` are the names of all messages in git's history:
    if only the history has the envelope, the table is returned unchanged, too. Otherwise a missing envelope raises
    `DiagnosticsError`, which also contains ``findings``. The same holds for an envelope that only a file declares which
    does not compile; the ``schema`` has the messages of such files, too.
    """
    if table.proto.root or not (table.envelope.message or table.envelope.file or required):
        return table
    name = _full_name(table.envelope, schema)
    envelope = schema.messages.get(name)
    usable = envelope is not None and envelope.file not in schema.uncompiled
    if not usable and _named(table.envelope.message, past):
        return table
    if envelope is None or not usable or table.envelope.file not in ("", envelope.span.file):
        raise DiagnosticsError([*findings, _no_envelope(table.envelope, schema, envelope, past)])
    oneof = _largest_oneof(envelope)
    # Without a oneof, `oneof` is empty here, and so it is for every field.
    members = [field for field in envelope.fields if field.oneof == oneof]
    return dataclasses.replace(
        table,
        envelope=dataclasses.replace(table.envelope, message=name, oneof=oneof, span=envelope.span),
        numbers=frozenset(field.number for field in members),
        rows=tuple(_row(field) for field in members),
    )


def _full_name(envelope: EnvelopeSettings, schema: Schema) -> str:
    """Return the full name of the envelope's message.

    If no message or several messages match, return the name that the user gave.
    """
    named = _named(envelope.message, schema.messages)
    return named[0] if len(named) == 1 and envelope.message not in named else envelope.message


def _named(name: str, messages: Iterable[str]) -> list[str]:
    """Return the full names of all messages that are called ``name``, in any package.

    ``Envelope`` finds ``rover.Envelope``. An empty name finds nothing.
    """
    return [message for message in messages if name and f".{message}".endswith(f".{name}")]


def _no_envelope(
    settings: EnvelopeSettings, schema: Schema, elsewhere: ProtoMessage | None, past: Collection[str]
) -> Diagnostic:
    """Return the diagnostic for an envelope that was not found: the name or the file that the user gave is wrong.

    ``elsewhere`` is the envelope's message if another file than ``settings.file`` declares it, or one that does not
    compile, and otherwise None.
    """
    name, file = settings.message, settings.file
    in_file = [message for message in schema.messages.values() if message.span.file == file]
    likely = _with_oneofs(in_file or schema.messages.values())
    similar = sorted(
        nearest_names(name, {*schema.messages, *past}), key=lambda similar_name: similar_name not in likely
    )
    known = _named(name, schema.messages) or similar or likely[:_MOST_NAMED]
    help = f"use --message {' or --message '.join(known)}" if known else "use --message with the name of the envelope"
    if elsewhere is not None and elsewhere.file in schema.uncompiled:
        message = f"the message {name!r} is declared in {elsewhere.span.file}, which does not compile"
        help = f"correct the errors in {elsewhere.span.file}"
    elif elsewhere is not None:
        message = f"the message {name!r} is declared in {elsewhere.span.file}, not in {file}"
        help = f"use --envelope {elsewhere.span.file}"
    elif not name:
        message = "the envelope's message is not named"
    else:
        message = f"no message {name!r} is declared"
    return NoEnvelopeMessage.at(settings.span, message, help)


def _with_oneofs(messages: Iterable[ProtoMessage]) -> list[str]:
    """Return the full names of the messages with a oneof, those with the most members in oneofs first."""
    members = Counter({message.full_name: sum(bool(field.oneof) for field in message.fields) for message in messages})
    return [name for name, count in members.most_common() if count]


def _largest_oneof(envelope: ProtoMessage) -> str:
    """Return the name of the oneof that has the most members in the envelope.

    The name is empty for an envelope without oneofs; then all its fields count as payloads.
    """
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
