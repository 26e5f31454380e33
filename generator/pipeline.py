"""The compiler from mapping.yaml to generated files. It calls its steps in order, from reading to emitting files."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from roverlink.generator import ir, lock, source_files
from roverlink.generator.content_digest import table_digest
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, has_errors, in_order, shown
from roverlink.generator.emit import emitter, envelope_file, targets
from roverlink.generator.emit.writer import Change, compare
from roverlink.generator.ir import ros_names
from roverlink.generator.ir.protobuf_facts import IMPLEMENTATION_NUMBERS
from roverlink.generator.lint.context import Context, since_last_generate
from roverlink.generator.lint.engine import lint
from roverlink.generator.nanopb import row_sizes, table_bounds
from roverlink.generator.protos.files import index_declarations, read_protos
from roverlink.generator.protos.parser import File
from roverlink.generator.protos.proto_rules import NoEnvelopeFile, NoProtoRoot
from roverlink.generator.protos.protoc import Compilation, compile_protos, compile_tree
from roverlink.generator.protos.schema import Schema
from roverlink.generator.resolve.locate import locate, locate_anys
from roverlink.generator.resolve.resolver import resolve, resolve_envelope
from roverlink.generator.table import Table, reader
from roverlink.generator.table.edit import with_retired, with_row
from roverlink.generator.table.yaml_items import read_text

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Compiled:
    """Result of compiling mapping.yaml: the intermediate representation (IR), the generated files, and the warnings."""

    bridge: ir.Bridge
    root: str
    """Folder of the .proto files, relative to the table."""
    files: dict[str, str]
    """Text of each generated file, by its path relative to the table."""
    folders: Mapping[str, str]
    """Folders of generated files, and what the names of generated files there end with.

    A generated file there that is not in `files` is left from an earlier run.
    """
    own: tuple[str, ...]
    """Paths of files that belong to roverlink although they carry no header: the ledger, and those that it lists."""
    warnings: tuple[Diagnostic, ...]
    repeatable: bool
    """True if only roverlink made the files, from the table, the ledger and the files in `root`.

    Templates of the user, and targets of other packages, may read more, and `vendored_runtime` reads the runtime.
    """

    def changes(self, project: Path, edited: Mapping[str, str] | None = None) -> list[Change]:
        """Return the changes of all files on disk that make the project up to date.

        ``edited`` are the new texts of files that the user owns, and that a command changes on request, by path.
        """
        edited = edited or {}
        return compare(project, {**self.files, **edited}, self.folders, (*self.own, *edited))


def compile_table(
    table_path: Path, kinds: Iterable[str] = (), templates: Iterable[str] = (), *, vendor_runtime: bool = False
) -> Compiled:
    """Compile the table mapping.yaml. Nothing is written.

    ``kinds`` are kinds of generated files (targets), such as ``nanopb``. ``templates`` are folders with Jinja
    templates. Both are added to the targets and templates that the table lists. ``vendor_runtime`` has the meaning of
    the table's key ``ros.vendor_runtime``.

    Raises `DiagnosticsError` with all mistakes that can be found in one run.
    """
    text = read_text(table_path, table_path.name)
    return _compiled(table_path, text, further=(tuple(kinds), tuple(templates), vendor_runtime))


def compile_text(
    table_path: Path, text: str, published: lock.Ledger | None = None, others: Mapping[str, str] | None = None
) -> tuple[Compiled, list[Change]]:
    """Compile ``text`` as the new content of mapping.yaml. Nothing is written.

    ``published`` is the ledger to use instead of the file mapping.lock. ``others`` are the new texts of other files
    that the user owns, by path.

    Returns the result, and the changes of all files on disk, including mapping.yaml. Raises `DiagnosticsError` like
    `compile_table`.
    """
    compiled = _compiled(table_path, text, published)
    return compiled, compiled.changes(table_path.resolve().parent, {table_path.name: text, **(others or {})})


def retire(table_path: Path, row: str) -> tuple[Compiled, list[Change]]:
    """Move a row to `retired` in the table's text, and compile the result. Nothing is written.

    ``row`` is the row's number or name. Returns the result, and the changes of all files on disk, including
    mapping.yaml. Raises `DiagnosticsError` if there is no such row, or if the changed table does not compile.
    """
    return _edited(table_path, lambda text, file: with_retired(text, row, file))


def add(table_path: Path, row: Mapping[str, str | int]) -> tuple[Compiled, list[Change]]:
    """Add a row to the table's text, and compile the result. Nothing is written.

    ``row`` has the value of each key: ``{"number": 22, "name": "imu_info", ...}``. Returns the result, and the changes
    of all files on disk, including mapping.yaml. Raises `DiagnosticsError` if `messages` is not a block list (lines
    that start with ``-``) with at least one row, or if the changed table does not compile.
    """
    return _edited(table_path, lambda text, file: with_row(text, row, file))


def _edited(table_path: Path, edit: Callable[[str, str], str]) -> tuple[Compiled, list[Change]]:
    """Change the text of the table with ``edit``, and compile the result.

    ``edit`` gets the text and the file name of the table, and returns the new text. Returns the result, and the changes
    of all files on disk, including the table.
    """
    file = table_path.name
    text = read_text(table_path, file)
    reader.parse(text, file, [])  # raises if the text is not a table; the edit needs one
    text = edit(text, file)
    try:
        return compile_text(table_path, text)
    except DiagnosticsError as error:
        raise DiagnosticsError(error.findings, {file: text}) from error


def recompile(table_path: Path, published: lock.Ledger) -> Compiled:
    """Compile mapping.yaml, but with the ledger ``published`` instead of the file mapping.lock. Nothing is written.

    Raises `DiagnosticsError` like `compile_table`.
    """
    return _compiled(table_path, read_text(table_path, table_path.name), published)


def _compiled(
    table_path: Path,
    text: str,
    published: lock.Ledger | None = None,
    further: tuple[tuple[str, ...], tuple[str, ...], bool] = ((), (), False),
) -> Compiled:
    project = table_path.resolve().parent
    findings: list[Diagnostic] = []
    # Each phase works with what the phases before it could read, and adds its mistakes to the findings. So one run
    # shows all of them; only at the end does an error stop the compiler.
    table = reader.parse(text, table_path.name, findings)
    published = published or lock.read(project / lock.NAME, findings)
    declared = _collecting(findings, lambda: _declared(table, project)) if table.proto.root else None
    index = None if declared is None else index_declarations(declared, table.proto.exclude)
    files = {} if index is None else locate(table, index, findings)
    listed = {} if index is None else locate_anys(table, index, findings)
    envelope = resolve_envelope(table, files, published)
    named = index is not None and all((envelope.file, envelope.message, envelope.oneof))
    compilation = _collecting(findings, lambda: _compile(table, project, envelope, listed)) if named else None
    schema = compilation.schema if compilation else Schema()
    # if a row was left out because of a mistake, its number has not vanished from the envelope
    lacking = envelope.message if not table.whole or any(row.proto not in files for row in table.rows) else ""
    changes = since_last_generate(published, schema, lacking) if compilation else ()
    findings += lint(Context(table, schema, published, changes=changes))
    bridge = None
    if compilation is not None and envelope.message in compilation.schema.messages:
        bounds = table_bounds(table, compilation.schema, project / table.proto.root, findings)
        sizes = row_sizes(table, compilation.schema, bounds)
        protos = {shown(table.proto.root, file): digest for file, digest in compilation.digests.items()}
        bridge = dataclasses.replace(
            resolve(table, compilation, envelope, bounds, sizes, findings),
            sources={table.file: table_digest(text), **protos},
        )
    if has_errors(findings) or bridge is None:
        raise DiagnosticsError(in_order(findings))
    findings += _broken_besides(table, project, envelope, declared or (), schema)
    # The proto root may be the whole project, with virtual environments in it: only an envelope is ours there.
    folders = {**({table.proto.root: ".proto"} if envelope.ours else {}), bridge.folder: ""}
    # Nothing is emitted from a table with errors: a half right envelope on disk would be worse than an old one.
    wanted = table.and_further(*further)
    files = emitter.emit(bridge, wanted, published, project)
    own = (lock.NAME, *published.files)
    repeatable = not wanted.templates and not wanted.ros.vendor_runtime and all(map(targets.built_in, wanted.targets))
    return Compiled(bridge, table.proto.root, files, folders, own, tuple(in_order(findings)), repeatable)


def _collecting(findings: list[Diagnostic], phase: Callable[[], T]) -> T | None:
    """Run a step of the compiler and return its result.

    If the step raises `DiagnosticsError`, add its diagnostics to the findings and return None, so that other steps run.
    """
    try:
        return phase()
    except DiagnosticsError as error:
        findings += error.findings
        return None


def _declared(table: Table, project: Path) -> dict[str, File]:
    """Return the declarations in each .proto file. Raises `DiagnosticsError` if a file cannot be read."""
    root = project / table.proto.root
    if not root.is_dir():
        message = f"the proto root {table.proto.root!r} is not a folder"
        raise DiagnosticsError(
            [
                NoProtoRoot.at(
                    table.proto.at("root"),
                    message,
                    "create the folder, or correct `root`, which is relative to the table",
                )
            ]
        )
    if source_files.leads_out(project, root):
        message = f"the proto root {table.proto.root!r} is outside the git repository"
        help = "move the .proto files into the repository, or add their repository as a submodule"
        raise DiagnosticsError([NoProtoRoot.at(table.proto.at("root"), message, help)])
    findings: list[Diagnostic] = []
    files = read_protos(root, table.proto.root, findings)
    if findings:
        raise DiagnosticsError(findings)
    return files


def _compile(table: Table, project: Path, envelope: ir.Envelope, listed: Mapping[str, str]) -> Compilation:
    """Compile the envelope, the payloads, and the messages that the table lists for an Any, with protoc.

    ``listed`` has the .proto file of each message for an Any, by the message's full name. Raises `DiagnosticsError` if
    protoc reports errors.
    """
    root = project / table.proto.root
    wanted = sorted({*(member.file for member in envelope.members), envelope.file, *listed.values()})
    if not envelope.ours and not (root / envelope.file).is_file():
        message = f"the file {envelope.file!r} does not exist below the proto root {table.proto.root!r}"
        raise DiagnosticsError(
            [
                NoEnvelopeFile.at(
                    table.envelope.at("file"),
                    message,
                    "correct `file`; or write `owner: mapping`, so that `roverlink generate` writes the file",
                )
            ]
        )
    return compile_protos(root, wanted, _written(table, envelope), table.proto.root)


def _written(table: Table, envelope: ir.Envelope) -> dict[str, str]:
    """Return the texts of the .proto files that roverlink writes, by path."""
    if not envelope.ours:
        return {}
    written = {envelope.file: envelope_file.text(_unambiguous(envelope), table.file)}
    if table.link is not None:
        written[table.envelope.link_file] = envelope_file.link_text(table.file)
    return written


def _broken_besides(
    table: Table, project: Path, envelope: ir.Envelope, declared: Iterable[str], schema: Schema
) -> Iterator[Diagnostic]:
    """Yield warnings about the .proto files that do not compile, and that no row needs.

    ``declared`` are the paths of all files, and ``schema`` has those that rows need.
    """
    others = sorted({*declared} - {*schema.files, *table.proto.exclude})
    root = project / table.proto.root
    _, errors = compile_tree(root, others, table.proto.root, _written(table, envelope))
    for error in errors:
        help = "no row needs this file; `roverlink lint` fails until it compiles, or is in `proto.exclude`"
        yield dataclasses.replace(error, severity=Severity.WARNING, help=help)


def _unambiguous(envelope: ir.Envelope) -> ir.Envelope:
    """Return a copy of the envelope without members, or a signature, whose number or name collides with another member.

    protoc would report the collisions too, but the lint rules report them with better messages.
    """
    numbers: set[int] = set()
    names: set[str] = set()
    classes: set[str] = set()
    retired = [row for row in envelope.retired if _is_new(row.number, numbers) and _is_new(row.name, names)]
    members = [
        member
        for member in envelope.members
        if member.name not in {*names, envelope.oneof}
        and member.number not in IMPLEMENTATION_NUMBERS
        and _is_new(member.number, numbers)
        and _is_new(ros_names.distinct(member.name), classes)
    ]
    signature = envelope.signature
    if signature in {*numbers, *IMPLEMENTATION_NUMBERS} or "signature" in {
        *names,
        *(member.name for member in members),
    }:
        signature = None
    return dataclasses.replace(envelope, members=tuple(members), retired=tuple(retired), signature=signature)


def _is_new(value: T, seen: set[T]) -> bool:
    new = value not in seen
    seen.add(value)
    return new
