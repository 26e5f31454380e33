"""The baseline: an earlier state of the project or of its .proto files, with which the lint compares the current state.

The state comes from a git ref, a folder or a descriptor set. It is read like the current state (`read_state`), and the
same rules run on it. What they report there, the baseline has already: only what the change breaks is an error.
"""

from __future__ import annotations

import dataclasses
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import DecodeError

from roverlink.generator import lock, source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span, shown
from roverlink.generator.git import Commit, Repository
from roverlink.generator.lint import bare_tree
from roverlink.generator.lint.comparison import SchemaChange
from roverlink.generator.lint.context import Context, since_last_generate
from roverlink.generator.lint.git_states import Checkout, checked_out, commit_of_ref
from roverlink.generator.lint.input_rules import UnreadableState
from roverlink.generator.lock import Ledger
from roverlink.generator.nanopb import as_lines, read_bounds, table_bounds
from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.files import index_declarations, read_protos
from roverlink.generator.protos.parser import File
from roverlink.generator.protos.protoc import compile_tree
from roverlink.generator.protos.uncompiled import with_uncompiled
from roverlink.generator.resolve.locate import locate
from roverlink.generator.table import Table, reader

_TABLE = "mapping.yaml"
_LARGEST_SET = 64 << 20  # bytes of a descriptor set, which contains many files and their comments
_MOST_NAMED = 3
_LINE = re.compile(r":\d+(:\d+)?\b")


@dataclass(frozen=True, slots=True)
class Baseline:
    """An earlier state of a project, with which the lint compares the current state."""

    state: Context
    commit_of: Callable[[Span], Commit | None] = lambda _: None
    """Function that takes a place and returns the commit that last changed its line; None if this commit is unknown."""
    commit: str = ""
    """The id of the commit with the .proto files; empty if a folder or a file holds the state."""


def read_state(
    root: Path,
    shown_root: str,
    declared: Mapping[str, File],
    table: Table,
    published: Ledger,
    faults: Iterable[Diagnostic],
    name: str = "",
) -> Context:
    """Compile the .proto files of a state of the project, the current one or the baseline, and return the state.

    ``root`` is the folder of the .proto files, ``shown_root`` its name in diagnostics, and ``declared`` the content of
    its files. ``faults`` are the diagnostics of what was read before. ``name`` is the name of a baseline.
    """
    kept = {file: text for file, text in declared.items() if file not in table.proto.exclude}
    # A table says that its project is aware of a clash. The option --exclude says that the files are not its business.
    excluded = table.proto.exclude if table.proto.root else ()
    left_out = {file: text for file, text in declared.items() if file in excluded}
    # Of two files that clash, protoc reports the later one. It must be the one that the envelope does not import.
    needed = bare_tree.files_of(table.envelope, kept)
    schema, errors = compile_tree(root, sorted(kept, key=lambda file: file not in needed), shown_root)
    faults = [*faults, *errors]
    if table.proto.root:
        locate(table, index_declarations(declared, table.proto.exclude), faults)
    checkout = with_uncompiled(schema, kept, shown_root)
    table = bare_tree.with_members(table, checkout)
    of_table = as_lines(table_bounds(table, schema, root, faults))
    limited = any(peer.max_size is not None for peer in table.peers)
    bounds = read_bounds(schema, root, shown_root, faults, of_table, needed=limited)
    return Context(
        table=table,
        schema=schema,
        ledger=published,
        files=kept,
        excluded_files=left_out,
        shown_root=shown_root,
        name=name,
        faults=tuple(faults),
        changes=since_last_generate(published, schema),
        bounds=bounds,
        checkout=checkout,
    )


