"""Diagnosis of a wrong proto root: the imports of the .proto files start at another folder than the given one.

protoc looks for every import below the proto root. From a folder above or below the right one it finds none of them,
and would print an error for each.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir.protobuf_facts import OWN_FILES
from roverlink.generator.lint.input_rules import WrongProtoRoot
from roverlink.generator.protos.parser import File

_MOST_NAMED = 3  # a repository can have more roots than one line has room for


class _Import(NamedTuple):
    file: str
    imported: str


def wrong_root(root: Path, files: Mapping[str, File], shown_root: str, span: Span) -> Diagnostic | None:
    """Return the diagnostic for a proto root from which most imports are not found, but from other folders.

    ``files`` are the .proto files below ``root``. The result is None if the root may be right. ``shown_root`` is the
    root's path for the message, and ``span`` the place that names the root.
    """
    imports = [
        _Import(name, imported)
        for name, file in files.items()
        for imported in file.imported
        if not imported.startswith(OWN_FILES)
    ]
    missing = [imported for imported in imports if not _exists(root, imported.imported, files)]
    if len(missing) * 2 <= len(imports):
        return None
    roots: list[str] = []
    found, left = 0, missing
    while left and len(roots) < _MOST_NAMED and (best := _best_root(root, files, left)):
        before, left = len(left), [imported for imported in left if best not in _roots_of(root, files, imported)]
        roots.append(os.path.normpath(os.path.join(shown_root, best)))
        found += before - len(left)
    if found * 2 <= len(imports):
        return None
    first = next(imported for imported in missing if imported not in left)
    named = " and ".join(map(repr, roots))
    message = (
        f"{len(missing)} of {len(imports)} imports, such as {first.imported!r} in {first.file!r}, are not found from "
        f"here; they start at {named}"
    )
    return WrongProtoRoot.at(span, message, f"give the folder {named} as the proto root")


def _best_root(root: Path, files: Mapping[str, File], imports: Iterable[_Import]) -> str:
    """Return the folder from which most of the imports are found; empty if there is none."""
    counted = Counter(folder for imported in imports for folder in _roots_of(root, files, imported))
    return max(counted, key=lambda folder: (counted[folder], -len(folder)), default="")


def _roots_of(root: Path, files: Mapping[str, File], imported: _Import) -> set[str]:
    """Return the folders above or below the root from which an import is found, as paths relative to the root."""
    return {*_below(files, imported), *_above(root, imported)}


def _below(files: Mapping[str, File], imported: _Import) -> Iterator[str]:
    # The importing file is below the right root, too.
    for folder in PurePosixPath(imported.file).parents:
        if folder.parts and str(folder / imported.imported) in files:
            yield str(folder)


def _above(root: Path, imported: _Import) -> Iterator[str]:
    path = PurePosixPath(imported.imported)
    if path.is_absolute() or ".." in path.parts:
        return
    for steps, folder in enumerate(root.parents, 1):
        if source_files.leads_out(root, folder):
            return
        if (folder / path).is_file():
            yield "/".join([".."] * steps)


def _exists(root: Path, imported: str, files: Mapping[str, File]) -> bool:
    return imported in files or (root / imported).is_file()
