"""Complete run of the lint: reads all inputs and runs all rules.

The input is a project with a table (mapping.yaml), or a folder of .proto files without a table.
"""

from __future__ import annotations

import contextlib
import dataclasses
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from roverlink.generator import lock, source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span, in_order, shown
from roverlink.generator.git import Commit, GitError, Repository, commit_of_line
from roverlink.generator.lint import bare_tree, buf
from roverlink.generator.lint.baseline import Baseline, nothing_compared, open_baseline, read_state
from roverlink.generator.lint.consumer_pins import read_pins
from roverlink.generator.lint.context import Context, Past
from roverlink.generator.lint.engine import lint
from roverlink.generator.lint.git_states import Checkout, checked_out, commit_of_ref
from roverlink.generator.lint.history.uncommitted import CheckedOut
from roverlink.generator.lint.input_rules import (
    CLONE,
    DEEPEN,
    LimitedHistory,
    NoProtos,
    PastNotFollowed,
    UnreadableHistory,
)
from roverlink.generator.lint.pinned_states import PinnedStates, ProtoState, StateReader, compare_states
from roverlink.generator.lint.wrong_root import wrong_root
from roverlink.generator.protos.files import read_protos
from roverlink.generator.protos.proto_rules import ProtoDoesNotCompile
from roverlink.generator.protos.schema import Schema
from roverlink.generator.table import Table, reader
from roverlink.numerals import counted

if TYPE_CHECKING:
    from roverlink.generator.lint.history import History


@dataclass(frozen=True, slots=True)
class Question:
    """Options of a lint run: the checks that the user requests in addition to the check of the current state."""

    against: str | None = None
    """The earlier state to compare with: a folder, a descriptor set, or a git ref. None for no comparison."""
    with_buf: bool = False
    """True if the program buf must also compare the earlier state with the current one."""
    history: bool = False
    """True if the lint must check the history of every number in git."""
    newest: str = ""
    """The git ref whose state is checked; empty for the files on disk, with the changes that are not committed yet."""
    branches: bool = False
    """True if the lint must compare the branches that are not merged yet with each other."""
    pins: tuple[Path, ...] = ()
    """Files and repositories that say which commit of the .proto files each other project uses."""
    envelope: bool = False
    """True if the lint must fail when the user does not name the envelope's message."""
    report: Callable[[int, int], None] | None = None
    """Function that shows progress: it gets the number of file states read from git so far, and their total number.

    None if no progress is shown.
    """

    @property
    def of_the_past(self) -> bool:
        """True if one of the requested checks needs the history in git."""
        return self.history or self.branches or bool(self.pins)

    @property
    def of_the_envelope(self) -> bool:
        """True if a requested check needs the envelope's message, so that the lint must fail if it is not named."""
        return self.envelope or self.branches or bool(self.pins)


@dataclass(frozen=True, slots=True)
class Linted:
    """Result of a lint run: the diagnostics, and the data that commands need to show or accept them."""

    findings: tuple[Diagnostic, ...]
    folder: Path
    """The folder to which the paths in diagnostics are relative."""
    texts: Mapping[str, str]
    """Texts of files that differ from those on disk, by path: those of the git ref that was checked, if any."""
    commit_of: Callable[[Span], Commit | None]
    """Function that takes a place and returns the commit that last changed its line; None if this commit is unknown."""
    context: Context
    """The context that the rules looked at."""

    def limits(self, owner: str) -> list[Diagnostic]:
        """Return the diagnostics about inputs because of which the numbers of a message or enum may be incomplete.

        These are fatal ones, those about the whole repository, and those about files that declare or once declared
        ``owner``, the full name of the message or enum.
        """
        context = self.context
        files = {path for path, _ in context.declared(owner)}
        files |= context.past.history.files(owner) if context.past else set()
        root = context.table.proto.root
        concerned = {root or ".", *(shown(root, path) for path in files)}
        partly = (LimitedHistory, PastNotFollowed, ProtoDoesNotCompile)
        return [
            finding
            for finding in self.findings
            if finding.severity is Severity.FATAL or (finding.rule in partly and finding.span.file in concerned)
        ]


