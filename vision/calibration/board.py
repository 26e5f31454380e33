"""ChArUco boards: chessboards with a marker in each white square, so that each corner can be identified."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.opencv import cv2

COLUMNS, ROWS = 11, 8
"""Default numbers of columns and rows of squares; with squares of `SQUARE` the board fits on A4 in landscape."""
SQUARE, MARKER = 0.024, 0.018
"""Default sides of a square and of a marker in metres."""
# Few and coarse modules: the board's markers are small, and 50 are enough for 100 squares.
DICTIONARY = "DICT_4X4_50"
"""Default dictionary of the board's markers, by OpenCV's name.

It differs from the default dictionary of the markers on the field, because both may be visible in the same image.
"""


@dataclass(frozen=True, slots=True, eq=False)
class CharucoBoard:
    """ChArUco board of `columns` x `rows` squares. Raises `SetupError` for an impossible board.

    `square` and `marker` are the sides of a square and of a marker in metres. `dictionary` is OpenCV's name of the
    dictionary of the markers, such as ``DICT_4X4_50``. Set `legacy` for a board with an even number of rows that was
    made with OpenCV before 4.6. The board's frame has its origin at the outer corner of the upper left square. x points
    along the rows, y down the columns, z into the board; the unit is the metre.
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
            raise SetupError(f"a board of {self.columns}x{self.rows} squares is too small; it needs at least 3x3")
        if not 0 < self.marker < self.square < math.inf:
            raise SetupError(
                f"markers of {self.marker} m do not fit squares of {self.square} m: a marker must be smaller than a "
                "square"
            )
        known = [name for name in dir(cv2.aruco) if name.startswith("DICT_")]
        if self.dictionary not in known:
            raise SetupError(f"unknown dictionary {self.dictionary!r}; {nearest(self.dictionary, known)}")
        bits = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, self.dictionary))
        there, needed = len(bits.bytesList), self.columns * self.rows // 2
        if there < needed:
            raise SetupError(
                f"{self.dictionary} has only {there} markers, but {self.columns}x{self.rows} squares need {needed}; "
                "use a larger dictionary or fewer squares"
            )
        board = cv2.aruco.CharucoBoard((self.columns, self.rows), self.square, self.marker, bits)
        # OpenCV 4.6 changed the pattern of boards with an even number of rows.
        board.setLegacyPattern(self.legacy)
        object.__setattr__(self, "_opencv", board)

    @property
    def opencv(self) -> Any:
        """Same board as an OpenCV object, `cv2.aruco.CharucoBoard`."""
        return self._opencv

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the board without its margin, in metres."""
        return self.columns * self.square, self.rows * self.square

    @property
    def grid(self) -> tuple[int, int]:
        """Number of inner corners along a row and along a column."""
        return self.columns - 1, self.rows - 1

    @property
    def points(self) -> Floats:
        """Inner corners (N, 3) in the board's frame in metres. The id of a corner is its index in this array."""
        across, down = self.grid
        row, column = np.divmod(np.arange(across * down), across)
        return np.column_stack([column + 1, row + 1, np.zeros(across * down)]) * self.square

    @property
    def outline(self) -> Floats:
        """Outer corners (4, 3) in the board's frame in metres, clockwise from the origin."""
        width, height = self.size
        return np.array([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]])
