"""Set of markers that a program searches for: their dictionary, their printed sizes, and their boards."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.pattern import Pattern, make_pattern
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError, nearest

DICTIONARY = "DICT_5X5_250"
SIDE = 0.05
"""Default side of a marker in metres."""

TargetId = int | str
"""Identifier of a landmark: the number of a single marker, or the name of a board."""


@cache
def dictionaries() -> Mapping[str, int]:
    """Return the names of OpenCV's dictionaries, each with its number of markers. Of two spellings, one is returned."""
    by_value = {getattr(cv2.aruco, name): name for name in dir(cv2.aruco) if name.startswith("DICT_")}
    return {name: len(cv2.aruco.getPredefinedDictionary(value).bytesList) for value, name in by_value.items()}


def square(side: float) -> Floats:
    """Return the corners (4, 3) of a marker in its own frame, upper left first; `side` is in metres.

    The frame has x right and y up on the print, z out of it, and its origin in the marker's centre.
    """
    h = side / 2
    return np.array([[-h, h, 0], [h, h, 0], [h, -h, 0], [-h, -h, 0]])


def black_modules(dictionary: Any, number: int, border: int = 1) -> NDArray[np.bool_]:
    """Return a mask (n, n) of a marker's black modules (cells), with a black border that is `border` modules wide."""
    image = dictionary.generateImageMarker(number, dictionary.markerSize + 2 * border, borderBits=border)
    return np.asarray(image) < 128


@dataclass(frozen=True, slots=True, eq=False)
class Board:
    """Board: a group of markers at known relative positions, which form one landmark.

    `corners` holds the corners (4, 3) of each marker, in the board's frame in metres, in the order of `square`. The
    markers may lie in different planes.
    """

    name: str
    corners: Mapping[int, Floats]

    def __post_init__(self) -> None:
        if not self.corners:
            raise SetupError(f"board {self.name!r} has no markers")
        for number, corners in self.corners.items():
            sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
            if np.shape(corners) != (4, 3) or np.max(sides) > 1.01 * np.min(sides) or np.min(sides) <= 0:
                raise SetupError(f"board {self.name!r}: the corners of marker {number} do not form a square")


@dataclass(frozen=True, slots=True, eq=False)
class MarkerSet:
    """Set of markers to search for. Raises `SetupError` for impossible values.

    `dictionary` is OpenCV's name of the markers' dictionary. `side` is the distance in metres between the outer edges
    of a marker's black square. `sides` holds other sides for single markers, by their number. If `side` is None, only
    the markers in `sides` and on boards are searched for.
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
            raise SetupError(f"unknown dictionary {self.dictionary!r}; {nearest(self.dictionary, known)}")
        bits = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, self.dictionary))
        object.__setattr__(self, "_bits", bits)
        count = len(bits.bytesList)
        boards: dict[int, Board] = {}
        for board in self.boards:
            for number in board.corners:
                if number in boards:
                    raise SetupError(f"marker {number} is on two boards, {boards[number].name!r} and {board.name!r}")
                boards[number] = board
        object.__setattr__(self, "_boards", boards)
        for number in (*self.sides, *boards):
            if number not in range(count):
                raise SetupError(f"{self.dictionary} has no marker {number}; its numbers are 0 to {count - 1}")
        for side in (*self.sides.values(), *([] if self.side is None else [self.side])):
            if not 0 < side < math.inf:
                raise SetupError(f"the side of a marker is {side} m; it must be positive and finite")

    @property
    def bits(self) -> Any:
        """Dictionary of the markers as an OpenCV object, `cv2.aruco.Dictionary`."""
        return self._bits

    @property
    def white(self) -> NDArray[np.bool_]:
        """Masks (D, n, n) of the white modules (cells) of all markers of the dictionary, without their borders."""
        return np.stack([~black_modules(self._bits, number)[1:-1, 1:-1] for number in range(len(self._bits.bytesList))])

    def __contains__(self, number: int) -> bool:
        return self.side is not None or number in self.sides or number in self._boards

    def target(self, number: int) -> TargetId:
        """Return the landmark to which a marker belongs: the name of its board, or else the marker's own number."""
        return self._boards[number].name if number in self._boards else number

    def is_target(self, target: TargetId) -> bool:
        """Return true if `target` is the name of a board, or the number of a marker that is on no board."""
        if isinstance(target, str):
            return any(board.name == target for board in self.boards)
        return target in range(len(self._bits.bytesList)) and target in self and target not in self._boards

    def points(self, number: int) -> Floats:
        """Return the corners (4, 3) of a marker in the frame of its landmark, in metres."""
        return self._boards[number].corners[number] if number in self._boards else self.own_points(number)

    def own_points(self, number: int) -> Floats:
        """Return the corners (4, 3) of a marker in its own frame, in metres, also if it is on a board."""
        if number in self._boards:
            upper_left, upper_right, *_ = self._boards[number].corners[number]
            return square(float(np.linalg.norm(upper_right - upper_left)))
        side = self.sides.get(number, self.side)
        if side is None:
            raise SetupError(f"the side of marker {number} is unknown")
        return square(side)

    def pattern(self, number: int) -> Pattern:
        """Return the pattern of a marker in the form that `fit_edges` needs."""
        if number not in self._patterns:
            modules = self._bits.markerSize + 2
            self._patterns[number] = make_pattern(np.asarray(self._bits.generateImageMarker(number, modules)) > 127)
        return self._patterns[number]
