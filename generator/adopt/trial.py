"""A draft tried in a copy of the tree: compiled, written there, and linted."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass
from pathlib import Path

from generator.diagnostics import Diagnostic
from generator.linting import Question, lint_project
from generator.pipeline import Compiled, compile_table
from generator.write import compare, write


@dataclass(frozen=True, slots=True)
class Trial:
    """What a table compiles to, and what the lint then finds."""

    compiled: Compiled
    findings: tuple[Diagnostic, ...]


def tried(text: str, table: str, root: Path, project: Path, folder: Path) -> Trial:
    """Try the text of a table on a copy of the tree, below a folder. Raises `DiagnosticsError` as `compile_table`."""
    top = Path(os.path.commonpath([root, project]))
    inside = folder / "copy"
    shutil.rmtree(inside, ignore_errors=True)
    here = inside / project.relative_to(top)
    here.mkdir(parents=True)
    _copy_protos(root, inside / root.relative_to(top))
    (here / table).write_text(text, encoding="utf-8")
    compiled = compile_table(here / table)
    write(here, compare(here, compiled.files, compiled.folders))
    return Trial(compiled, lint_project(here / table, Question()).findings)


def _copy_protos(root: Path, target: Path) -> None:
    """Copy what the generator and the lint read of a tree: .proto files, and nanopb's options beside them."""
    for path, _, files in os.walk(root, followlinks=True):
        for name in files:
            if name.endswith((".proto", ".options")):
                copy = target / Path(path).relative_to(root) / name
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(Path(path) / name, copy)
    target.mkdir(parents=True, exist_ok=True)
