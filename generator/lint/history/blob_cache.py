"""Cache for the history: stores the messages, enums and numbers in each blob, so that later runs are faster.

A blob is the content of a file in git. Its id is a checksum of the content, so a cache entry stays right as long as
our parser stays the same. Each repository has one file in the user's cache folder: a checksum, then JSON. The checksum
covers the code of the parser, too. So cache files from another version of the program, and damaged files, are ignored.
The user can delete the cache files at any time.
"""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import json
import os
import sys
import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from roverlink.generator.lint.history.numbered_types import NumberedType, NumberedTypes, Pool
from roverlink.generator.protos import parser, schema
from roverlink.generator.protos.schema import Fact
from roverlink.generator.user_cache import cache_folder

_LARGEST = 64 * 2**20  # bytes of all files together; 2,000 states of 40 fields take half a megabyte


class BlobCache:
    """Cache file of one git repository: stores the messages and enums in each blob (a file's content in git)."""

    def __init__(self, repository: Path) -> None:
        # A path contains slashes, and may be longer than the name of a file may be. So its hash is the name.
        name = hashlib.sha256(os.fsencode(repository.resolve())).hexdigest()[:32]
        self._file = cache_folder() / "history" / f"{name}.json"

    def load(self, pool: Pool) -> dict[str, NumberedTypes]:
        """Return the messages and enums of each known blob, by the blob's id.

        The result is empty if the file cannot be read, or was written by another version of the program.
        """
        try:
            checksum, _, body = self._file.read_bytes().partition(b"\n")
            # The time of the file is the time of its last use, for `_remove_oldest`. The access time does not tell:
            # most systems mount with relatime, and update it once a day (mount(8)).
            os.utime(self._file)
        except OSError:
            return {}
        return dict(_decoded(body, pool)) if checksum == _checksum(body) else {}

    def save(self, known: Mapping[str, NumberedTypes]) -> None:
        """Replace the cache file. If this is not possible, the next run reads the history from git again.

        ``known`` has the messages and enums of each blob, by the blob's id.
        """
        body = _encoded(known)
        if len(body) > _LARGEST:
            return
        with contextlib.suppress(OSError):
            folder = self._file.parent
            # 0700 as the XDG Base Directory Specification asks: names in a private repository do not concern other
            # users.
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            # Two runs may save at the same time. rename(2) replaces the file in one step, so a reader finds the old
            # cache or the new one. It works in one file system only, therefore the temporary file is in the same
            # folder.
            descriptor, temporary = tempfile.mkstemp(dir=folder)
            try:
                with open(descriptor, "wb") as file:
                    file.write(_checksum(body) + b"\n" + body)
                os.replace(temporary, self._file)
            except OSError:
                os.unlink(temporary)
                raise
            _remove_oldest(folder)


def _remove_oldest(folder: Path) -> None:
    """Remove the least recently used files of the cache folder until the others have at most 64 MiB together."""
    about = {path: path.stat() for path in folder.iterdir()}
    size = 0
    for path in sorted(about, key=lambda path: about[path].st_mtime, reverse=True):
        size += about[path].st_size
        if size > _LARGEST:
            path.unlink()


def _checksum(body: bytes) -> bytes:
    return hashlib.sha256(_version() + body).hexdigest().encode()


@cache
def _version() -> bytes:
    """Return a checksum of the code whose results the cache contains: the parser, its model, and this package."""
    # The parser's `\w` and `isidentifier` depend on the Unicode tables, which come with Python.
    checksum = hashlib.sha256(sys.version.encode())
    for module in (parser, schema, sys.modules[__package__]):
        path = Path(inspect.getfile(module))
        for file in sorted(path.parent.glob("*.py")) if path.name == "__init__.py" else [path]:
            checksum.update(file.read_bytes())
    return checksum.digest()


def _encoded(known: Mapping[str, NumberedTypes]) -> bytes:
    """Return the content of the cache as JSON.

    A fact is a declared field or enum value. Each distinct fact and type is stored once, and referred to by its index.
    """
    # A commit usually changes one field of a file, so its state repeats all other facts of the state before. JSON and
    # not pickle: unpickling a file that somebody else could have written runs code of that file.
    # Each line is a JSON value, so that reading them needs little memory: the facts, the number of types, each type,
    # and each blob with its types.
    facts: dict[Fact, int] = {}
    types: dict[NumberedType, int] = {}
    blobs = [
        _json([blob, {name: types.setdefault(type, len(types)) for name, type in declared.items()}])
        for blob, declared in known.items()
    ]
    listed = [
        [
            [facts.setdefault(fact, len(facts)) for fact in declared.facts],
            declared.offsets,
            declared.line,
            declared.broken,
            declared.enum,
        ]
        for declared in types
    ]
    return b"\n".join([_json(list(facts)), *map(_json, [len(listed), *listed]), *blobs])


def _json(value: object) -> bytes:
    return json.dumps(value, separators=(",", ":")).encode()


def _decoded(body: bytes, pool: Pool) -> Iterator[tuple[str, NumberedTypes]]:
    lines = iter(body.splitlines())
    facts = [pool.fact(Fact(*fact)) for fact in json.loads(next(lines))]
    types = []
    for _ in range(json.loads(next(lines))):
        indices, offsets, *others = json.loads(next(lines))
        types.append(pool.shared(tuple(facts[index] for index in indices), tuple(offsets), *others))
    for blob, declared in map(json.loads, lines):
        yield blob, {sys.intern(name): types[index] for name, index in declared.items()}
