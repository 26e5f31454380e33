"""Help for imports that protoc does not find below the folder of an adoption: where the file is, and what to do.

A table has one folder of .proto files, from which all imports start. The imports of another team may start elsewhere:
at a folder beside it, or at the path under which their build system has the repository.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path, PurePosixPath

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.protos.files import proto_files
from roverlink.generator.protos.protoc import BROKEN_IMPORT


def with_help(findings: Iterable[Diagnostic], root: Path, shown_root: str) -> Iterator[Diagnostic]:
    """Yield protoc's diagnostics; those about a missing import with a help. ``shown_root`` is the name of ``root``."""
    top = Path(source_files.repository_top(str(root)) or root)
    files = cache(lambda: proto_files(top, "", []))  # a look at a whole repository, which most trees do not need
    for finding in findings:
        if match := BROKEN_IMPORT.fullmatch(finding.message):
            finding = replace(finding, help=_help(match["file"], top, files(), root, shown_root))
        yield finding


def _help(imported: str, top: Path, files: Collection[str], root: Path, shown_root: str) -> str:
    """Return what to do about an import. ``files`` are the .proto files of the repository, relative to ``top``."""
    whole = (file for file in files if f"/{file}".endswith(f"/{imported}"))
    if file := min(whole, key=len, default=None):
        start = top / file.removesuffix(imported)
        folder = os.path.relpath(start, root)
        shown_folder = os.path.normpath(os.path.join(shown_root, folder))
        if root.is_relative_to(start):
            return f"its path starts at {shown_folder!r}: run `roverlink init --from {shown_folder}`"
        first = imported.partition("/")[0]
        return (
            f"it is in {shown_folder!r}, and a table has one folder of .proto files: copy it, or link it with "
            f"`ln -s {os.path.join(folder, first)} {os.path.join(shown_root, first)}`, and run this again"
        )
    parts = PurePosixPath(imported).parts
    for length in range(1, len(parts)):
        if "/".join(parts[length:]) in files:
            prefix = "/".join(parts[:length])
            return (
                f"the path {prefix!r} of the import stands for the top folder of this repository: in a project of your "
                f"own, run `git submodule add REPOSITORY proto/{prefix}` and `roverlink init --from proto`"
            )
    return (
        "no file of this repository has this path: copy it to "
        f"{os.path.join(shown_root, imported)}, or add its repository as a submodule in {shown_root}"
    )