def without_known(findings: Iterable[Diagnostic], base: Context, of_base: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Yield diagnostics of the current state, as hints if the baseline has the same fault already.

    ``of_base`` are the diagnostics of the same rules in the baseline. If it has a fault once, and the current state has
    it twice, one of the two is new.
    """
    left = Counter(_fault(finding, shown(base.name, "")) for finding in of_base)
    for finding in findings:
        fault = _fault(finding, "")
        left[fault] -= 1
        yield finding.as_known() if left[fault] >= 0 else finding


def _fault(finding: Diagnostic, prefix: str) -> tuple[str, str, int | None, str]:
    """Return what stays the same of a diagnostic if lines move. Its file names begin with ``prefix``."""
    about = finding.type or finding.span.file.removeprefix(prefix)
    message = finding.message.replace(prefix, "") if prefix else finding.message
    return finding.rule.id, about, finding.number, _LINE.sub("", message)


def open_baseline(spec: str, project: Path, today: Table, findings: list[Diagnostic]) -> Baseline:
    """Read the earlier state that ``spec``, the value of the option ``--against``, names.

    ``spec`` is a folder, a file with a descriptor set, or else a git ref. ``today`` is the table of the current state,
    which also says how to read a state without a table. A hint about parts that cannot be compared is added to
    ``findings``. Raises `DiagnosticsError` if nothing has this name, or if nothing can be read.
    """
    path = Path(spec)
    if path.is_dir():
        return _baseline_in(Checkout(path.resolve(), spec.rstrip("/") or spec), today, [], findings)
    if path.is_file():
        return Baseline(_descriptor_set(path, spec, today))
    return _at_ref(spec, project, today, findings)


def _descriptor_set(path: Path, spec: str, today: Table) -> Context:
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
    return Context(bare_tree.with_members(bare_tree.without_rows(today), schema), schema, Ledger(), name=spec)


def _at_ref(ref: str, project: Path, today: Table, findings: list[Diagnostic]) -> Baseline:
    repository = Repository(project)
    commit = commit_of_ref(repository, ref, "--against")
    faults: list[Diagnostic] = []
    with checked_out(repository, commit, ref, faults) as checkout:
        try:
            return _baseline_in(checkout, today, faults, findings)
        except NothingToCompareError as error:
            # A table that is new may stand beside the .proto files of others. A folder without a table may have moved.
            if not today.proto.root and repository.holds(commit, ".proto"):
                raise
            message = "the earlier state has no .proto file, so nothing was compared"
            hint = dataclasses.replace(UnreadableState.at(Span(ref), message), severity=Severity.HINT)
            raise DiagnosticsError([hint]) from error


class NothingToCompareError(DiagnosticsError):
    """Raised if an earlier state has no .proto file."""


def _baseline_in(checkout: Checkout, today: Table, faults: list[Diagnostic], findings: list[Diagnostic]) -> Baseline:
    """Read an earlier state.

    The folder is a project, the folder of a project's .proto files, or any other folder with .proto files. ``faults``
    are the diagnostics about files that the folder lacks.
    """
    folder, name = checkout.folder, checkout.name
    table = bare_tree.without_rows(today)
    if (folder / _TABLE).is_file():
        try:
            table = reader.read(folder / _TABLE, faults, shown(name, _TABLE))
        except DiagnosticsError as error:
            faults += error.findings
    ledger = lock.ACCEPTED_NAME if (folder / lock.ACCEPTED_NAME).is_file() else lock.NAME
    published = lock.read(folder / ledger, faults, shown(name, ledger))
    checkout.add_submodules(table.proto.root or today.proto.root, findings)
    root = table.proto.root or (today.proto.root if (folder / today.proto.root).is_dir() else "")
    shown_root = shown(name, root) if root else name
    files = read_protos(folder / root, shown_root, faults) if (folder / root).is_dir() else {}
    if not files:
        message = "the earlier state contains no .proto file"
        raise NothingToCompareError([*faults, UnreadableState.at(Span(shown_root), message)])
    state = read_state(folder / root, shown_root, files, table, published, faults, name)
    if finding := bare_tree.missing_envelope(state.table, state.checkout or state.schema):
        state = dataclasses.replace(state, faults=(*state.faults, finding))
    # The earlier state cannot be edited any more, so its own faults are only worth a hint: what was not compared.
    parsed = state.read_files.without_an_import()
    unread = {finding.span.file for finding in faults if finding.severity is Severity.FATAL}
    unread |= {shown(shown_root, file) for file in state.schema.uncompiled if file not in parsed}
    if lost := sorted(unread):
        message = (
            f"changes of these files were not compared, because the earlier state cannot be read there: {_named(lost)}"
        )
        help = "look at them yourself; with --history, their numbers are checked as far as they can be read"
        findings.append(dataclasses.replace(UnreadableState.at(Span(lost[0]), message, help), severity=Severity.HINT))
    if lacking := sorted(shown(shown_root, file) for file in parsed):
        message = (
            "of these files, numbers, names and types were compared, but no options, because an import is missing: "
            f"{_named(lacking)}"
        )
        findings.append(dataclasses.replace(UnreadableState.at(Span(lacking[0]), message), severity=Severity.HINT))
    return Baseline(state, checkout.commit_of, checkout.commit_at(root))


def _named(files: Sequence[str]) -> str:
    """Return the names of some files as a list for a message, which does not name all of many."""
    more = len(files) - _MOST_NAMED
    return ", ".join(files[:_MOST_NAMED]) + (f", and {more} others" if more > 0 else "")


def nothing_compared(change: SchemaChange, base: Context, today: Context) -> Diagnostic | None:
    """Return the diagnostic for a comparison in which the baseline has no declaration that can be read; else None.

    If the current state has files that compile, it repairs the baseline, which is no fault.
    """
    if change.before.messages or change.before.enums or not base.schema.uncompiled:
        return None
    if any(file not in today.schema.uncompiled for file in today.files):
        return None
    message = "nothing was compared: none of the .proto files can be read, neither in the earlier state nor in this one"
    help = "correct the errors in the files, or give the folder from which their imports are found"
    return UnreadableState.at(Span(base.shown_root or base.name), message, help)
