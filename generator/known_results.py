"""Cache for results of `generate` and `lint`: a project whose files have not changed is not compiled again.

A result stays right as long as all that it was made from is the same: the table, the ledger, the .proto and .options
files, and the code that made it. Each project has one file for each command in the user's cache folder. It has the
digest of these inputs, and the result. What a command writes or checks on disk beside its inputs, such as the generated
files, is not cached.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from roverlink.generator import source_files
from roverlink.generator.content_digest import text_at
from roverlink.generator.ledger_names import LEDGER
from roverlink.user_cache import CacheFile

_READ = (".proto", ".options")
_VERSIONS = {  # the file that has the version of each package whose code or output is in a result
    "google.protobuf": "__init__.py",
    "grpc_tools": "grpc_version.py",
    "jinja2": "__init__.py",
    "yaml": "__init__.py",
    "_black_version": "",
}


class KnownResult:
    """Result that a command had for a project when it ran last.

    ``table`` is the path of the table. The result is a value that JSON can hold.
    """

    def __init__(self, table: Path, command: str) -> None:
        self._table = table.resolve()
        self._file = CacheFile(command, self._table, _version())
        body = self._file.load()
        entry = json.loads(body) if body else {"root": "", "inputs": None, "result": None}
        self._root = entry["root"] or text_at(self._table, "proto", "root")
        self._before = self._inputs(self._root) if self._root else None
        self.value: Any = entry["result"] if self._before and self._before == entry["inputs"] else None
        """The result; None if there is none, or if an input has changed since."""

    def save(self, root: str, value: Any) -> None:
        """Keep the result of a run. ``root`` is the folder of the .proto files, relative to the table.

        The result is kept if the inputs are still those from before the run.
        """
        if root == self._root and self._before is not None and self._inputs(root) == self._before:
            self._file.save(json.dumps({"root": root, "inputs": self._before, "result": value}).encode())

    def _inputs(self, root: str) -> str | None:
        """Return a digest of all files that a command reads; None if some of them cannot be read."""
        try:
            return _digest((name, source_files.read(folder, name)) for folder, name in self._read(root))
        except OSError:
            return None

    def _read(self, root: str) -> Iterator[tuple[Path, str]]:
        """Yield the files that a command reads, each as a folder and a path in it. Raises OSError for a bad folder."""

        def refuse(path: str, fault: str) -> None:
            raise OSError(f"{path}: {fault}")

        project = self._table.parent
        yield from ((project, name) for name in (self._table.name, LEDGER))
        if source_files.leads_out(project, project / root):
            refuse(root, "outside of the repository")
        names = source_files.walk(project / root, refuse)
        yield from ((project / root, name) for name in names if name.endswith(_READ))


def _digest(files: Iterator[tuple[str, bytes]]) -> str:
    checksum = hashlib.sha256()
    for name, data in files:
        # With the sizes, no two lists of files give the same bytes.
        checksum.update(b"%d %d " % (len(os.fsencode(name)), len(data)) + os.fsencode(name) + data)
    return checksum.hexdigest()


@cache
def _version() -> bytes:
    """Return a checksum of roverlink's code and templates, and of the versions of the packages that it uses."""
    checksum = hashlib.sha256(sys.version.encode())
    for package, file in _VERSIONS.items():
        if spec := find_spec(package):
            path = Path(spec.origin or "")
            checksum.update((path.parent / file if file else path).read_bytes())
    for folder, folders, names in os.walk(Path(__file__).parents[1], followlinks=True):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        for name in sorted(names):
            checksum.update(Path(folder, name).read_bytes())
    return checksum.digest()
