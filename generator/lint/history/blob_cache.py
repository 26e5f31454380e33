"""Cache for the history: stores the messages, enums and numbers in each blob, so that later runs are faster.

A blob is the content of a file in git. Its id is a checksum of the content, so a cache entry stays right as long as
our parser stays the same. Each repository has one file of JSON in the user's cache folder (see `user_cache`).
"""

from __future__ import annotations

import hashlib
import inspect
import json
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from roverlink.generator.lint.history.numbered_types import NumberedType, NumberedTypes, Pool
from roverlink.generator.protos import parser, schema
from roverlink.generator.protos.schema import Fact
from roverlink.user_cache import CacheFile


class BlobCache:
    """Cache file of one git repository: stores the messages and enums in each blob (a file's content in git)."""

    def __init__(self, repository: Path) -> None:
        # 2,000 states of 40 fields take half a megabyte.
        self._file = CacheFile("history", repository, _version())

    def load(self, pool: Pool) -> dict[str, NumberedTypes]:
        """Return the messages and enums of each known blob, by the blob's id."""
        body = self._file.load()
        return {} if body is None else dict(_decoded(body, pool))

    def save(self, known: Mapping[str, NumberedTypes]) -> None:
        """Replace the cache file. ``known`` has the messages and enums of each blob, by the blob's id."""
        self._file.save(_encoded(known))


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
        types.append(pool.shared(tuple(map(facts.__getitem__, indices)), tuple(offsets), *others))
    for blob, declared in map(json.loads, lines):
        yield blob, {sys.intern(name): types[index] for name, index in declared.items()}
