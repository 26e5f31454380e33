"""ChArUco boards: chessboards whose white squares have markers, so that every corner is known by its number."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.opencv import cv2

COLUMNS, ROWS = 11, 8
"""Squares; at `SQUARE` a board that fits on A4 across."""
SQUARE, MARKER = 0.024, 0.018
"""Metres."""
DICTIONARY = "DICT_4X4_50"
"""Not that of the landmarks, which may be in the picture, too."""


@dataclass(frozen=True, slots=True, eq=False)
class CharucoBoard:
    """A board of `columns` x `rows` squares. Raises `SetupError` for what cannot be.

    `square` and `marker` are sides in metres; `legacy` is for boards with an even number of rows that were printed by
    OpenCV before 4.6. The board's frame has its origin at the outer corner of the upper left square, x along the rows,
    y down the columns, z into the board; metres.
    """

    columns: int = COLUMNS
    rows: int = ROWS
    square: float = SQUARE
    marker: float = MARKER
    dictionary: str = DICTIONARY
    legacy: bool = False
    _opencv: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if min(self.columns, self.rows) < 3:
            raise SetupError(f"a board of {self.columns}x{self.rows} squares; it needs 3x3 for corners in two rows")
        if not 0 < self.marker < self.square < math.inf:
            raise SetupError(
                f"markers of {self.marker} m in squares of {self.square} m: a marker is smaller than its square"
            )
        known = [name for name in dir(cv2.aruco) if name.startswith("DICT_")]
        if self.dictionary not in known:
            raise SetupError(f"no dictionary {self.dictionary!r}; {nearest(self.dictionary, known)}")
        bits = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, self.dictionary))
        there, needed = len(bits.bytesList), self.columns * self.rows // 2
        if there < needed:
            raise SetupError(
                f"{self.dictionary} has {there} markers, and {self.columns}x{self.rows} squares need {needed}"
            )
        board = cv2.aruco.CharucoBoard((self.columns, self.rows), self.square, self.marker, bits)
        board.setLegacyPattern(self.legacy)
        object.__setattr__(self, "_opencv", board)

    @property
    def opencv(self) -> Any:
        """OpenCV's board."""
        return self._opencv

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of all squares in metres."""
        return self.columns * self.square, self.rows * self.square

    @property
    def grid(self) -> tuple[int, int]:
        """How many inner corners there are along a row and along a column."""
        return self.columns - 1, self.rows - 1

    @property
    def points(self) -> Floats:
        """The inner corners (N, 3) in the board's frame, in metres; a corner's number is its place here."""
        across, down = self.grid
        row, column = np.divmod(np.arange(across * down), across)
        return np.column_stack([column + 1, row + 1, np.zeros(across * down)]) * self.square

    @property
    def outline(self) -> Floats:
        """The outer corners (4, 3) in the board's frame, in metres, clockwise from the origin."""
        width, height = self.size
        return np.array([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]])
