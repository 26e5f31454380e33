"""ChArUco board that moves in front of a camera, rendered, with known camera parameters."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
from roverkit.vision.images.rendering import Grey, Lens, Pose, render, texture

from rover.bench.vision.boards import BOARD, board_print

SIZE = (640, 480)
LENS = Lens(
    np.array([[600.0, 0, 325.3], [0, 602.4, 236.1], [0, 0, 1]]), (0.080096, -0.156227, 0.00111085, 0.0005, 0.03), SIZE
)
_PLACES = ((0.5, 0.5), (0.25, 0.28), (0.75, 0.28), (0.25, 0.72), (0.75, 0.72), (0.5, 0.25), (0.5, 0.75))
"""Positions of the board's centre, as fractions of the image."""
_DISTANCES = (0.3, 0.45, 0.36, 0.62)
"""Distances in metres."""
_TILTS = ((0, 32), (32, 0), (0, -32), (-32, 0), (0, 0), (22, 22), (-22, 22))
"""Tilts in degrees about the image's x and y."""
_ROLL = 15.0
"""Largest rotation about the line of sight in degrees."""


def pictures(count: int) -> Iterator[Grey]:
    """Yield images (H, W) of the board at different positions, distances and tilts; always the same."""
    rng = np.random.default_rng(10)
    background = texture(SIZE, rng)
    for number in range(count):
        pose = _pose(number, float(rng.uniform(-_ROLL, _ROLL)))
        square_px = float(LENS.matrix[0, 0]) * BOARD.square / pose.translation[2]
        yield render(LENS, background, [(board_print(square_px), pose)], rng)


def _pose(number: int, roll: float) -> Pose:
    across, down = _PLACES[number % len(_PLACES)]
    tilt = np.radians([*_TILTS[(number + number // len(_PLACES)) % len(_TILTS)], 0.0])
    facing = np.diag([1.0, -1.0, -1.0])  # a print's z axis points out of it, towards the camera
    rotation = cv2.Rodrigues(tilt)[0] @ cv2.Rodrigues(np.radians([0, 0, roll]))[0] @ facing
    ray = LENS.rays(np.array([[across * SIZE[0], down * SIZE[1]]]))[0]
    return Pose(rotation, np.append(ray, 1.0) * _DISTANCES[number % len(_DISTANCES)])
