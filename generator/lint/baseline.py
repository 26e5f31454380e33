"""The baseline: an earlier state of the project or of its .proto files, with which the lint compares the current state.

The state comes from a git ref, a folder or a descriptor set.
"""

from __future__ import annotations

import contextlib
import dataclasses
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import DecodeError

from roverlink.generator import lock, source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span, shown
from roverlink.generator.git import SUBMODULE, Commit, GitError, Repository, commit_of_line
from roverlink.generator.lint.input_rules import CLONE, DEEPEN, NoSuchState, UnreadableState
from roverlink.generator.lock import Entry, RowSettings
from roverlink.generator.nanopb import Bounds, as_lines, read_bounds, table_bounds
from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.files import read_protos
from roverlink.generator.protos.protoc import compile_tree
from roverlink.generator.protos.schema import Schema
from roverlink.generator.table import Table, reader

_TABLE = "mapping.yaml"
_LARGEST_SET = 64 << 20  # bytes of a descriptor set, which contains many files and their comments


@dataclass(frozen=True, slots=True)
class Layout:
    """Settings of the current project that are needed to read an earlier state of the project."""

    root: str
    """The folder of the .proto files, relative to the project; empty for the project's own folder."""
    exclude: tuple[str, ...]
    """The .proto files that are not compiled. If the earlier state has a table, the table's list is used instead."""
    envelope_message: str
    oneof: str


@dataclass(frozen=True, slots=True)
class Baseline:
    """An earlier state of a project, with which the lint compares the current state."""

    name: str
    """The beginning of the state's file names in diagnostics: the given path, or for a git ref ``main:protos``."""
    schema: Schema
    entries: tuple[Entry, ...]
    """The payloads in the envelope, the ledger and the table of the state."""
    settings: tuple[RowSettings, ...]
    """The settings of the rows, in the table and in the ledger of the state; empty if it has no table."""
    bounds: Bounds | None
    commit_of: Callable[[Span], Commit | None]
    """Function that takes a place and returns the commit that last changed its line; None if this commit is unknown."""
    commit: str = ""
    """The id of the commit with the .proto files; empty if a folder or a file holds the state."""


def open_baseline(spec: str, project: Path, layout: Layout, findings: list[Diagnostic]) -> Baseline:
    """Read the earlier state that ``spec``, the value of the option ``--against``, names.

    ``spec`` is a folder, a file with a descriptor set, or else a git ref. Diagnostics about parts that cannot be read
    are added to ``findings``. Raises `DiagnosticsError` if nothing has this name, or if nothing can be read.
    """
    path = Path(spec)
    if path.is_dir():
        return _baseline_in(Checkout(path.resolve()), spec.rstrip("/") or spec, layout, lambda _: None, findings)
    if path.is_file():
        return _descriptor_set(path, spec, layout)
    return _at_ref(spec, project, layout, findings)


def _descriptor_set(path: Path, spec: str, layout: Layout) -> Baseline:
    try:
        compiled = FileDescriptorSet.FromString(source_files.read(path.parent, path.name, _LARGEST_SET))
    except (OSError, DecodeError) as error:
        why = f": {error.strerror}" if isinstance(error, OSError) else ""
        message = f"the file is not a descriptor set{why}"
        help = "write a descriptor set with `protoc --descriptor_set_out` or `buf build`"
        raise DiagnosticsError([UnreadableState.at(Span(spec), message, help)]) from error
    if not compiled.file:
        raise DiagnosticsError([UnreadableState.at(Span(spec), "the descriptor set contains no .proto file")])
    schema = schema_of(compiled, spec)
    return Baseline(spec, schema, tuple(_members(schema, layout)), (), None, lambda _: None)


def commit_of_ref(repository: Repository, ref: str, option: str) -> str:
    """Return the id of the commit that a ref names; raise `DiagnosticsError` if there is none.

    ``option`` is the option of the command line with the ref, or with a folder or a file.
    """
    try:
        return repository.resolve(ref)
    except GitError as error:
        message, help = f"{ref!r} is not a folder, a file, or a git ref", _other_refs(repository, ref)
        if str(error):  # git says nothing if only the ref is unknown
            message, help = f"{ref!r} is not a folder or a file, and no git ref can be read: {error}", CLONE
        raise DiagnosticsError([NoSuchState.at(Span(option), message, help)]) from error


