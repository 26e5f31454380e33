"""Chessboards without markers: every corner must be visible, because nothing else identifies a corner."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.board import Artwork, Finder, millimetres, nothing_found
from roverkit.calibration.checkered_board import CheckeredBoard
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError

_FEWEST = 4
"""Least number of squares in a row or column; OpenCV's detector needs three inner corners."""


@dataclass(frozen=True, slots=True, eq=False)
class Chessboard(CheckeredBoard):
    """Chessboard of `columns` x `rows` squares; `square` is the side of a square in metres.

    Raises `SetupError` for an impossible board.
    """

    def __post_init__(self) -> None:
        if min(self.columns, self.rows) < _FEWEST:
            raise SetupError(
                f"a chessboard of {self.columns}x{self.rows} squares is too small; it needs at least "
                f"{_FEWEST}x{_FEWEST}"
            )
        if not 0 < self.square < math.inf:
            raise SetupError(f"the side of a square is {self.square} m; it must be positive and finite")

    @property
    def description(self) -> str:
        """Kind and sizes of the board in words, without an article."""
        return f"chessboard of {self.columns} x {self.rows} squares of {millimetres(self.square)}"

    @property
    def gap(self) -> float:
        """Infinite distance to the nearest marker, because there is none."""
        return math.inf

    @property
    def artwork(self) -> Artwork:
        """Black parts of the board; the upper left square is black."""
        squares = (
            (column * self.square, row * self.square)
            for column, row in itertools.product(range(self.columns), range(self.rows))
            if (column + row) % 2 == 0
        )
        return Artwork(tuple(squares), self.square)

    def finder(self) -> Finder:
        """Return a function that finds the board's corners in an image that shows all of them."""
        shape = self.columns - 1, self.rows - 1

        def find(image: Image) -> tuple[NDArray[np.intp], Floats]:
            found, corners = cv2.findChessboardCornersSB(image, shape)
            if not found:
                return nothing_found()
            grid = np.reshape(corners, (shape[1], shape[0], 2)).astype(float)
            return np.arange(shape[0] * shape[1]), _upright(grid).reshape(-1, 2)

        return find


def _upright(grid: Floats) -> Floats:
    """Return the corners (rows, columns, 2) so that rows run to the right and columns are clockwise from them.

    A chessboard that is turned by half a turn may look the same. Views of a board that does not move should number its
    corners equally.
    """
    along, down = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
    if along[0] * down[1] < along[1] * down[0]:  # mirrored
        grid, down = grid[::-1], -down
    return grid[::-1, ::-1] if along[0] < 0 else grid
