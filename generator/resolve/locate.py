"""Locating the messages that the table names: which .proto file declares each of them."""

from __future__ import annotations

from collections.abc import Sequence

from roverlink.generator.diagnostics import Diagnostic, Span, nearest
from roverlink.generator.protos.files import DeclarationIndex
from roverlink.generator.protos.proto_rules import (
    AMBIGUOUS_PROTO,
    EXCLUDED_PROTO,
    PAYLOAD_IN_ENVELOPE_FILE,
    UNKNOWN_PROTO,
)
from roverlink.generator.table import Table


def locate(table: Table, index: DeclarationIndex, findings: list[Diagnostic]) -> dict[str, str]:
    """The file of each message that a row names; a message that cannot be told is a finding."""
    files: dict[str, str] = {}
    for row in table.rows:
        declared = index.files.get(row.proto, [])
        if row.proto == table.envelope.message:
            message = f"{row.proto} is the envelope, which cannot be its own payload"
            findings.append(PAYLOAD_IN_ENVELOPE_FILE.at(row.at("proto"), message, "name the payload's message"))
        elif len(declared) != 1:
            findings.append(_not_located(row.at("proto"), row.proto, declared, index))
        elif declared[0] == table.envelope.file and table.envelope.owner == "mapping":
            message = f"{row.proto} is declared in {declared[0]}, which is written from {table.file}"
            findings.append(PAYLOAD_IN_ENVELOPE_FILE.at(row.at("proto"), message, "move it to a file of its own"))
        else:
            files[row.proto] = declared[0]
    return files


def locate_anys(table: Table, index: DeclarationIndex, findings: list[Diagnostic]) -> dict[str, str]:
    """The file of each message that a row lists for an Any; a message that cannot be told is a finding."""
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
        help = "name all but one of them under proto.exclude"
        return AMBIGUOUS_PROTO.at(span, f"{proto} is declared in {' and in '.join(declared)}", help)
    if proto in index.excluded:
        file = index.excluded[proto][0]
        return EXCLUDED_PROTO.at(span, f"{proto} is declared in {file}, which proto.exclude leaves out")
    help = nearest(proto, index.files, "is its file below proto.root?")
    return UNKNOWN_PROTO.at(span, f"no .proto file declares a message {proto}", help)