@dataclass(frozen=True, slots=True)
class Checkout:
    """The files of a state that the lint reads: those on disk, or those of a commit, in a temporary folder.

    The files of a submodule are written by `add_submodules`, because most submodules have nothing to do with the
    .proto files.
    """

    folder: Path
    name: str = ""
    """The beginning of the names of a commit's files in diagnostics; empty for the files on disk."""
    pinned: dict[str, tuple[str, str]] = dataclasses.field(default_factory=dict)
    """The submodules whose files are not written, by path: the path of the repository around it, and its commit."""
    parts: dict[str, tuple[Repository, str]] = dataclasses.field(default_factory=dict)
    """The repositories whose files are written, and the commit of each, by path; that of the project has none."""

    def add(self, repository: Repository, commit: str, path: str, findings: list[Diagnostic]) -> None:
        """Write the files of a repository at a commit; ``path`` is empty, or that of the submodule.

        A diagnostic for each file that is left out is added to ``findings``. Raises `DiagnosticsError` if the commit
        cannot be read.
        """
        self.parts[path] = repository, commit
        try:
            entries = repository.entries(commit)
            links = [(at, id) for mode, id, at in entries if mode == SUBMODULE and not _leads_out(at)]
            self.pinned.update({shown(path, at): (path, id) for at, id in links})
            for file, data in repository.contents(entries, _is_wanted):
                if isinstance(data, str):
                    fault = f"the file cannot be read: {data}"
                elif _leads_out(file):
                    fault = "the path leads out of the folder of the state"
                else:
                    target = self.folder / path / file
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(data)
                    continue
                findings.append(UnreadableState.at(Span(shown(self.name, shown(path, file))), fault))
        except (GitError, OSError) as error:
            message = f"the state cannot be read: {error}"
            raise DiagnosticsError([UnreadableState.at(Span(shown(self.name, path)), message)]) from error

    def add_submodules(self, root: str, findings: list[Diagnostic]) -> None:
        """Write the files of the submodules in the folder ``root``, or around it, as the state pins them.

        Raises `DiagnosticsError`, also with ``findings``, if this clone lacks the commit of the submodule around the
        folder. For one in the folder, a hint is added to ``findings``, unless it is not checked out either.
        """
        while path := next((path for path in self.pinned if _is_part(root, path) or _is_part(path, root)), None):
            at, commit = self.pinned.pop(path)
            around, place = self.parts[at][0], path.removeprefix(f"{at}/")
            if repository := around.submodule_with(place, commit):
                self.add(repository, commit, path, findings)
                continue
            message = f"the submodule's commit {commit[:10]} is not in this clone"
            help = f"get it with `git submodule update --init {path}` or `git -C {path} fetch origin {commit}`"
            finding = UnreadableState.at(Span(shown(self.name, path)), message, help)
            if _is_part(root, path):
                raise DiagnosticsError([*findings, finding])
            if not _is_empty(around.folder / place):
                findings.append(dataclasses.replace(finding, severity=Severity.HINT))

    def commit_of(self, span: Span) -> Commit | None:
        """Return the commit that last changed the line of a place in this state; None if it is not known."""
        file = span.file.removeprefix(shown(self.name, ""))
        path = self._part(file)
        repository, commit = self.parts[path]
        return commit_of_line(_commits_of_lines(repository, file.removeprefix(f"{path}/"), commit), span.line)

    def commit_at(self, folder: str) -> str:
        """Return the id of the commit to which the files in a folder belong: the project's, or that of a submodule.

        It is empty for files on disk.
        """
        return self.parts[self._part(folder)][1] if self.parts else ""

    def _part(self, path: str) -> str:
        return max((part for part in self.parts if _is_part(path, part)), key=len)


_commits_of_lines = cache(Repository.commits_of_lines)


def _is_part(path: str, folder: str) -> bool:
    """Return True if a path is that of the folder, or of something in it; an empty one is the project's folder."""
    return not folder or path == folder or path.startswith(f"{folder}/")


def _leads_out(path: str) -> bool:
    """Return True if a path of a commit leads out of its folder: git can store such a path, but never checks it out."""
    return not {"", "..", ".git"}.isdisjoint(path.split("/"))


def _is_empty(folder: Path) -> bool:
    return folder.is_dir() and not any(folder.iterdir())


@contextlib.contextmanager
def checked_out(repository: Repository, commit: str, ref: str, findings: list[Diagnostic]) -> Iterator[Checkout]:
    """Write the files of a commit that the lint reads to a temporary folder, and yield them.

    ``ref`` is the name of the commit for diagnostics. A diagnostic for each file that is left out is added to
    ``findings``. Raises `DiagnosticsError` if the commit cannot be read.
    """
    with tempfile.TemporaryDirectory(prefix="roverlink-state-") as folder:
        checkout = Checkout(Path(folder), repository.in_commit(ref))
        checkout.add(repository, commit, "", findings)
        yield checkout


