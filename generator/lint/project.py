"""The lint as a whole: reads all inputs and runs all rules, for a project or a tree of .proto files without a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span, in_order
from roverlink.generator.git import Commit, GitError, Repository
from roverlink.generator.lint import bare_tree, buf
from roverlink.generator.lint.baseline import Baseline, Layout, open_baseline
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.consumer_pins import read_pins
from roverlink.generator.lint.context import Context, Past, since_last_generate
from roverlink.generator.lint.engine import lint
from roverlink.generator.lint.history import read_history
from roverlink.generator.lint.input_rules import LIMITED_HISTORY, NO_PROTOS, UNREADABLE_HISTORY
from roverlink.generator.lint.pinned_numbers import read_pinned
from roverlink.generator.nanopb import as_lines, read_bounds, table_bounds
from roverlink.generator.protos.files import index_declarations, read_protos
from roverlink.generator.protos.proto_rules import DOES_NOT_COMPILE
from roverlink.generator.protos.protoc import compile_tree
from roverlink.generator.protos.schema import Schema
from roverlink.generator.resolve.locate import locate
from roverlink.generator.table import Table, reader


@dataclass(frozen=True, slots=True)
class Question:
    """The checks that the user requests in addition to the check of the current state."""

    against: str | None = None
    """The earlier state to compare with: a folder, a descriptor set, or a git ref. None for no comparison."""
    with_buf: bool = False
    """True if the program buf has to compare the two states, too."""
    history: bool = False
    """True if the lint has to check every number's history in git."""
    branches: bool = False
    """True if the lint has to compare open branches with each other."""
    pins: tuple[Path, ...] = ()
    """Files and repositories from which to read the commits of the protos that other projects use."""
    envelope: bool = False
    """True if the lint has to fail when the user names no envelope."""
    report: Callable[[int, int], None] | None = None
    """Function that is called with the number of file states read from history, and their total."""

    @property
    def of_the_past(self) -> bool:
        """True if one of the requested checks needs the history in git."""
        return self.history or self.branches or bool(self.pins)

    @property
    def of_the_envelope(self) -> bool:
        """True if the lint has to fail when the envelope's message is not named."""
        return self.envelope or self.branches or bool(self.pins)


@dataclass(frozen=True, slots=True)
class Linted:
    """The diagnostics of a lint, and the data that commands need to show or accept them."""

    findings: tuple[Diagnostic, ...]
    folder: Path
    """The folder to which the paths in diagnostics are relative."""
    commit_of: Callable[[Span], Commit | None]
    """Function that returns the commit which last changed the line of a place; None if it is unknown."""
    context: Context
    """The context that the rules looked at."""

    @property
    def limits(self) -> list[Diagnostic]:
        """The diagnostics that say that an input could not be read, or not completely."""
        partly = (LIMITED_HISTORY, DOES_NOT_COMPILE)
        return [one for one in self.findings if one.severity is Severity.FATAL or one.rule in partly]


def lint_project(table_path: Path, question: Question) -> Linted:
    """Lint the project of a table. Raises `DiagnosticsError` if nothing can be linted."""
    project = table_path.resolve().parent
    findings: list[Diagnostic] = []
    table = reader.read(table_path, findings, table_path.name)
    published = lock.read(project / lock.NAME, findings)
    return _lint(project, table, published, question, findings)


def lint_tree(root: Path, envelope: bare_tree.EnvelopeName, question: Question) -> Linted:
    """Lint a folder of .proto files without a table. Raises `DiagnosticsError` if nothing can be linted."""
    findings: list[Diagnostic] = []
    return _lint(root.resolve(), bare_tree.table_of_tree(envelope), lock.Ledger(), question, findings)


