"""Shape of a board: how it differs from the flat board that was meant, by a bend and by a stretch of the print.

Four numbers describe it. Three are the bend, a height above the plane that is a quadratic function of the place on the
board: the heights in metres of a cylinder across the columns, of a twist, and of a cylinder across the rows. The fourth
is the stretch: how much higher the print is than wide, as a fraction, because printers feed the paper a little faster
or slower than their lines are wide. All views share these numbers, because the board does not change between views.

They are estimated together with the camera, because an error that nobody sees is worse than any other. A board of
264 mm that is bent by a quarter of a millimetre moved the focal length by 0.3 %, ten times its stated uncertainty; a
print that is 0.2 % too wide moved it by 0.4 %.
"""

from __future__ import annotations

import numpy as np

from roverkit.calibration.board import CalibrationBoard
from roverkit.vision.camera.camera_model import Floats

NUMBERS = 4
"""Number of values that describe a shape."""
BEND = slice(0, 3)
"""Values of the bend."""
STRETCH = 3
"""Index of the stretch."""
_GRID = 9


def displacements(board: CalibrationBoard, places: Floats) -> Floats:
    """Return how far (N, 3, 4) `places` (N, 2 or more) on a board move, in metres, for each value of a shape of 1."""
    u, v = (2 * places[:, :2] / np.array(board.size) - 1).T
    moved = np.zeros((len(places), 3, NUMBERS))
    moved[:, 2, BEND] = np.column_stack([u * u, u * v, v * v])
    moved[:, 1, STRETCH] = places[:, 1]
    return moved


def shaped_points(board: CalibrationBoard, shape: Floats) -> Floats:
    """Return the corners (N, 3) of a board with a shape (4,)."""
    shaped: Floats = board.points + displacements(board, board.points) @ shape
    return shaped


def height(board: CalibrationBoard, shape: Floats) -> float:
    """Return the distance in metres between the two parallel planes that enclose a board with a shape (4,)."""
    x, y = np.meshgrid(np.linspace(0, board.size[0], _GRID), np.linspace(0, board.size[1], _GRID))
    places = np.column_stack([x.ravel(), y.ravel(), np.ones(x.size)])
    z = displacements(board, places)[:, 2] @ shape
    return float(np.ptp(z - places @ np.linalg.lstsq(places, z, rcond=None)[0]))