def _at_ref(ref: str, project: Path, layout: Layout, findings: list[Diagnostic]) -> Baseline:
    repository = Repository(project)
    commit = commit_of_ref(repository, ref, "--against")
    with checked_out(repository, commit, ref, findings) as checkout:
        try:
            return _baseline_in(checkout, checkout.name, layout, checkout.commit_of, findings)
        except NothingToCompareError as error:
            # A table that is new may stand beside the .proto files of others. A folder without a table may have moved.
            if not layout.root and repository.holds(commit, ".proto"):
                raise
            message = "the earlier state has no .proto file, so nothing was compared"
            hint = dataclasses.replace(UnreadableState.at(Span(ref), message), severity=Severity.HINT)
            raise DiagnosticsError([hint]) from error


class NothingToCompareError(DiagnosticsError):
    """Raised if an earlier state has no .proto file."""


def _other_refs(repository: Repository, ref: str) -> str:
    """Return the help for a git ref that does not exist: which refs there are."""
    try:
        repository.resolve(f"origin/{ref}")
    except GitError:
        return f"`git branch --all` and `git tag` list the refs; a shallow clone gets all of them with {DEEPEN}"
    return f"write 'origin/{ref}': this clone has {ref!r} only as a branch of the remote"


def _is_wanted(file: str) -> bool:
    # The table may have another name than usual.
    ledgers = (lock.NAME, lock.ACCEPTED_NAME)
    return file.endswith((".proto", ".options")) or file in ledgers or (file.endswith(".yaml") and "/" not in file)


def _baseline_in(
    checkout: Checkout,
    name: str,
    layout: Layout,
    commit_of: Callable[[Span], Commit | None],
    findings: list[Diagnostic],
) -> Baseline:
    """Read an earlier state; ``name`` is the beginning of its file names in diagnostics.

    The folder is a project, the folder of a project's .proto files, or any other folder with .proto files.
    """
    # The rules check the current state. Of the earlier state, only faults that make it unreadable are reported, because
    # the user cannot edit it any more.
    folder = checkout.folder
    own: list[Diagnostic] = []  # faults of the earlier state, which cannot be edited
    table = reader.read(folder / _TABLE, own, shown(name, _TABLE)) if (folder / _TABLE).is_file() else None
    published = lock.read(folder / lock.NAME, own, shown(name, lock.NAME))
    checkout.add_submodules(table.proto.root if table else layout.root, findings)
    root = table.proto.root if table else (layout.root if (folder / layout.root).is_dir() else "")
    shown_root = shown(name, root) if root else name
    files = read_protos(folder / root, shown_root, findings) if (folder / root).is_dir() else {}
    if not files:
        message = "the earlier state contains no .proto file"
        raise NothingToCompareError([*findings, UnreadableState.at(Span(shown_root), message)])
    excluded = table.proto.exclude if table else layout.exclude
    schema, errors = compile_tree(folder / root, [file for file in files if file not in excluded], shown_root)
    findings += [finding for finding in own if finding.severity is Severity.FATAL]
    findings += [_of_state(error) for error in errors]
    entries = (*published.entries, *_rows(table), *_members(schema, layout))
    of_table = as_lines(table_bounds(table, schema, folder / root, [])) if table else {}
    settings = (*([lock.settings_of_rows(table)] if table else []), published.settings)
    bounds = read_bounds(schema, folder / root, shown_root, [], of_table)
    return Baseline(name, schema, entries, settings, bounds, commit_of, checkout.commit_at(root))


def _of_state(error: Diagnostic) -> Diagnostic:
    """Return the diagnostic for an error of protoc in a file of the earlier state.

    The user cannot edit an earlier state, so the help suggests a comparison with another state.
    """
    help = "compare with another state, or with a descriptor set"
    return UnreadableState.at(error.span, f"the earlier state does not compile: {error.message}", help)


def _rows(table: Table | None) -> list[Entry]:
    rows = table.rows if table else ()
    return [Entry(row.number, row.name, row.proto, row.topic, False, False, row.at("number")) for row in rows]


def _members(schema: Schema, layout: Layout) -> list[Entry]:
    """Return the payloads in the envelope of an earlier state: the members of the envelope's oneof."""
    envelope = schema.messages.get(layout.envelope_message)
    fields = [field for field in envelope.fields if field.oneof == layout.oneof] if envelope else []
    return [Entry(field.number, field.name, field.wire_type, "", False, False, field.span) for field in fields]