def _lint(
    project: Path, table: Table, published: lock.Ledger, question: Question, findings: list[Diagnostic]
) -> Linted:
    if question.with_buf:
        buf.require()
    root, shown_root = project / table.proto.root, table.proto.root
    if not root.is_dir():
        message = f"the folder {str(table.proto.root or project)!r} does not exist; nothing was linted"
        raise DiagnosticsError([*findings, NO_PROTOS.at(table.proto.at("root"), message)])
    if question.of_the_envelope:
        bare_tree.must_have_envelope(table, findings)
    past = _past(root, table.envelope.message, question, findings) if question.of_the_past else None
    found_before = len(findings)
    declared = read_protos(root, shown_root, findings)
    if not declared and len(findings) == found_before and not (past and past.history.messages):
        raise DiagnosticsError([*findings, NO_PROTOS.at(Span(shown_root or "."), "contains no .proto file")])
    kept = {file: text for file, text in declared.items() if file not in table.proto.exclude}
    left_out = {file: text for file, text in declared.items() if file in table.proto.exclude}
    schema, errors = compile_tree(root, list(kept), shown_root)
    findings += errors
    if table.proto.root:
        locate(table, index_declarations(declared, table.proto.exclude), findings)
    table = bare_tree.with_members(table, schema, findings, past.history.messages if past else ())
    of_table = as_lines(table_bounds(table, schema, root, findings))
    layout = Layout(shown_root, table.proto.exclude, table.envelope.message, table.envelope.oneof)
    baseline = _baseline(question, project, layout, findings)
    context = Context(
        table=table,
        schema=schema,
        ledger=published,
        files=kept,
        excluded_files=left_out,
        changes=_changes(schema, baseline, published),
        earlier_entries=baseline.entries if baseline else (),
        bounds=read_bounds(schema, root, table.proto.root, findings, of_table),
        past=past,
    )
    theirs = _of_buf(baseline.schema, schema, shown_root, findings) if question.with_buf and baseline else []
    findings += lint(context, theirs)
    return Linted(tuple(in_order(findings)), project, _blame(project, baseline), context)


def _past(root: Path, envelope: str, question: Question, findings: list[Diagnostic]) -> Past:
    """Read the history, the branches and the pins that the user requested.

    Raises `DiagnosticsError` if the folder is not in a git repository.
    """
    try:
        history = read_history(root, question.report)
    except GitError as error:
        message = "the history cannot be read"
        raise DiagnosticsError([*findings, UNREADABLE_HISTORY.at(Span(str(root)), message, str(error))]) from error
    if history.shallow:
        message = f"this is a shallow clone: its history goes back only {history.depth} commits"
        findings.append(LIMITED_HISTORY.at(Span(str(root)), message, "`git fetch --unshallow` gets the rest"))
    for path in history.unread:
        findings.append(
            LIMITED_HISTORY.at(
                Span(path), "some past states of this file are binary, too large, or missing, and were not checked"
            )
        )
    pins = read_pinned(read_pins(question.pins, findings), Repository(root), envelope, findings)
    return Past(history, question.history, question.branches, tuple(pins))


def _baseline(question: Question, project: Path, layout: Layout, findings: list[Diagnostic]) -> Baseline | None:
    """Read the earlier state to compare with; None if the user requested none.

    If the state cannot be read, this is reported, and None is returned, so that the other checks still run.
    """
    try:
        return open_baseline(question.against, project, layout, findings) if question.against else None
    except DiagnosticsError as error:
        findings += [finding for finding in error.findings if finding not in findings]
        return None


def _of_buf(before: Schema, after: Schema, shown_root: str, findings: list[Diagnostic]) -> list[Diagnostic]:
    """Return the diagnostics of buf.

    If buf fails, this is reported, and the list is empty, so that the lint continues.
    """
    try:
        return buf.breaking(before, after, shown_root)
    except DiagnosticsError as error:
        findings += error.findings
        return []


def _changes(schema: Schema, baseline: Baseline | None, published: lock.Ledger) -> tuple[SchemaChange, ...]:
    changes = [SchemaChange(baseline.schema, schema, bounds_before=baseline.bounds)] if baseline else []
    return (*changes, *since_last_generate(published, schema))


def _blame(project: Path, baseline: Baseline | None) -> Callable[[Span], Commit | None]:
    """Return a function that finds the commit which last changed a line, in the current state or in the baseline."""
    repository = Repository(project)

    def commit_of(span: Span) -> Commit | None:
        if not span.line:
            return None
        if baseline is not None and span.file.startswith(baseline.name):
            return baseline.commit_of(span)
        if not (project / span.file).is_file():  # a file of an earlier commit: its name starts with the commit
            return None
        return repository.commit_of_line(span.file, span.line)

    return commit_of
