"""The phases one after the other: read, locate, compile, lint, resolve, emit."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from generator import ir, ledger, read, resolve, targets
from generator.findings import Finding, FindingsError, Rule, has_errors, in_order
from generator.protos import DeclarationIndex, Schema, compile_protos
from generator.rules import lint
from generator.subject import Subject
from generator.table import Table
from generator.targets import envelope as envelope_target

NO_PROTO_ROOT = Rule("PRO107", "no-proto-root")


@dataclass(frozen=True, slots=True)
class Compiled:
    """What a table compiles to."""

    bridge: ir.Bridge
    files: dict[str, str]
    """Text by path, relative to the table."""
    warnings: tuple[Finding, ...]


def compile_table(table_path: Path) -> Compiled:
    """Compile a table. Nothing is written.

    Raises `FindingsError` with everything that is wrong, as far as it can be seen at once.
    """
    project = table_path.resolve().parent
    table = read.read(table_path, table_path.name)
    index = _index(table, project)
    published = ledger.read(project / ledger.NAME)
    findings: list[Finding] = []
    files = resolve.locate(table, index, findings)
    envelope = resolve.resolve_envelope(table, files)
    schema = _compile(table, project, envelope, files, findings)
    findings += lint(Subject(table, schema, published))
    bridge = None
    if schema is not None and envelope.message in schema.messages:
        bridge = resolve.resolve(table, schema, envelope, findings)
    if has_errors(findings) or bridge is None:
        raise FindingsError(in_order(findings))
    return Compiled(bridge, targets.emit(bridge, table.proto.root), tuple(in_order(findings)))


def _index(table: Table, project: Path) -> DeclarationIndex:
    root = project / table.proto.root
    if not root.is_dir():
        message = f"the proto root {table.proto.root} is not a folder"
        raise FindingsError([NO_PROTO_ROOT.at(table.proto.at("root"), message, "it is relative to the table's folder")])
    return DeclarationIndex(root, table.proto.exclude, table.proto.root)


def _compile(
    table: Table, project: Path, envelope: ir.Envelope, files: dict[str, str], findings: list[Finding]
) -> Schema | None:
    """What protoc makes of the payloads and the envelope; None, with findings, where it refuses them."""
    wanted = sorted({*files.values(), envelope.file})
    overlay = {envelope.file: envelope_target.text(_unambiguous(envelope), table.file)} if envelope.ours else {}
    try:
        return compile_protos(project / table.proto.root, wanted, overlay, table.proto.root)
    except FindingsError as error:
        findings += error.findings
        return None


def _unambiguous(envelope: ir.Envelope) -> ir.Envelope:
    """The envelope without members that clash: the rules report those better than protoc does."""
    taken: set[int | str] = {part for row in envelope.retired for part in (row.number, row.name)}
    members = []
    for member in envelope.members:
        if not {member.number, member.name} & taken and not 19_000 <= member.number < 20_000:
            taken |= {member.number, member.name}
            members.append(member)
    return ir.Envelope(envelope.file, envelope.message, envelope.oneof, True, tuple(members), envelope.retired)
