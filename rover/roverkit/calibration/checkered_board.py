"""Boards of squares that are alternately black and white; their corners are those where four squares meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roverkit.calibration.board import CalibrationBoard
from roverkit.vision.camera.camera_model import Floats

COLUMNS, ROWS = 11, 8
"""Default numbers of columns and rows of squares; with squares of `SQUARE` the board fits on A4 in landscape."""
SQUARE = 0.024
"""Default side of a square in metres."""


@dataclass(frozen=True, slots=True, eq=False)
class CheckeredBoard(CalibrationBoard):
    """Board of `columns` x `rows` squares; `square` is the side of a square in metres."""

    columns: int = COLUMNS
    rows: int = ROWS
    square: float = SQUARE

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the board without its margin, in metres."""
        return self.columns * self.square, self.rows * self.square

    @property
    def points(self) -> Floats:
        """Inner corners (N, 3) in the board's frame in metres, row by row. The id of a corner is its index."""
        across, down = self.columns - 1, self.rows - 1
        row, column = np.divmod(np.arange(across * down), across)
        return np.column_stack([column + 1, row + 1, np.zeros(across * down)]) * self.square

    @property
    def reach(self) -> float:
        """Distance in metres from a corner, along its edges, up to which the edges are straight and uncrossed."""
        return self.square
