"""Content of a sheet of paper: black rectangles and text.

Positions are in metres from the upper left corner of the sheet; y points down.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Rectangle:
    """Black rectangle on a sheet."""

    left: float
    top: float
    width: float
    height: float

    def moved(self, right: float, down: float) -> Rectangle:
        """Return the rectangle, shifted to the right and down by these distances in metres."""
        return Rectangle(self.left + right, self.top + down, self.width, self.height)


@dataclass(frozen=True, slots=True)
class Label:
    """Text on a sheet.

    `height` is the height of the capital letters; `left` and `base` are the position where the base line starts.
    """

    left: float
    base: float
    height: float
    text: str


@dataclass(frozen=True, slots=True)
class Sheet:
    """Sheet of paper with its content; `width` and `height` are in metres."""

    width: float
    height: float
    rectangles: tuple[Rectangle, ...]
    labels: tuple[Label, ...] = ()


def moved(rectangles: Iterable[Rectangle], right: float, down: float) -> list[Rectangle]:
    """Return the rectangles, shifted to the right and down by these distances in metres."""
    return [rectangle.moved(right, down) for rectangle in rectangles]
