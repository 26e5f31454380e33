"""Keys of mapping.yaml as text, for the reference in docs/mapping.md and for `roverlink explain`."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.table.edit import scalar
from roverlink.generator.table.parts import Part
from roverlink.generator.table.value_types import (
    AnyOf,
    Boolean,
    DataRate,
    Duration,
    Integer,
    Key,
    ListOf,
    MapOf,
    Named,
    Number,
    Object,
    Scalar,
    Text,
    Type,
)


def keys_below(type: Type, path: str = "") -> Iterator[tuple[str, Key]]:
    """Yield all keys inside a value of a type, each after the key that contains it, with paths: ``messages[].topic``.

    ``path`` is the path of the value itself.
    """
    if isinstance(type, Object):
        for name, key in type.keys.items():
            below = f"{path}.{name}" if path else name
            yield below, key
            yield from keys_below(key.type, below)
    elif isinstance(type, AnyOf):
        for form in type.forms:
            yield from keys_below(form, path)
    elif isinstance(type, ListOf):
        yield from keys_below(type.item, f"{path}[]")
    elif isinstance(type, MapOf):
        yield from keys_below(type.value, f"{path}.<{type.key.noun.split()[0]}>")


def default_of(key: Key) -> str:
    """Return the value that a missing key has, in a few words."""
    if key.required:
        return "required"
    if key.meaning.default:
        return key.meaning.default
    if key.default is None or key.default in ((), {}) or isinstance(key.default, Part):
        return "none"
    if isinstance(key.type, Duration):
        return f"`{_duration(key.default)}`"
    if isinstance(key.default, tuple):
        return f"`[{', '.join(key.default)}]`"
    return f"`{str(key.default).lower()}`" if isinstance(key.default, (bool, str)) else str(key.default)


def _duration(milliseconds: int) -> str:
    return f"{milliseconds}ms" if milliseconds % 1000 else f"{milliseconds // 1000}s"


def holds(type: Type) -> str:
    """Return what may stand at a key, in a few words."""
    if isinstance(type, Named):
        return holds(type.definition())
    if isinstance(type, Text):
        return _alternatives([f"`{scalar(choice)}`" for choice in type.choices]) if type.choices else type.noun
    if isinstance(type, Integer):
        return f"{type.minimum} to {type.maximum}" if type.minimum < type.maximum else str(type.minimum)
    if isinstance(type, Duration):
        return f"time, `{_duration(type.minimum)}` to `{_duration(type.maximum)}`"
    if isinstance(type, DataRate):
        return f"rate of data, `{type.minimum // 1000} kB/s` to `{type.maximum // 1_000_000} MB/s`"
    if isinstance(type, AnyOf):
        return _alternatives([holds(form) for form in type.forms])
    if isinstance(type, ListOf):
        return f"list of {_plural(type.item)}"
    if isinstance(type, MapOf):
        values = "" if isinstance(type.value, (Object, Named)) else f" to {holds(type.value)}"
        return f"mapping of {type.key.noun}s{values}"
    names: dict[object, str] = {Boolean: "`true` or `false`", Number: "number", Scalar: "value", Object: "mapping"}
    return names[type.__class__]


def _plural(type: Type) -> str:
    if isinstance(type, AnyOf):
        return _alternatives([_plural(form) for form in type.forms])
    found = holds(type)
    return f"{found}es" if found.endswith("s") else f"{found}s"


def _alternatives(words: list[str]) -> str:
    *others, last = dict.fromkeys(words)
    return f"{', '.join(others)} or {last}" if others else last
