"""Protobuf maps, which are sequences of entries in ROS 2."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

from roverlink.runtime.core.errors import ConversionError

K = TypeVar("K")
V = TypeVar("V")


def mapping(entries: Iterable[tuple[K, V]], field: str) -> dict[K, V]:
    """Build a map from its entries. Raises `ConversionError` if a key occurs twice: a map would lose one entry."""
    made: dict[K, V] = {}
    for key, value in entries:
        if key in made:
            raise ConversionError(f"the key {key!r} occurs twice", field)
        made[key] = value
    return made