def not_linted(error: DiagnosticsError, folder: Path) -> Linted:
    """Return the result of a lint run that an error ended: only the error's diagnostics.

    The paths in the diagnostics are relative to ``folder``.
    """
    nothing = Context(bare_tree.table_of_tree(bare_tree.TreeOptions("", "")), Schema(), lock.Ledger())
    return Linted(error.findings, folder, error.texts, lambda _: None, nothing)


def lint_project(table_path: Path, question: Question) -> Linted:
    """Lint the project that belongs to the table at ``table_path``.

    Raises `DiagnosticsError` if nothing can be linted.
    """
    project = table_path.parent.resolve()
    findings: list[Diagnostic] = []
    with _state(project, question.newest, findings) as checkout:
        table = reader.read(checkout.folder / table_path.name, findings, table_path.name)
        published = lock.read(checkout.folder / lock.NAME, findings)
        if not table.proto.root:  # `proto` is missing or misspelt: the project's folder is not what the user meant
            raise DiagnosticsError([*findings, *lint(Context(table, Schema(), published))])
        checkout.add_submodules(table.proto.root, findings)
        return _lint(checkout, project, table, published, question, findings)


def lint_tree(root: Path, envelope: bare_tree.TreeOptions, question: Question) -> Linted:
    """Lint the folder ``root`` of .proto files, which has no table.

    Raises `DiagnosticsError` if nothing can be linted.
    """
    project, table = root.resolve(), bare_tree.table_of_tree(envelope)
    findings: list[Diagnostic] = []
    _must_be_folder(project, os.path.relpath(root), table, findings)
    with _state(project, question.newest, findings) as checkout:
        checkout.add_submodules("", findings)
        published = lock.read(checkout.folder / lock.ACCEPTED_NAME, findings, lock.ACCEPTED_NAME)
        return _lint(checkout, project, table, published, question, findings)


@contextlib.contextmanager
def _state(project: Path, newest: str, findings: list[Diagnostic]) -> Iterator[Checkout]:
    """Yield the files to check: those in the project's folder, or in a temporary folder those of a ref.

    In a hook of ``git commit``, these are the files that the commit will contain. A diagnostic for each file that is
    left out is added to ``findings``.
    """
    repository = CheckedOut(project)
    if not newest and project.is_dir() and (tree := _tree_of_hook(repository)):
        with checked_out(repository, tree, "index", findings) as checkout:
            yield checkout
        return
    if not newest or not project.is_dir():
        yield Checkout(project)
        return
    with checked_out(repository, commit_of_ref(repository, newest, "--history"), newest, findings) as checkout:
        yield checkout


def _tree_of_hook(repository: CheckedOut) -> str:
    try:
        return repository.tree_of_hook()
    except GitError:  # the project is in no repository
        return ""


