"""Classes that describe mapping.yaml: the types of its values, and the documentation of its keys."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Text:
    """Type of a YAML value: a string."""

    noun: str = "text"
    """Noun for such a string in the documentation, such as "field path".

    If the string is a key, its first word stands in the path of keys: ``bounds.<field>.length``.
    """
    pattern: str = ""
    """Regular expression that the whole string must match."""
    example: str = ""
    choices: tuple[str, ...] = ()
    fault: Callable[[str], tuple[str, str]] | None = field(default=None, compare=False)
    """Further check of a string besides the pattern; None if there is none.

    The function returns the reason why the string is not allowed, and a help text; both are empty if it is allowed.
    """
    checked_by_rule: bool = False
    """True if the reader accepts a string that does not match the pattern, because a rule of the lint reports it."""


@dataclass(frozen=True, slots=True)
class Integer:
    """Type of a YAML value: an integer, which must be written in decimal."""

    minimum: int
    maximum: int


@dataclass(frozen=True, slots=True)
class Boolean:
    """Type of a YAML value: ``true`` or ``false``."""


@dataclass(frozen=True, slots=True)
class Number:
    """Type of a YAML value: a number, with or without a fraction; ``.nan`` and ``.inf`` are allowed."""


@dataclass(frozen=True, slots=True)
class Duration:
    """Type of a YAML value: a duration such as ``500ms`` or ``2s``. The `Table` has it in milliseconds."""

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
class DataRate:
    """Type of a YAML value: a rate of data such as ``200 kB/s`` or ``2 Mbit/s``. The `Table` has it in bytes a second.

    k is 1,000 and M is 1,000,000.
    """

    minimum: int
    """Smallest allowed rate in bytes a second; `maximum` is the largest."""
    maximum: int

    pattern = r"([1-9][0-9]{0,9}) ?([kM]?)(B|bit)/s"

    def read(self, text: str) -> int | None:
        """Return the text of a rate in bytes a second; None if it is not a rate of whole bytes, or is out of range."""
        found = re.fullmatch(self.pattern, text)
        bits = (
            int(found[1]) * {"": 1, "k": 1_000, "M": 1_000_000}[found[2]] * (8 if found[3] == "B" else 1)
            if found
            else 0
        )
        return bits // 8 if bits % 8 == 0 and self.minimum <= bits // 8 <= self.maximum else None


@dataclass(frozen=True, slots=True)
class Scalar:
    """Type of a YAML value: a number, a text, ``true`` or ``false``. It is kept as text, and a later step checks it."""


@dataclass(frozen=True, slots=True)
class ListOf:
    """Type of a YAML value: a list whose items have one type. With `unique`, no text may appear twice."""

    item: Type
    least: int = 0
    """Smallest number of items."""
    unique: bool = True


@dataclass(frozen=True, slots=True)
class MapOf:
    """Type of a YAML value: a mapping whose keys are names that the user chooses, and whose values have one type."""

    key: Text
    value: Type
    name: str = ""
    """Attribute of the value's class that gets the name. If it is set, the `Table` has a tuple of instances here."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """Documentation of a key of mapping.yaml."""

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
    """Attribute of the class in `roverlink.generator.table.keys` that gets the value."""


@dataclass(frozen=True, slots=True)
class Object:
    """Type of a YAML value: a mapping with fixed keys, whose values have types of their own."""

    keys: Mapping[str, Key] = field(hash=False)
    others: MapOf | None = None
    """Type of the keys that are not in `keys`, with their values; None if there may be none."""
    part: type[Any] | None = None
    """Dataclass to which the mapping is converted (`roverlink.generator.table.parts`); None if there is none."""


@dataclass(frozen=True, slots=True)
class AnyOf:
    """Type of a value that has one of several types. YAML must be able to tell these types apart."""

    forms: tuple[Type, ...]


@dataclass(frozen=True, slots=True)
class Named:
    """Type with a name in the JSON Schema. It can contain itself, because `definition` returns it only when needed."""

    name: str
    definition: Callable[[], AnyOf] = field(compare=False)


Type = Text | Integer | Boolean | Number | Duration | DataRate | Scalar | ListOf | MapOf | Object | AnyOf | Named
