"""Content of a sheet of paper: black rectangles and text, in metres from the upper left corner, y down."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Rectangle:
    """Black rectangle."""

    left: float
    top: float
    width: float
    height: float

    def moved(self, right: float, down: float) -> Rectangle:
        """Return the rectangle, shifted to the right and down by metres."""
        return Rectangle(self.left + right, self.top + down, self.width, self.height)


@dataclass(frozen=True, slots=True)
class Label:
    """Text in capitals of a given height; `left` and `base` are the start of its base line."""

    left: float
    base: float
    height: float
    text: str


@dataclass(frozen=True, slots=True)
class Sheet:
    """Page of paper."""

    width: float
    height: float
    rectangles: tuple[Rectangle, ...]
    labels: tuple[Label, ...] = ()


def moved(rectangles: Iterable[Rectangle], right: float, down: float) -> list[Rectangle]:
    """Return the rectangles, shifted to the right and down by metres."""
    return [one.moved(right, down) for one in rectangles]
