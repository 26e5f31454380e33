"""The types by which a YAML file's format is said: what may stand at a place, and what it means there."""

from __future__ import annotations

import re
from dataclasses import dataclass
from ipaddress import IPv4Network


@dataclass(frozen=True, slots=True)
class Text:
    """A string; ``pattern`` is a regular expression that the whole of it must match."""

    pattern: str = ""
    example: str = ""
    choices: tuple[str, ...] = ()


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
        """The milliseconds that a text says; None where it says none that may stand here."""
        found = re.fullmatch(self.pattern, text)
        milliseconds = int(found[1]) * (1000 if found[2] == "s" else 1) if found else 0
        return milliseconds if self.minimum <= milliseconds <= self.maximum else None


@dataclass(frozen=True, slots=True)
class Network:
    """An IPv4 address, or a network of them, ``10.0.0.0/24``."""

    pattern = r"[0-9]{1,3}(\.[0-9]{1,3}){3}(/[0-9]{1,2})?"

    def fault(self, text: str) -> str:
        """Why a text is none, and what would be one; empty where it is one."""
        try:
            network = IPv4Network(text, strict=False)
        except ValueError:
            return "an IPv4 address or network, such as 10.0.0.7 or 10.0.0.0/24"
        return "" if text in (str(network), str(network.network_address)) else f"the network is {network}"


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number, a text, ``true`` or ``false``, as it is written; who knows its meaning checks it."""


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


@dataclass(frozen=True, slots=True)
class Key:
    """A key of an object: what may stand there, and what it means."""

    type: Type
    meaning: str
    required: bool = False


@dataclass(frozen=True, slots=True)
class Object:
    """A mapping with known keys; ``others`` says what any other key may be, where one may."""

    keys: dict[str, Key]
    others: MapOf | None = None


@dataclass(frozen=True, slots=True)
class AnyOf:
    """One of several forms, of which no two are of one kind of YAML value."""

    forms: tuple[Type, ...]


@dataclass(frozen=True, slots=True)
class Named:
    """A type that is defined under a name in `generator.feed_format.DEFINITIONS`, so that it can hold itself."""

    name: str


Type = Text | Integer | Boolean | Number | Duration | Network | Scalar | ListOf | MapOf | Object | AnyOf | Named
