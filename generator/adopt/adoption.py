"""All steps of adopting a folder of .proto files: reads the files, drafts a mapping.yaml, and compiles it."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator import lock, source_files
from roverlink.generator.adopt.draft import Draft
from roverlink.generator.adopt.fitting import fit
from roverlink.generator.adopt.guesses import guess_rows
from roverlink.generator.adopt.lint_levels import lower
from roverlink.generator.adopt.proto_tree import Tree, owner, read_tree
from roverlink.generator.adopt.retired_numbers import AdoptedPast, read_past
from roverlink.generator.adopt.table_text import text_of
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span, in_order, shown
from roverlink.generator.emit import envelope_file
from roverlink.generator.emit.writer import Change
from roverlink.generator.init_rules import NothingToTakeOver
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.engine import lint
from roverlink.generator.lock import Ledger
from roverlink.generator.nanopb import read_bounds
from roverlink.generator.new_project import files_about_repository, refuse_overwriting
from roverlink.generator.pipeline import Compiled, compile_text
from roverlink.generator.protos.parser import parse
from roverlink.generator.protos.protoc import compile_protos
from roverlink.generator.resolve.resolver import resolve_envelope
from roverlink.generator.table import reader


@dataclass(frozen=True, slots=True)
class AdoptionRequest:
    """Options of `roverlink init --from`: the folder of .proto files for which a mapping.yaml is drafted.

    ``file``, ``message`` and ``oneof`` name the envelope, and the oneof of its payloads. An empty one is guessed.
    """

    root: Path
    file: str = ""
    message: str = ""
    oneof: str = ""
    package: str = "comms"
    """Name of the ROS 2 package to generate."""
    source: str = ""
    """Argument of ``pip install`` in the GitHub workflow; empty if the user has to fill it in."""


@dataclass(frozen=True, slots=True)
class Adoption:
    """Result of an adoption: the draft of mapping.yaml, its generated files, and the diagnostics of the lint."""

    draft: Draft
    past: AdoptedPast
    compiled: Compiled
    findings: tuple[Diagnostic, ...]
    """Diagnostics of the lint that remain after the drafted table has lowered the severity of some rules."""
    changes: tuple[Change, ...]
    """Files to write, including the table."""
    kept: tuple[str, ...]
    """Paths of files that exist already and are not overwritten."""
    scalars: tuple[str, ...]
    """Names of the oneof's members that are scalars. They get no row, because only messages can have rows."""


def adopt(table_path: Path, wanted: AdoptionRequest, report: Callable[[int, int], None] | None = None) -> Adoption:
    """Draft a mapping.yaml for a folder of .proto files, and compile it. Nothing is written to disk.

    ``report`` shows progress: it is called with the number of file versions read from git's history so far, and their
    total. Raises `DiagnosticsError` with all mistakes if the draft cannot be compiled.
    """
    project, root = table_path.resolve().parent, wanted.root.resolve()
    if source_files.leads_out(project, root):
        message = "the folder is outside the git repository"
        help = "move the .proto files into the repository, or add their repository as a submodule"
        raise DiagnosticsError([NothingToTakeOver.at(Span(str(wanted.root)), message, help)])
    shown_root = Path(os.path.relpath(root, project)).as_posix()
    foreign = _foreign(project, root)
    tree = read_tree(root, shown_root, wanted.file, wanted.message, wanted.oneof, foreign)
    peers, rows = guess_rows(tree)
    past = read_past(root, tree, rows, report)
    owned, why = owner(tree, [row.number for row in past.retired], [row.name for row in past.retired], foreign)
    draft = Draft(
        root=shown_root,
        package=wanted.package,
        file=tree.envelope.file,
        message=tree.envelope.full_name,
        oneof=tree.oneof,
        oneof_doubt=tree.doubt,
        owner=owned,
        owner_reason=why,
        exclude=dict(tree.exclude),
        peers=peers,
        rows=rows,
        retired=past.retired,
    )
    fit(draft, tree.schema, table_path.name)
    findings: list[Diagnostic] = []
    context = _context(draft, tree, table_path.name, findings)
    # Two rounds of lint: the first one tells which rules the tree breaks, and these are lowered in the draft. The
    # second one (below) gives the diagnostics with those severities, as the user will see them.
    lower(draft, lint(context), context.schema or tree.schema)
    text = text_of(draft)
    published, moved = _taken_over(project, root, shown_root)
    accepted = published.burned_in(draft.message)
    past = dataclasses.replace(past, reused=[number for number in past.reused if number not in accepted])
    about = files_about_repository(project, wanted.source)
    compiled, changes = compile_text(table_path, text, published, about.texts)
    changes += moved
    envelope = shown(shown_root, tree.envelope.file)  # the table has all its content, so it may be replaced
    changes = [dataclasses.replace(change, foreign=False) if change.path == envelope else change for change in changes]
    refuse_overwriting(changes)
    findings += lint(dataclasses.replace(context, table=reader.parse(text, table_path.name, [])))
    found = tuple(in_order([*findings, *compiled.warnings]))
    return Adoption(draft, past, compiled, found, tuple(changes), about.kept, tuple(tree.scalars))


