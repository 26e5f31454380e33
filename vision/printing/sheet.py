"""What is on a sheet of paper: black rectangles and words, in metres from its upper left corner, y down."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A black rectangle."""

    left: float
    top: float
    width: float
    height: float

    def moved(self, right: float, down: float) -> Rectangle:
        """The same elsewhere."""
        return Rectangle(self.left + right, self.top + down, self.width, self.height)


@dataclass(frozen=True, slots=True)
class Label:
    """Words in capitals of a height, that start at the left of their base line."""

    left: float
    base: float
    height: float
    text: str


@dataclass(frozen=True, slots=True)
class Sheet:
    """A page."""

    width: float
    height: float
    rectangles: tuple[Rectangle, ...]
    labels: tuple[Label, ...] = ()


def moved(rectangles: Iterable[Rectangle], right: float, down: float) -> list[Rectangle]:
    """Rectangles elsewhere."""
    return [one.moved(right, down) for one in rectangles]
