"""Types of the values in mapping.yaml, and the documentation of its keys."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Text:
    """Type of a string."""

    noun: str = "text"
    """Noun for such a string in the documentation.

    In paths of keys, the first word of the noun stands for the string.
    """
    pattern: str = ""
    """Regular expression that the whole string must match."""
    example: str = ""
    choices: tuple[str, ...] = ()
    fault: Callable[[str], tuple[str, str]] | None = field(default=None, compare=False)
    """Function that checks a string after the pattern. It returns why the string is not allowed, and a help text.

    Both texts are empty if the string is allowed.
    """
    checked_by_rule: bool = False
    """True if the reader accepts a string that does not match, because a rule of the lint reports it."""


@dataclass(frozen=True, slots=True)
class Integer:
    """Type of an integer, which must be written in decimal."""

    minimum: int
    maximum: int


@dataclass(frozen=True, slots=True)
class Boolean:
    """Type of the values ``true`` and ``false``."""


@dataclass(frozen=True, slots=True)
class Number:
    """Type of a number, with or without a fraction; ``.nan`` and ``.inf`` are allowed."""


@dataclass(frozen=True, slots=True)
class Duration:
    """Type of a duration, which is written with its unit, ``500ms`` or ``2s``. In the `Table` it is in milliseconds."""

    minimum: int
    """Shortest allowed duration in milliseconds; `maximum` is the longest."""
    maximum: int

    pattern = r"([1-9][0-9]{0,9})(ms|s)"

    def read(self, text: str) -> int | None:
        """Return a duration's text in milliseconds; None if the text is not a duration, or is out of range."""
        found = re.fullmatch(self.pattern, text)
        milliseconds = int(found[1]) * (1000 if found[2] == "s" else 1) if found else 0
        return milliseconds if self.minimum <= milliseconds <= self.maximum else None


@dataclass(frozen=True, slots=True)
class Scalar:
    """Type of a number, a text, ``true`` or ``false``. It is kept as text; a later step checks it."""


@dataclass(frozen=True, slots=True)
class ListOf:
    """Type of a list whose items have one type. With `unique`, the same text may not appear twice."""

    item: Type
    least: int = 0
    unique: bool = True


@dataclass(frozen=True, slots=True)
class MapOf:
    """Type of a mapping from names that the user chooses. Its values have one type."""

    key: Text
    value: Type
    name: str = ""
    """Attribute of the value's part to which the name is assigned. If set, the `Table` has a tuple of parts here."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """Documentation of a key."""

    text: str
    """Sentences about the key for the JSON Schema, the reference, and the diagnostic about a missing key."""
    default: str = ""
    """Default value in words, if it depends on other keys; empty otherwise."""
    see: str = ""
    """Page and section of docs/ with more about the key: ``lint.md#fixed-sizes``."""
    key: str = ""
    """Name of the key in the file; empty if it is the name of the attribute."""


@dataclass(frozen=True, slots=True)
class Key:
    """Key of a YAML mapping, with the type and the documentation of its value."""

    type: Type
    meaning: Meaning
    required: bool = False
    default: Any = None
    """Value that is used if an optional key is missing."""
    attribute: str = ""
    """Attribute of the part to which the value is assigned."""


@dataclass(frozen=True, slots=True)
class Object:
    """Type of a mapping whose keys are known."""

    keys: Mapping[str, Key] = field(hash=False)
    others: MapOf | None = None
    """Type of the keys that are not in `keys`, with their values; None if there may be none."""
    part: type[Any] | None = None
    """Dataclass that the value becomes (`roverlink.generator.table.parts`); None if there is none."""


@dataclass(frozen=True, slots=True)
class AnyOf:
    """Type of a value that has one of several types. YAML must be able to tell these types apart."""

    forms: tuple[Type, ...]


@dataclass(frozen=True, slots=True)
class Named:
    """Type that has a name in the JSON Schema, and can therefore contain itself."""

    name: str
    definition: Callable[[], AnyOf] = field(compare=False)


Type = Text | Integer | Boolean | Number | Duration | Scalar | ListOf | MapOf | Object | AnyOf | Named
