"""Maps, which are sequences of entries in ROS 2."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from roverlink.runtime.core.errors import ConversionError

K = TypeVar("K")
V = TypeVar("V")


def mapping(entries: Iterable[tuple[K, V]], field: str) -> dict[K, V]:
    """The map that has the entries. Raises `ConversionError` where a key stands twice: a map would lose the first."""
    made: dict[K, V] = {}
    for key, value in entries:
        if key in made:
            raise ConversionError(f"the key {key!r} stands twice", field)
        made[key] = value
    return made
