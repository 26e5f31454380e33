"""Views of a board without images: corners where they should be, by OpenCV's projection, and noise."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
from roverkit.calibration import CharucoBoard, View
from roverkit.vision import CameraParameters

BOARD = CharucoBoard()
SIZE = (1280, 720)
MATRIX = np.array([[920.0, 0, 647.3], [0, 923.7, 355.4], [0, 0, 1]])
CAMERA = CameraParameters(MATRIX, np.array([0.100096, -0.256227, 0.00111085, 0.000269882, 0.203651]), SIZE)
RATIONAL = CameraParameters(MATRIX, np.array([0.9, 0.3, 1e-3, -2e-3, 0.02, 1.2, 0.5, 0.05]), SIZE)
FISHEYE = CameraParameters(
    np.array([[430.0, 0, 640], [0, 431, 361], [0, 0, 1]]), np.array([0.05, -0.02, 0.01, -0.002]), SIZE, fisheye=True
)
NOISE = 0.03  # Pixels


def project(camera: CameraParameters, points: np.ndarray, turn: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """The pixels (N, 2) of points (N, 3), by OpenCV."""
    if camera.fisheye:
        pixels, _ = cv2.fisheye.projectPoints(points[:, None], turn, shift, camera.matrix, camera.distortion)
    else:
        pixels, _ = cv2.projectPoints(points, turn, shift, camera.matrix, camera.distortion)
    return np.reshape(pixels, (-1, 2))


def view(camera: CameraParameters, turn: np.ndarray, shift: np.ndarray, rng: np.random.Generator, name: str) -> View:
    """What is in the image of a board at a pose."""
    pixels = project(camera, BOARD.points, turn, shift) + rng.normal(0, NOISE, (len(BOARD.points), 2))
    inside = ((pixels > 2) & (pixels < np.array(SIZE) - 3)).all(axis=1)
    return View(name, np.flatnonzero(inside), pixels[inside], np.full(inside.sum(), NOISE), SIZE)


def views(camera: CameraParameters, count: int, seed: int, tilt: float = 0.7) -> list[View]:
    """Boards anywhere in the image, some way off, tilted by up to `tilt` radians."""
    rng = np.random.default_rng(seed)
    found: list[View] = []
    middle = BOARD.outline.mean(axis=0)
    while len(found) < count:
        axis, angle = rng.normal(size=2), rng.uniform(0, tilt)
        turn = np.append(axis / np.linalg.norm(axis) * angle, rng.normal(0, 0.2))
        pixel = rng.uniform((0.15 * SIZE[0], 0.15 * SIZE[1]), (0.85 * SIZE[0], 0.85 * SIZE[1]))
        ray = np.append(camera.undistort(pixel), 1.0)
        shift = (
            ray * BOARD.size[0] * camera.focal[0] / SIZE[0] / rng.uniform(0.3, 0.9) - cv2.Rodrigues(turn)[0] @ middle
        )
        one = view(camera, turn, shift, rng, f"view {len(found)}")
        if len(one.ids) >= 40:
            found.append(one)
    return found


def part(whole: View, mask: np.ndarray) -> View:
    """A view of which only some corners are seen."""
    return replace(whole, ids=whole.ids[mask], corners=whole.corners[mask], sigmas=whole.sigmas[mask])
