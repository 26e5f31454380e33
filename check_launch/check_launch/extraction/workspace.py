"""Facts about the packages of a workspace, from their sources. They come before those of the catalogue.

Reading C++ takes time. So the facts of each package are kept, in the user's cache or in a file, until one of the
package's files changes.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from check_launch.catalogue.facts import WORKSPACE_SOURCE, Catalogue, Source
from check_launch.expansion.launch_context import Packages
from check_launch.expansion.source_trees import source_folders
from check_launch.extraction.assembling import Assembler, Checkout
from check_launch.extraction.git_sources import SUFFIXES
from check_launch.extraction.package_facts import PackageFacts, read_packages
from check_launch.extraction.supplement import read_supplement
from roverlink import bounded_files
from roverlink.runtime.atomic_files import write_whole
from roverlink.user_cache import CacheFile


def with_workspace(catalogue: Catalogue, packages: Packages, file: Path | None = None) -> Catalogue:
    """Return a catalogue that has also the packages of source trees.

    What a package has of which there are several versions is not known. ``file`` keeps the facts; without it, the
    user's cache does. Raises `SetupError` if the file cannot be written.
    """
    if not (folders := packages.folders):
        return catalogue
    kept = _KeptFacts(Path(os.path.commonpath(list(folders.values()))), file)
    checkout = Checkout(WORKSPACE_SOURCE, Path(), Source(WORKSPACE_SOURCE, "", ""), folders, is_supplemented=False)
    own = Assembler([checkout], read_supplement(), kept.read).catalogue(catalogue.distribution, {})
    kept.save()
    several = {
        name: replace(package, executables={}, components={}, is_partial=True)
        for name, package in own.packages.items()
        if len(packages.copies[name]) > 1
    }
    # A container looks for the nodes of a package in one workspace after the other, unlike `ros2 run` for its programs.
    beneath = {
        name: replace(package, components=catalogue.packages[name].components)
        for name, package in own.packages.items()
        if name in catalogue.packages and not package.components
    }
    owners = {plugin.class_name: plugin.package for plugin in own.plugins.values()}
    for name, package in own.packages.items():
        owners |= dict.fromkeys((*package.executables.values(), *package.components.values()), name)
    return replace(
        catalogue,
        sources={**catalogue.sources, **own.sources},
        packages={**catalogue.packages, **own.packages, **beneath, **several},
        # Not the classes that the supplement names, and that this workspace does not have.
        classes={
            **catalogue.classes,
            **{
                name: replace(facts, is_partial=facts.is_partial or owners[name] in several)
                for name, facts in own.classes.items()
                if name in owners
            },
        },
        plugins={**catalogue.plugins, **own.plugins},
    )


class _KeptFacts:
    """Facts of packages that were read before, with the states of their files."""

    def __init__(self, top: Path, file: Path | None) -> None:
        self._file, self._cache = file, CacheFile("check-launch", top, _version())
        self._before: dict[str, Any] = {}
        self._now: dict[str, Any] = {}
        try:
            data = bounded_files.read(file, 64 << 20) if file else self._cache.load()
            found = json.loads(data or b"{}")
            self._before = found["packages"] if found.get("version") == _version().hex() else {}
        except (OSError, ValueError, AttributeError, KeyError):  # not there yet, or not ours: it is written again
            self._before = {}

    def read(self, folders: Sequence[Path]) -> dict[Path, PackageFacts]:
        """Return the facts of the packages in folders."""
        states = {folder: _state(folder) for folder in folders}
        before = {folder: self._before.get(str(folder)) for folder in folders}
        kept = {folder: one for folder, one in before.items() if one and one["state"] == states[folder]}
        found = read_packages([folder for folder in folders if folder not in kept])
        now = {folder: {"state": states[folder], "facts": facts.stored()} for folder, facts in found.items()}
        self._now = {str(folder): one for folder, one in {**kept, **now}.items()}
        return {**found, **{folder: PackageFacts.from_stored(one["facts"]) for folder, one in kept.items()}}

    def save(self) -> None:
        """Keep the facts, if they have changed."""
        if self._now == self._before:
            return
        data = json.dumps({"version": _version().hex(), "packages": self._now}).encode()
        if self._file:
            write_whole(self._file, data)
        else:
            self._cache.save(data)


def _state(folder: Path) -> str:
    """Return a checksum of the names, sizes and times of the files of a package that the extraction reads."""
    found = hashlib.sha256()
    for inner, _, names in source_folders(folder):
        for name in names:
            path = inner / name
            if path.suffix in SUFFIXES and path.is_file():
                about = path.stat()
                found.update(f"{path}\0{about.st_size}\0{about.st_mtime_ns}\n".encode(errors="surrogateescape"))
    return found.hexdigest()


def _version() -> bytes:
    """Return a checksum of the code that extracts the facts: another version of it may find others."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).digest()
