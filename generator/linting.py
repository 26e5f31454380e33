"""The lint of a project, or of a tree of .proto files that has no table: everything is read, and every rule asked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from generator import ledger, read, tree
from generator.declarations import File, parse
from generator.findings import Finding, FindingsError, Rule, Severity, Span, in_order
from generator.git import Commit, Repository
from generator.nanopb import read_bounds
from generator.proto_files import DeclarationIndex, proto_files, read_proto
from generator.protoc import compile_tree
from generator.protos import Schema
from generator.resolve import locate
from generator.rules import lint
from generator.states import Layout, State, open_state
from generator.subject import Change, Subject
from generator.table import Table

NO_PROTOS = Rule("STA103", "no-protos", Severity.FATAL)


@dataclass(frozen=True, slots=True)
class Linted:
    """What a lint found, and how to show more of it."""

    findings: tuple[Finding, ...]
    folder: Path
    """The folder from which the files of findings are named."""
    commit_of: Callable[[Span], Commit | None]
    """The commit from which a line is; None where it is not committed, or not known."""


def lint_project(table_path: Path, against: str | None) -> Linted:
    """Lint the project of a table. Raises `FindingsError` where nothing can be looked at."""
    project = table_path.resolve().parent
    findings: list[Finding] = []
    table = read.read(table_path, findings, table_path.name)
    published = ledger.read(project / ledger.NAME, findings)
    return _lint(project, table, published, against, findings)


def lint_tree(root: Path, envelope: tree.EnvelopeName, against: str | None) -> Linted:
    """Lint a folder of .proto files, without a table. Raises `FindingsError` where nothing can be looked at."""
    findings: list[Finding] = []
    return _lint(root.resolve(), tree.table_of_tree(envelope), ledger.Ledger(), against, findings)


def _lint(
    project: Path, table: Table, published: ledger.Ledger, against: str | None, findings: list[Finding]
) -> Linted:
    root = project / table.proto.root
    if not root.is_dir():
        message = f"there is no folder {table.proto.root or project}; nothing was looked at"
        raise FindingsError([*findings, NO_PROTOS.at(table.proto.at("root"), message)])
    shown_root = table.proto.root
    files = proto_files(root, shown_root, findings)
    if not files:
        raise FindingsError([*findings, NO_PROTOS.at(Span(shown_root or "."), "holds no .proto file")])
    declared = {file: parse(read_proto(root, file, shown_root, findings)) for file in files}
    kept = {file: text for file, text in declared.items() if file not in table.proto.exclude}
    schema, errors = compile_tree(root, list(kept), shown_root)
    findings += errors
    left_out = {file: text for file, text in declared.items() if file in table.proto.exclude}
    if table.proto.root:
        locate(table, DeclarationIndex(_by_name(kept), _by_name(left_out)), findings)
    table = tree.with_members(table, schema)
    layout = Layout(shown_root, table.proto.exclude, table.envelope.message, table.envelope.oneof)
    state = open_state(against, project, layout, findings) if against else None
    findings += lint(_subject(table, schema, published, state, kept, left_out, findings, root))
    return Linted(tuple(in_order(findings)), project, _blame(project, state))


def _by_name(files: Mapping[str, File]) -> dict[str, list[str]]:
    """The files that declare a message of a name."""
    found: dict[str, list[str]] = {}
    for path, file in files.items():
        for message in file.all_messages():
            found.setdefault(message.full_name, []).append(path)
    return found


def _subject(
    table: Table,
    schema: Schema,
    published: ledger.Ledger,
    state: State | None,
    files: dict[str, File],
    excluded: dict[str, File],
    findings: list[Finding],
    root: Path,
) -> Subject:
    changes = [Change(state.schema, schema, state.name, bounds_before=state.bounds)] if state else []
    if published.entries:
        changes.append(Change(ledger.as_schema(published), schema, ledger.NAME, of_ledger=True))
    return Subject(
        table=table,
        schema=schema,
        ledger=published,
        files=files,
        excluded_files=excluded,
        changes=tuple(changes),
        earlier_entries=state.entries if state else (),
        bounds=read_bounds(schema, root, table.proto.root, findings),
    )


def _blame(project: Path, state: State | None) -> Callable[[Span], Commit | None]:
    """Asks git for the commit of a line, in this state or in the other one."""
    repository = Repository(project)

    def commit_of(span: Span) -> Commit | None:
        if not span.line:
            return None
        if state is not None and span.file.startswith(state.name):
            return state.commit_of(span)
        return repository.commit_of_line(span.file, span.line)

    return commit_of
