"""Table that is made from a folder of .proto files, so that the lint also works without a mapping.yaml.

Each member of the envelope's oneof becomes a row of the table. So the rules about numbers and names work as they do on
a table that was read from mapping.yaml.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.lint.input_rules import NoEnvelopeMessage
from roverlink.generator.protos.parser import File
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.table import FORMAT_VERSION, EnvelopeSettings, ProtoSettings, RosSettings, Row, Table
from roverlink.suggestions import nearest_names

_MOST_NAMED = 3  # messages that are suggested if no name is similar to the one that the user gave


@dataclass(frozen=True, slots=True)
class TreeOptions:
    """Envelope of a folder without a table, and the files that are left out, as the user gave them."""

    file: str
    """Path of the envelope's file, relative to the folder of .proto files; empty if the user did not give it."""
    message: str
    exclude: tuple[str, ...] = ()
    """Paths of the .proto files that are not compiled, relative to the folder."""


def table_of_tree(options: TreeOptions) -> Table:
    """Return the table for a folder of .proto files, still without rows.

    `with_members` adds the rows when the .proto files have been read.
    """
    file = str(PurePosixPath(options.file)) if options.file else ""
    here = Span(file or ".")
    return Table(
        file=file,
        whole=False,
        numbers=frozenset(),
        version=FORMAT_VERSION,
        proto=ProtoSettings(span=here, root="", exclude=tuple(str(PurePosixPath(path)) for path in options.exclude)),
        envelope=EnvelopeSettings(span=here, file=file, message=options.message, oneof="", owner="proto"),
        ros=RosSettings(span=here, package=""),
        peers=(),
        rows=(),
    )


def without_rows(table: Table) -> Table:
    """Return the table for a state without one, with the envelope and the excluded files of another state's table."""
    return table_of_tree(TreeOptions("", table.envelope.message, table.proto.exclude))


def files_of(envelope: EnvelopeSettings, files: Mapping[str, File]) -> set[str]:
    """Return the paths of the files that declare the envelope, and of all files that they import."""
    found = set[str]()
    waiting = [
        path for path, file in files.items() if _named(envelope.message, [one.full_name for one in file.messages])
    ]
    while waiting:
        if (path := waiting.pop()) in files and path not in found:
            found.add(path)
            waiting += files[path].imported
    return found


def with_members(table: Table, schema: Schema) -> Table:
    """Add a row for each member of the envelope to a table that was made by `table_of_tree`.

    A table from mapping.yaml is returned unchanged, and so is one whose envelope no file declares. The user may name
    the envelope's message without its package. The ``schema`` has the messages of files that do not compile, too.
    """
    name = _full_name(table.envelope, schema)
    envelope = schema.messages.get(name)
    if table.proto.root or envelope is None or table.envelope.file not in ("", envelope.span.file):
        return table
    oneof = _largest_oneof(envelope)
    # Without a oneof, `oneof` is empty here, and so it is for every field.
    members = [field for field in envelope.fields if field.oneof == oneof]
    return dataclasses.replace(
        table,
        envelope=dataclasses.replace(table.envelope, message=name, oneof=oneof, span=envelope.span),
        numbers=frozenset(field.number for field in members),
        rows=tuple(_row(field) for field in members),
    )


def missing_envelope(
    table: Table, schema: Schema, past: Collection[str] = (), *, required: bool = False
) -> Diagnostic | None:
    """Return the diagnostic for an envelope that no file declares, or only one that does not compile; else None.

    Without an envelope, the result is None unless it is ``required``. So it is for an envelope that only git's history
    has; ``past`` are the names of all messages there. ``table`` is the result of `with_members`.
    """
    wanted = table.envelope.message or table.envelope.file or required
    envelope = schema.messages.get(table.envelope.message)
    found = envelope is not None and table.envelope.file in ("", envelope.span.file)
    compiles = envelope is None or envelope.file not in schema.uncompiled
    if table.proto.root or not wanted or (found and compiles):
        return None
    if _named(table.envelope.message, past):
        return None
    return _no_envelope(table.envelope, schema, envelope, past)


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