def _lint(
    checkout: Checkout,
    project: Path,
    table: Table,
    published: lock.Ledger,
    question: Question,
    faults: list[Diagnostic],
) -> Linted:
    """Check the files of the state of the project that is checked. ``project`` is in git.

    ``faults`` are the diagnostics about the parts of the state that were read before.
    """
    if question.with_buf:
        buf.require()
    folder, commit = checkout.folder, checkout.commit_at(table.proto.root)
    if question.newest and commit != checkout.commit_at(""):  # a ref names no commit of a submodule
        question = dataclasses.replace(question, newest=commit)
    root, shown_root = folder / table.proto.root, table.proto.root
    _must_be_folder(root, table.proto.root, table, faults)
    if table.proto.root and source_files.leads_out(folder, root):
        message = f"the folder {table.proto.root!r} is outside the git repository"
        help = "move the .proto files into the repository, or add their repository as a submodule"
        raise DiagnosticsError([*faults, NoProtos.at(table.proto.at("root"), message, help)])
    in_git, faults_before = project / table.proto.root, len(faults)
    declared = read_protos(root, shown_root, faults)
    unread = len(faults) > faults_before
    shown_to_user = shown_root or os.path.relpath(in_git)
    if wrong := wrong_root(root, declared, shown_to_user, table.proto.at("root")):
        raise DiagnosticsError([*faults, wrong])
    findings: list[Diagnostic] = []  # about the other inputs of this run
    past = _past(in_git, shown_root, question, findings) if question.of_the_past else None
    if not declared and not unread and not (past and past.history.messages):
        message = "the folder contains no .proto file"
        help = (
            "give the folder that contains your .proto files; `git submodule update --init` gets those of a submodule"
        )
        raise DiagnosticsError([*faults, *findings, NoProtos.at(Span(shown_root or "."), message, help)])
    today = read_state(root, shown_root, declared, table, published, faults)
    schema = today.checkout or today.schema
    past_names = past.history.messages if past else ()
    if missing := bare_tree.missing_envelope(today.table, schema, past_names, required=question.of_the_envelope):
        # A name that no file declares is a mistake on the command line, but a broken file is a fault of the state.
        if today.table.envelope.message not in schema.messages or today.table is table:
            raise DiagnosticsError([*findings, *today.faults, missing])
        today = dataclasses.replace(today, faults=(*today.faults, missing))
    baseline = _baseline(question, project, table, findings)
    if past and question.pins:
        before = baseline.state if baseline else None
        pinned, pinned_before = _pinned(in_git, today, before, past.history, question, findings)
        past = dataclasses.replace(past, pinned=pinned, pinned_before=pinned_before)
    if past and baseline and baseline.commit:
        with contextlib.suppress(GitError):  # today the .proto files are in another repository than in the baseline
            past = dataclasses.replace(past, change=_change(in_git, question.newest, baseline.commit))
    context = dataclasses.replace(today, past=past, tree="" if shown_root else shown_to_user)
    if baseline is not None:
        context = context.compared_with(baseline.state)
        if nothing := nothing_compared(context.changes[0], baseline.state, today):
            findings.append(nothing)
    compared = (baseline.state.schema, today.schema) if question.with_buf and baseline else None
    theirs = _of_buf(*compared, shown_root, findings) if compared else []
    findings += lint(context, theirs)
    ordered = tuple(in_order(findings))
    texts = {} if folder == project else _texts(folder, ordered)
    return Linted(ordered, project, texts, _blame(project, checkout, question.newest, baseline), context)


def _must_be_folder(root: Path, shown_root: str, table: Table, findings: list[Diagnostic]) -> None:
    """Raise `DiagnosticsError`, also with ``findings``, if the folder of the .proto files is none."""
    if root.is_dir():
        return
    message, help = f"the folder {shown_root!r} does not exist", "correct the path of the folder"
    if root.is_file():
        message = f"{shown_root!r} is a file, not a folder"
        help = f"give the folder from which its imports are found, such as {os.path.dirname(shown_root) or '.'!r}"
    raise DiagnosticsError([*findings, NoProtos.at(table.proto.at("root"), message, help)])


def _texts(folder: Path, findings: tuple[Diagnostic, ...]) -> dict[str, str]:
    """Return the texts of the files in a temporary folder that diagnostics are about, by path."""
    files = sorted({finding.span.file for finding in findings})
    return {file: source_files.quoted_text(folder / file) for file in files if (folder / file).is_file()}


def _past(root: Path, shown_root: str, question: Question, findings: list[Diagnostic]) -> Past:
    """Read the history and branches of the .proto files in git.

    ``shown_root`` is the name of the folder ``root`` in diagnostics. Raises `DiagnosticsError` if git cannot read the
    history, for example because the folder is in no repository.
    """
    from roverlink.generator.lint.history import read_history  # here: most runs do not read the history

    try:
        history = read_history(root, question.report, question.newest)
    except GitError as error:
        message = f"the history cannot be read: {error}"
        raise DiagnosticsError([*findings, UnreadableHistory.at(Span(shown_root or "."), message, CLONE)]) from error
    if history.shallow:
        message = (
            f"this is a shallow clone: its history goes back only {history.depth} commit{'s' * (history.depth != 1)}"
        )
        findings.append(LimitedHistory.at(Span(shown_root or "."), message, f"get the rest with {DEEPEN}"))
    for path in history.unread:
        findings.append(
            LimitedHistory.at(
                Span(shown(shown_root, path)),
                "some earlier versions of this file are binary, too large, or missing, and were not checked",
            )
        )
    for commit, lost in groupby(history.lost, key=lambda loss: loss.commit):
        first, *others = lost
        and_others = f", nor that of {counted(len(others), 'other file')}" if others else ""
        why = (
            f"the commit put it in the place of the submodule {first.origin!r}, whose repository has its history"
            if first.of_submodule
            else f"the commit copied it from {first.origin!r}, and another commit deleted that file"
        )
        message = f"the history of this file before {commit} was not read{and_others}: {why}"
        help = "look at its earlier numbers yourself, and reserve those that are not used any more"
        findings.append(PastNotFollowed.at(Span(shown(shown_root, first.path)), message, help))
    return Past(history, question.history, question.branches)


