"""Formatting of generated Python in the style of black, with lines of at most 88 columns.

The templates print every line that fits into 88 columns as black would print it;
tests/generator/test_generated_python.py checks this. black itself gets only modules with a line that black might have
to break, because black takes 0.1 ms for each line of a module: 17 s for a table of 1,000 rows.

The results of black are kept between runs in the user's cache folder, by the checksum of the unformatted text and
black's version. The cache can be deleted at any time; if it is missing, damaged or read-only, all texts are formatted
again.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import version

from roverlink.user_cache import cache_folder

LINE_LENGTH = 88
"""Largest number of columns in a line of generated Python. This is black's default."""
_NEVER_BROKEN = (b"#", b'"""')  # lines of a comment, and first lines of a docstring
_LARGEST = 256 * 2**20  # bytes of the cache
_NO_CACHE = (OSError, sqlite3.Error)


def literal(value: object) -> str:
    r"""Return a value as a Python literal, as `repr` does, but with double quotes where black uses them.

    >>> literal(("a", b"b", 'say "stop"'))
    '("a", b"b", \'say "stop"\')'
    """
    if isinstance(value, tuple):
        inside = ", ".join(map(literal, value))
        return f"({inside},)" if len(value) == 1 else f"({inside})"
    text = repr(value)
    if not isinstance(value, (str, bytes)) or text.endswith('"'):
        return text
    prefix, _, inside = text[:-1].partition("'")
    double = inside.replace("\\'", "'").replace('"', '\\"')
    return f'{prefix}"{double}"' if double.count("\\") <= inside.count("\\") else text


def fitted(statement: str) -> str:
    """Break a statement at its parentheses, as black does, if it is too long for a line.

    A class statement is also broken at the square brackets of its base class. A line that is still too long is left to
    `format_python`.
    """
    return "".join(f"{line}\n" for line in _broken(statement.rstrip("\n"), "(", ")"))


def _broken(line: str, open: str, close: str) -> list[str]:
    if len(line) <= LINE_LENGTH or open not in line:
        return [line]
    margin = " " * (len(line) - len(line.lstrip(" ")))
    head, _, rest = line.partition(open)
    inside, _, tail = rest.rpartition(close)
    comma = "," if head.startswith(f"{margin}def ") and "," not in inside else ""
    return [f"{head}{open}", *_broken(f"{margin}    {inside}{comma}", "[", "]"), f"{margin}{close}{tail}"]


def format_python(texts: Mapping[str, str]) -> dict[str, str]:
    """Return the text of each module, by its path, in the style of black.

    Only modules with a too long line are formatted by black itself. The templates give the others this style already.
    """
    long = {path: text for path, text in texts.items() if _has_long_line(text)}
    return {**texts, **(_formatted(long) if long else {})}


def _has_long_line(text: str) -> bool:
    """Return True if black might break a line of a module.

    Bytes of UTF-8 are counted, because a character takes at least as many bytes as columns.
    """
    lines = text.encode().splitlines()
    return any(len(line) > LINE_LENGTH and not line.lstrip().startswith(_NEVER_BROKEN) for line in lines)


def _formatted(texts: Mapping[str, str]) -> dict[str, str]:
    salt = _version_of_black()
    keys = {path: hashlib.sha256(salt + text.encode()).hexdigest() for path, text in texts.items()}
    with contextlib.ExitStack() as stack:
        cache = None
        with contextlib.suppress(*_NO_CACHE):
            cache = stack.enter_context(_open_cache())
        known = _load(cache, keys.values())
        made = {keys[path]: _format(text) for path, text in texts.items() if keys[path] not in known}
        _save(cache, made)
    known |= made
    return {path: known[key] for path, key in keys.items()}


@functools.cache
def _version_of_black() -> bytes:
    return version("black").encode()  # parses black's changelog, too, which is in its metadata: 10 ms


def _format(text: str) -> str:
    import black  # here, because its import takes 0.1 s and most runs format nothing
    from black.mode import TargetVersion

    return black.format_str(text, mode=black.Mode(line_length=LINE_LENGTH, target_versions={TargetVersion.PY310}))


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
