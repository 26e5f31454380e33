"""Conversion of protobuf maps. In ROS 2, a map is a sequence of entries, each with a key and a value."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from roverlink.runtime.core.errors import ConversionError

K = TypeVar("K")
V = TypeVar("V")


def mapping(entries: Iterable[tuple[K, V]], field: str) -> dict[K, V]:
    """Build a map from its entries. Raises `ConversionError` if a key occurs twice, because one entry would be lost.

    ``field`` is the field's name, for the error.
    """
    made: dict[K, V] = {}
    for key, value in entries:
        if key in made:
            raise ConversionError(f"the key {key!r} occurs twice", field)
        made[key] = value
    return made
