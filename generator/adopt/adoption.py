"""The whole of taking over: read, guess, write as text, try, correct, until it compiles."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from generator.adopt.cures import cure
from generator.adopt.draft import Draft
from generator.adopt.faults import IN_THE_WAY
from generator.adopt.guesses import guess_rows
from generator.adopt.past import AdoptedPast, read_past
from generator.adopt.text import text_of
from generator.adopt.tree import Tree, owner, read_tree
from generator.adopt.trial import Trial, tried
from generator.diagnostics import Diagnostic, DiagnosticsError, Span
from generator.pipeline import Compiled
from generator.write import Change, compare

_MOST_ATTEMPTS = 20
_OURS = "Regenerate with: roverlink generate"


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is to be taken over; what is empty is to be found out."""

    root: Path
    file: str = ""
    message: str = ""
    oneof: str = ""
    package: str = "comms"


@dataclass(frozen=True, slots=True)
class Adoption:
    """A tree that was taken over."""

    draft: Draft
    past: AdoptedPast
    compiled: Compiled
    findings: tuple[Diagnostic, ...]
    """What the lint finds in it, counted for as little as the table says."""
    changes: tuple[Change, ...]
    """What is to be written, the table among it."""
    scalars: tuple[str, ...]
    """Members of the oneof that are no messages, and so have no row."""


def adopt(table_path: Path, wanted: Wanted, report: Callable[[int, int], None] | None = None) -> Adoption:
    """Take over a tree of .proto files. Nothing is written.

    Raises `DiagnosticsError` with everything that is in the way, and that a table cannot mend.
    """
    project, root = table_path.resolve().parent, wanted.root.resolve()
    shown_root = Path(os.path.relpath(root, project)).as_posix()
    tree = read_tree(root, shown_root, wanted.file, wanted.message, wanted.oneof)
    peers, rows = guess_rows(tree)
    past = read_past(root, tree, rows, report)
    owned, why = owner(
        tree, [one.number for one in past.retired], [one.name for one in past.retired], _foreign(project, root)
    )
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
    text, trial = _corrected(draft, tree, project, table_path.name)
    files = {**trial.compiled.files, table_path.name: text}
    changes = compare(project, files, trial.compiled.folders)
    _check_the_way(changes, f"{shown_root}/{tree.envelope.file}")
    return Adoption(draft, past, trial.compiled, trial.findings, tuple(changes), tuple(tree.scalars))


def _foreign(project: Path, root: Path) -> str:
    """Why the folder of the protos is not this project's to write to; empty where it is."""
    if not root.is_relative_to(project):
        return "its folder is not in this project's"
    inner = next((one for one in (root, *root.parents) if one != project and (one / ".git").exists()), None)
    return "its folder is a repository of its own" if inner and inner.is_relative_to(project) else ""


def _corrected(draft: Draft, tree: Tree, project: Path, table: str) -> tuple[str, Trial]:
    """The text of the table that compiles, and what it compiles to."""
    with tempfile.TemporaryDirectory(prefix="roverlink-") as folder:
        for _ in range(_MOST_ATTEMPTS):
            text = text_of(draft)
            try:
                trial = tried(text, table, tree.root, project, Path(folder))
            except DiagnosticsError as error:
                if not cure(draft, tree, text, table, error.findings):
                    raise
            else:
                if not cure(draft, tree, text, table, trial.findings):
                    return text, trial
    raise AssertionError("each cure takes away one of finitely many findings")


def _check_the_way(changes: list[Change], envelope: str) -> None:
    """Refuse to overwrite what somebody else wrote. Raises `DiagnosticsError`."""
    theirs = [
        change.path
        for change in changes
        if change.before is not None and change.path != envelope and _OURS not in change.before
    ]
    if theirs:
        raise DiagnosticsError(
            [IN_THE_WAY.at(Span(path), "is there already, and was not generated", "move it away") for path in theirs]
        )
