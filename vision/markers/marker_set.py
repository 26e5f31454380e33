"""Which markers there are: their dictionary, how large each is printed, and which belong to one board."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.markers.pattern import Pattern, make_pattern
from roverlink.vision.opencv import cv2

DICTIONARY = "DICT_5X5_250"
SIDE = 0.05
"""Metres."""

TargetId = int | str
"""A marker's number, or a board's name."""


def square(side: float) -> Floats:
    """The corners (4, 3) of a marker in its own frame: x right, y up the print, z out of it; upper left first."""
    h = side / 2
    return np.array([[-h, h, 0], [h, h, 0], [h, -h, 0], [-h, -h, 0]])


@dataclass(frozen=True, slots=True, eq=False)
class Board:
    """Several markers that are one landmark: by number, the corners (4, 3) of each in the board's frame, in metres.

    The corners come in the order of `square`. The markers need not lie in one plane.
    """

    name: str
    corners: Mapping[int, Floats]

    def __post_init__(self) -> None:
        if not self.corners:
            raise SetupError(f"board {self.name!r} has no markers")
        for number, corners in self.corners.items():
            sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
            if np.shape(corners) != (4, 3) or np.max(sides) > 1.01 * np.min(sides) or np.min(sides) <= 0:
                raise SetupError(f"board {self.name!r}: the corners of marker {number} are no square of 4 points")


@dataclass(frozen=True, slots=True, eq=False)
class MarkerSet:
    """The markers to look for. Raises `SetupError` for what cannot be.

    `side` is the distance in metres between the outer edges of the black squares, `sides` that of single numbers.
    Without `side`, only the numbers in `sides` and on boards are markers.
    """

    dictionary: str = DICTIONARY
    side: float | None = SIDE
    sides: Mapping[int, float] = field(default_factory=dict)
    boards: tuple[Board, ...] = ()
    _bits: Any = field(init=False, repr=False)
    _boards: dict[int, Board] = field(init=False, repr=False)
    _patterns: dict[int, Pattern] = field(init=False, repr=False, default_factory=dict)

    def __post_init__(self) -> None:
        known = [name for name in dir(cv2.aruco) if name.startswith("DICT_")]
        if self.dictionary not in known:
            raise SetupError(f"no dictionary {self.dictionary!r}; {nearest(self.dictionary, known)}")
        bits = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, self.dictionary))
        object.__setattr__(self, "_bits", bits)
        count = len(bits.bytesList)
        boards: dict[int, Board] = {}
        for board in self.boards:
            for number in board.corners:
                if number in boards:
                    raise SetupError(f"marker {number} is on the boards {boards[number].name!r} and {board.name!r}")
                boards[number] = board
        object.__setattr__(self, "_boards", boards)
        for number in (*self.sides, *boards):
            if number not in range(count):
                raise SetupError(f"{self.dictionary} has no marker {number}; its numbers are 0 to {count - 1}")
        for side in (*self.sides.values(), *([] if self.side is None else [self.side])):
            if not 0 < side < math.inf:
                raise SetupError(f"a marker's side is {side} m; it must be positive")

    @property
    def bits(self) -> Any:
        """OpenCV's dictionary."""
        return self._bits

    def __contains__(self, number: int) -> bool:
        return self.side is not None or number in self.sides or number in self._boards

    def target(self, number: int) -> TargetId:
        """The landmark that a marker is a part of: its board's name, or its own number."""
        return self._boards[number].name if number in self._boards else number

    def is_target(self, target: TargetId) -> bool:
        """Whether such a landmark can be seen: a board, or a marker that is on none."""
        if isinstance(target, str):
            return any(board.name == target for board in self.boards)
        return target in range(len(self._bits.bytesList)) and target in self and target not in self._boards

    def points(self, number: int) -> Floats:
        """The corners (4, 3) of a marker in its landmark's frame, in metres."""
        if number in self._boards:
            return self._boards[number].corners[number]
        side = self.sides.get(number, self.side)
        if side is None:
            raise SetupError(f"no side is known for marker {number}")
        return square(side)

    def pattern(self, number: int) -> Pattern:
        """What the edge fit compares a marker with."""
        if number not in self._patterns:
            modules = self._bits.markerSize + 2
            self._patterns[number] = make_pattern(np.asarray(self._bits.generateImageMarker(number, modules)) > 127)
        return self._patterns[number]