def _pinned(
    root: Path,
    today: Context,
    before: Context | None,
    history: History,
    question: Question,
    findings: list[Diagnostic],
) -> tuple[PinnedStates, PinnedStates | None]:
    """Read the states that other projects use (pins), and compare them with each other and with the checkout.

    ``today`` is the state that is checked. The second result compares with the baseline ``before`` in its place.
    """
    envelope, repository = today.table.envelope.message, Repository(root)
    former = [name for type in history.types if envelope in type.names for name in type.names]
    reader = StateReader(repository, (envelope, *former), today.table.proto.exclude)
    read = reader.consumers(read_pins(question.pins, findings), findings)
    known = [(consumer.commit.id, dataclasses.replace(state, consumers=(consumer,))) for consumer, state in read]
    name = f"the ref {question.newest!r}" if question.newest else "this checkout"
    try:
        head = repository.resolve(question.newest or "HEAD")
    except GitError:
        head = ""  # the branch has no commit yet; then the checkout is the newest state
    order = [*repository.in_order(filter(None, [head, *(commit for commit, _ in known)])), ""]

    def compared_with(context: Context) -> PinnedStates:
        schema = context.checkout or context.schema
        checkout = ProtoState(schema, reader.envelope_in(schema), checkout=name)
        states = sorted([*known, (head, checkout)], key=lambda state: order.index(state[0]))
        return compare_states([state for _, state in states if state.envelope])

    return compared_with(today), compared_with(before) if before else None


def _baseline(question: Question, project: Path, today: Table, findings: list[Diagnostic]) -> Baseline | None:
    """Read the earlier state that the user wants to compare with; None if the user requested no comparison.

    If the state cannot be read, a diagnostic is added to ``findings`` and the result is None. The other checks still
    run.
    """
    try:
        return open_baseline(question.against, project, today, findings) if question.against else None
    except DiagnosticsError as error:
        findings += [finding for finding in error.findings if finding not in findings]
        return None


def _of_buf(before: Schema, after: Schema, shown_root: str, findings: list[Diagnostic]) -> list[Diagnostic]:
    """Compare two states with the program buf, and return the diagnostics of buf.

    If buf fails, a diagnostic is added to ``findings`` and the list is empty. The lint continues.
    """
    try:
        return buf.breaking(before, after, shown_root)
    except DiagnosticsError as error:
        findings += error.findings
        return []


def _change(project: Path, newest: str, base: str) -> frozenset[str]:
    """Return the ids of the commits that the state which is checked has in addition to the commit ``base``."""
    repository = CheckedOut(project)
    return repository.since(base, [repository.resolve(newest)] if newest else repository.parents())


def _blame(
    project: Path, checkout: Checkout, newest: str, baseline: Baseline | None
) -> Callable[[Span], Commit | None]:
    """Return a function that finds the commit which last changed the line of a place.

    The place is in the baseline, the earlier state, or in the current state, whose files are in ``checkout``. The
    function returns None if the commit is unknown.
    """
    # git finds the repository of a file's folder, which may be a submodule.
    commits_of = cache(lambda path: Repository(path.parent).commits_of_lines(path.name))

    def commit_of(span: Span) -> Commit | None:
        if not span.line:
            return None
        if baseline is not None and span.file.startswith(baseline.state.name):
            return baseline.commit_of(span)
        if checkout.folder != project:  # without a ref, the files are those of the index: no commit has its lines
            return checkout.commit_of(span) if newest else None
        # The name of a file of an earlier commit starts with the commit.
        path = project / span.file
        return commit_of_line(commits_of(path), span.line) if path.is_file() else None

    return commit_of
