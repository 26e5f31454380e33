"""Bend of a board: its height above a plane, as a quadratic function of the place on the board.

Three numbers describe the bend: the heights in metres of a cylinder across the columns, of a twist, and of a cylinder
across the rows. All views share them, because the board does not change between views. They are estimated together
with the camera, because a bend that nobody sees is worse than any other error: a board of 264 mm that is bent by a
quarter of a millimetre moved the focal length by 0.3 %, ten times its stated uncertainty.
"""

from __future__ import annotations

import numpy as np

from roverkit.calibration.board import CalibrationBoard
from roverkit.vision.camera.camera_model import Floats

SHAPES = 3
"""Number of values that describe a bend."""
_GRID = 9


def shapes(board: CalibrationBoard, places: Floats) -> Floats:
    """Return the heights (N, 3) of `places` (N, 2 or more) on a board, one for each value of a bend of 1 metre."""
    u, v = (2 * places[:, :2] / np.array(board.size) - 1).T
    return np.column_stack([u * u, u * v, v * v])


def bent_points(board: CalibrationBoard, bend: Floats) -> Floats:
    """Return the corners (N, 3) of a board with a bend (3,)."""
    points = board.points
    points[:, 2] += shapes(board, points) @ bend
    return points


def height(board: CalibrationBoard, bend: Floats) -> float:
    """Return the distance in metres between the two parallel planes that enclose a board with a bend (3,)."""
    x, y = np.meshgrid(np.linspace(0, board.size[0], _GRID), np.linspace(0, board.size[1], _GRID))
    places = np.column_stack([x.ravel(), y.ravel(), np.ones(x.size)])
    z = shapes(board, places) @ bend
    return float(np.ptp(z - places @ np.linalg.lstsq(places, z, rcond=None)[0]))
