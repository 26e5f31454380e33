"""Search for the .proto file that declares each message of the table."""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.protos.files import DeclarationIndex
from roverlink.generator.protos.proto_rules import (
    AmbiguousProtoMessage,
    ExcludedProtoMessage,
    PayloadInEnvelopeFile,
    UnknownProtoMessage,
)
from roverlink.generator.table import Table
from roverlink.suggestions import nearest


def locate(table: Table, index: DeclarationIndex, findings: list[Diagnostic]) -> dict[str, str]:
    """Return the .proto file of each row's message, by the message's full name.

    A message is reported and left out if no file or several files declare it. The same is true for the envelope, and
    for a message in a file that is generated: the envelope's, and that of the link message.

    The link message is included. In an envelope of another repository, LNK101 reports it if no file declares it.
    """
    files: dict[str, str] = {}
    generated = []
    if table.envelope.owner == "mapping":
        generated.append(table.envelope.file)
        if table.link is not None:
            generated.append(table.envelope.link_file)
            files[ir.LINK_MESSAGE] = table.envelope.link_file
    elif table.link is not None and len(declared := index.files.get(ir.LINK_MESSAGE, [])) == 1:
        (files[ir.LINK_MESSAGE],) = declared
    for row in table.rows:
        declared = index.files.get(row.proto, [])
        if row.proto == ir.LINK_MESSAGE and row.proto in files:
            message = f"{row.proto!r} is the link message, which `link` makes a member of the envelope"
            findings.append(PayloadInEnvelopeFile.at(row.at("proto"), message, "remove the row"))
        elif row.proto == table.envelope.message:
            message = f"{row.proto!r} is the envelope, which cannot be a payload of itself"
            findings.append(
                PayloadInEnvelopeFile.at(row.at("proto"), message, "write the name of the payload's message")
            )
        elif len(declared) != 1:
            findings.append(_not_located(row.at("proto"), row.proto, declared, index))
        elif declared[0] in generated:
            message = f"{row.proto!r} is declared in {declared[0]}, which is generated from {table.file}"
            findings.append(PayloadInEnvelopeFile.at(row.at("proto"), message, "move the message to another file"))
        else:
            files[row.proto] = declared[0]
    return files


def locate_anys(table: Table, index: DeclarationIndex, findings: list[Diagnostic]) -> dict[str, str]:
    """Return the .proto file of each message that a row lists under `any`, by the message's full name.

    A message that no file or several files declare is reported and left out.
    """
    files: dict[str, str] = {}
    for row in table.rows:
        for path, types in row.anys.items():
            for proto in types:
                declared = index.files.get(proto, [])
                if len(declared) == 1:
                    files[proto] = declared[0]
                else:
                    findings.append(_not_located(row.at(f"any.{path}"), proto, declared, index))
    return files


def _not_located(span: Span, proto: str, declared: Sequence[str], index: DeclarationIndex) -> Diagnostic:
    if declared:
        help = "list all of these files except one under `exclude` of `proto`"
        return AmbiguousProtoMessage.at(span, f"{proto!r} is declared in {' and in '.join(declared)}", help)
    if proto in index.excluded:
        file = index.excluded[proto][0]
        help = "remove the file from `exclude`, or use another message"
        return ExcludedProtoMessage.at(span, f"{proto!r} is declared in {file}, which `exclude` of `proto` lists", help)
    help = nearest(proto, index.files, "check the name, and that the message's file is below `root` of `proto`")
    return UnknownProtoMessage.at(span, f"no .proto file declares a message {proto!r}", help)