def _context(draft: Draft, tree: Tree, table_file: str, findings: list[Diagnostic]) -> Context:
    """Return the input of the lint rules for the draft: the drafted table, and the declarations of the .proto files.

    If `roverlink generate` will write the envelope's file, the lint sees the text that will be written, and not the
    present content of the file. Nothing is written here. ``findings`` collects the mistakes in nanopb's options.
    """
    table = reader.parse(text_of(draft), table_file, [])
    schema, files = tree.schema, {file: parsed for file, parsed in tree.files.items() if file not in tree.exclude}
    if draft.owner == "mapping":
        places = {row.proto: schema.messages[row.proto].file for row in table.rows}
        text = envelope_file.text(resolve_envelope(table, places, Ledger()), table.file)
        files[draft.file] = parse(text)
        schema = compile_protos(tree.root, list(files), {draft.file: text}, draft.root).schema
    return Context(
        table=table,
        schema=schema,
        ledger=Ledger(),
        files=files,
        excluded_files={file: tree.files[file] for file in tree.exclude},
        bounds=read_bounds(schema, tree.root, draft.root, findings),
    )


def _taken_over(project: Path, root: Path, shown_root: str) -> tuple[Ledger, list[Change]]:
    """Return the ledger with which the project starts, and the change that removes the ledger of the folder.

    Numbers whose past the user accepted before there was a table are in the folder's own ledger. They move into the
    project's ledger; the drafted table lowers the rules in it. A folder that the project must not write to keeps its
    own. Raises `DiagnosticsError` if a ledger is damaged.
    """
    findings: list[Diagnostic] = []
    known = lock.read(project / lock.NAME, findings)
    path = shown(shown_root, lock.ACCEPTED_NAME)
    accepted = lock.read(root / lock.ACCEPTED_NAME, findings, path)
    if findings:
        raise DiagnosticsError(findings)
    if not (accepted.burned or accepted.settled):
        return known, []
    text = source_files.read_text(root, lock.ACCEPTED_NAME)
    return known.with_burned(accepted.burned), [] if _foreign(project, root) else [Change(path, text, None)]


def _foreign(project: Path, root: Path) -> str:
    """Return the reason why this project must not write to ``root``, the folder of .proto files; empty if it may."""
    if not root.is_relative_to(project):
        return "its folder is outside this project"
    # A submodule or a nested clone: generate would change files that another repository tracks. A submodule has a file
    # `.git`, a clone a folder (gitrepository-layout(5)).
    inner = next((folder for folder in (root, *root.parents) if folder != project and (folder / ".git").exists()), None)
    return "its folder is another git repository" if inner and inner.is_relative_to(project) else ""
