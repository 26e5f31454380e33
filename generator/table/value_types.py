"""The types of values in mapping.yaml: what may stand at a place, and what it means there."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Text:
    """A string."""

    noun: str = "text"
    """What the documentation calls such a string; its first word stands for the string in paths of keys."""
    pattern: str = ""
    """A regular expression that the whole string must match."""
    example: str = ""
    choices: tuple[str, ...] = ()
    fault: Callable[[str], tuple[str, str]] | None = field(default=None, compare=False)
    """Tells why a string is not allowed although it matches, and what to write instead; both empty if it is allowed."""
    checked_by_rule: bool = False
    """True if a rule of the lint reports a string that does not match; the reader takes it."""


@dataclass(frozen=True, slots=True)
class Integer:
    """A decimal number."""

    minimum: int
    maximum: int


@dataclass(frozen=True, slots=True)
class Boolean:
    """``true`` or ``false``."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number, with or without a fraction; ``.nan`` and ``.inf`` are numbers too."""


@dataclass(frozen=True, slots=True)
class Duration:
    """A time with its unit, ``500ms`` or ``2s``; in a table it is a number of milliseconds."""

    minimum: int
    """In milliseconds, as `maximum`."""
    maximum: int

    pattern = r"([1-9][0-9]{0,9})(ms|s)"

    def read(self, text: str) -> int | None:
        """Convert a text to milliseconds; None if it is not a duration or not within the limits."""
        found = re.fullmatch(self.pattern, text)
        milliseconds = int(found[1]) * (1000 if found[2] == "s" else 1) if found else 0
        return milliseconds if self.minimum <= milliseconds <= self.maximum else None


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number, a text, ``true`` or ``false``, kept as it is written; a later phase checks it."""


@dataclass(frozen=True, slots=True)
class ListOf:
    """A list of items of one type; no text stands in it twice."""

    item: Type
    least: int = 0
    unique: bool = True


@dataclass(frozen=True, slots=True)
class MapOf:
    """A mapping from names of the user's choice to values of one type."""

    key: Text
    value: Type
    name: str = ""
    """The attribute of each value that takes its name; a table then has a tuple of the values."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """The documentation of a key."""

    text: str
    """Sentences for the JSON Schema, the reference and the diagnostic about a key that is missing."""
    default: str = ""
    """The default in words, if it depends on other keys."""
    see: str = ""
    """The page of docs/ that says more, with its section: ``lint.md#fixed-sizes``."""
    key: str = ""
    """The key's name in the file, if the attribute has another."""


@dataclass(frozen=True, slots=True)
class Key:
    """A key of an object."""

    type: Type
    meaning: Meaning
    required: bool = False
    default: Any = None
    """The value of an optional key that is absent."""
    attribute: str = ""
    """The attribute of the object's part that holds the value."""


@dataclass(frozen=True, slots=True)
class Object:
    """A mapping with known keys."""

    keys: Mapping[str, Key] = field(hash=False)
    others: MapOf | None = None
    """What any other key may be; None if there may be none."""
    part: type[Any] | None = None
    """The dataclass that it is read as (`roverlink.generator.table.parts`)."""


@dataclass(frozen=True, slots=True)
class AnyOf:
    """One of several forms, of which no two are of one kind of YAML value."""

    forms: tuple[Type, ...]


@dataclass(frozen=True, slots=True)
class Named:
    """A type with a name of its own in the JSON Schema, so that it can hold itself."""

    name: str
    definition: Callable[[], AnyOf] = field(compare=False)


Type = Text | Integer | Boolean | Number | Duration | Scalar | ListOf | MapOf | Object | AnyOf | Named
