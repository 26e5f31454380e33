"""Types of values in mapping.yaml, with the documentation of keys."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Text:
    """String."""

    noun: str = "text"
    """Noun for such a string in the documentation; its first word stands for the string in paths of keys."""
    pattern: str = ""
    """Regular expression that the whole string must match."""
    example: str = ""
    choices: tuple[str, ...] = ()
    fault: Callable[[str], tuple[str, str]] | None = field(default=None, compare=False)
    """Function that returns the reason why a matching string is not allowed, and the help; both empty if it is allowed.
    """
    checked_by_rule: bool = False
    """True if a rule of the lint, not the reader, reports a string that does not match."""


@dataclass(frozen=True, slots=True)
class Integer:
    """Decimal integer."""

    minimum: int
    maximum: int


@dataclass(frozen=True, slots=True)
class Boolean:
    """``true`` or ``false``."""


@dataclass(frozen=True, slots=True)
class Number:
    """Number, with or without a fraction; ``.nan`` and ``.inf`` are numbers too."""


@dataclass(frozen=True, slots=True)
class Duration:
    """Duration with its unit, ``500ms`` or ``2s``; in a table it is a number of milliseconds."""

    minimum: int
    """Shortest duration in milliseconds, as `maximum` is the longest."""
    maximum: int

    pattern = r"([1-9][0-9]{0,9})(ms|s)"

    def read(self, text: str) -> int | None:
        """Convert a text to milliseconds; None if it is not a duration, or is out of range."""
        found = re.fullmatch(self.pattern, text)
        milliseconds = int(found[1]) * (1000 if found[2] == "s" else 1) if found else 0
        return milliseconds if self.minimum <= milliseconds <= self.maximum else None


@dataclass(frozen=True, slots=True)
class Scalar:
    """Number, text, ``true`` or ``false``, kept as it is written; a later phase checks it."""


@dataclass(frozen=True, slots=True)
class ListOf:
    """List of items of one type; with `unique`, no text may appear twice."""

    item: Type
    least: int = 0
    unique: bool = True


@dataclass(frozen=True, slots=True)
class MapOf:
    """Mapping from names that the user chooses to values of one type."""

    key: Text
    value: Type
    name: str = ""
    """Attribute of each value that takes its name; the table then has a tuple of the values."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """Documentation of a key."""

    text: str
    """Sentences for the JSON Schema, the reference and the diagnostic about a missing key."""
    default: str = ""
    """Default in words, if it depends on other keys."""
    see: str = ""
    """Page of docs/ with more about the key, and its section: ``lint.md#fixed-sizes``."""
    key: str = ""
    """Name of the key in the file, if it differs from the attribute's."""


@dataclass(frozen=True, slots=True)
class Key:
    """Key of an object."""

    type: Type
    meaning: Meaning
    required: bool = False
    default: Any = None
    """Value of an optional key that is missing."""
    attribute: str = ""
    """Attribute of the object's part that holds the value."""


@dataclass(frozen=True, slots=True)
class Object:
    """Mapping with known keys."""

    keys: Mapping[str, Key] = field(hash=False)
    others: MapOf | None = None
    """Type of all other keys; None if other keys are not allowed."""
    part: type[Any] | None = None
    """Dataclass for the value (`roverlink.generator.table.parts`)."""


@dataclass(frozen=True, slots=True)
class AnyOf:
    """One of several types, all of different YAML kinds."""

    forms: tuple[Type, ...]


@dataclass(frozen=True, slots=True)
class Named:
    """Type with a name in the JSON Schema, so that it can contain itself."""

    name: str
    definition: Callable[[], AnyOf] = field(compare=False)


Type = Text | Integer | Boolean | Number | Duration | Scalar | ListOf | MapOf | Object | AnyOf | Named
