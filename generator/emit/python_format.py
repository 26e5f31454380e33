"""Formatting of generated Python with black, restricted to texts that have changed.

black takes longer than the rest of a run. Its results are therefore kept between runs in the user's cache folder, by
the checksum of the unformatted text and black's version. The cache can be deleted at any time; if it is missing,
damaged or read-only, all texts are formatted again.
"""

from __future__ import annotations

import contextlib
import hashlib
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from multiprocessing import get_context

from roverlink.generator.user_cache import cache_folder

_LARGEST = 256 * 2**20  # bytes of the cache; a table of 1,000 rows takes 10 MB
_LEAST_FOR_PROCESSES = 300  # texts; a new process takes as long to start as to format fifty
_TEXTS_PER_TASK = 20  # texts that a process gets at once
_NO_CACHE = (OSError, sqlite3.Error)


def format_python(texts: Mapping[str, str]) -> dict[str, str]:
    """Return the modules by path, formatted by black with its default of 88 columns."""
    salt = version("black").encode()
    keys = {path: hashlib.sha256(salt + text.encode()).hexdigest() for path, text in texts.items()}
    with contextlib.ExitStack() as stack:
        cache = None
        with contextlib.suppress(*_NO_CACHE):
            cache = stack.enter_context(_open_cache())
        known = _load(cache, keys.values())
        missing = {keys[path]: text for path, text in texts.items() if keys[path] not in known}
        made = _format_all(missing)
        _save(cache, made)
    known |= made
    return {path: known[key] for path, key in keys.items()}


def _format_all(texts: Mapping[str, str]) -> dict[str, str]:
    if len(texts) < _LEAST_FOR_PROCESSES:
        return {key: _format(text) for key, text in texts.items()}
    longest_first = sorted(texts, key=lambda key: len(texts[key]), reverse=True)  # so that all processes end together
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as workers:
        made = workers.map(_format, [texts[key] for key in longest_first], chunksize=_TEXTS_PER_TASK)
        return dict(zip(longest_first, made))


def _format(text: str) -> str:
    import black  # here, because its import takes 0.1 s and most runs format nothing
    from black.mode import TargetVersion

    return black.format_str(text, mode=black.Mode(target_versions={TargetVersion.PY310}))


# --- the cache --------------------------------------------------------------------------------------------------


@contextlib.contextmanager
def _open_cache() -> Iterator[sqlite3.Connection]:
    path = cache_folder() / "black.sqlite"
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    if path.exists() and path.stat().st_size > _LARGEST:
        path.unlink()
    with contextlib.closing(sqlite3.connect(path)) as connection:
        try:
            connection.execute("PRAGMA synchronous = OFF")  # faster; a cache damaged by a power cut is deleted below
            connection.execute("CREATE TABLE IF NOT EXISTS formatted (key TEXT PRIMARY KEY, text TEXT) WITHOUT ROWID")
        except sqlite3.OperationalError:  # read-only, or locked by a slow process
            raise
        except sqlite3.DatabaseError:
            path.unlink()
            raise
        yield connection


def _load(cache: sqlite3.Connection | None, keys: Iterable[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    if cache is not None:
        with contextlib.suppress(*_NO_CACHE):
            for key in keys:
                found.update(cache.execute("SELECT key, text FROM formatted WHERE key = ?", (key,)))
    return found


def _save(cache: sqlite3.Connection | None, made: Mapping[str, str]) -> None:
    if cache is not None and made:
        with contextlib.suppress(*_NO_CACHE), cache:
            cache.executemany("INSERT OR REPLACE INTO formatted VALUES (?, ?)", made.items())
