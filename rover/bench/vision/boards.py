"""Scenes with known truth for calibrations: a camera, and views of a ChArUco board."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import cv2
import numpy as np
from roverkit.calibration import CharucoBoard
from roverkit.vision.images.rendering import RAYS, Floats, Grey, Lens, Pose, Print, project, render, texture

BOARD = CharucoBoard()
LARGEST_TILT = np.radians(45)
FILLS = (0.3, 1.0)
"""Range of the board's width as a fraction of the image width, if it faced the camera."""
MIDDLES = (0.12, 0.88)
"""Range of the board's centre as a fraction of the image's width and height."""
ROLL = 0.3
"""Standard deviation of the rotation about the line of sight, in radians."""
SHAKE = 2.0
"""Amplitude in pixels of the row shifts in a corrupted view, as if the camera shook during readout."""
_PERIODS = 9  # oscillations in a frame
_BLACK, _WHITE = 25, 225


@dataclass(frozen=True, slots=True)
class BoardView:
    """Frame with its truth: the board's pose, in the frame of its print."""

    name: str
    frame: Grey
    pose: Pose


def board_views(camera: Lens, seed: int, count: int) -> Iterator[BoardView]:
    """Yield views of a camera, rendered on all processors; equal seeds give equal views."""
    jobs = [(camera, seed, index) for index in range(count)]
    with ProcessPoolExecutor(len(os.sched_getaffinity(0)), get_context("spawn")) as pool:
        yield from pool.map(_view, jobs)


def corrupted(view: BoardView) -> BoardView:
    """Return the frame as a camera sees it that shakes during readout."""
    height, width = view.frame.shape
    rows, columns = np.indices((height, width), np.float32)
    columns += np.float32(SHAKE) * np.sin(rows * np.float32(2 * np.pi * _PERIODS / height))
    frame = cv2.remap(view.frame, columns, rows, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return BoardView(f"{view.name} shaken", frame, view.pose)


def true_corners(camera: Lens, pose: Pose, ids: Sequence[int]) -> Floats:
    """Return the true pixels (N, 2) of corners of the board."""
    return project(camera, pose, on_print(BOARD.points[list(ids)]))


def on_print(points: Floats) -> Floats:
    """Convert points (N, 3) from the frame of the board to that of its print."""
    width, height = BOARD.size
    converted: Floats = (points - np.array([width / 2, height / 2, 0])) * np.array([1, -1, 1])  # y points up there
    return converted


def _view(job: tuple[Lens, int, int]) -> BoardView:
    camera, seed, index = job
    rng = np.random.default_rng([seed, *camera.size, index])
    fill, pose = random_pose(camera, rng)
    plane = board_print(fill * camera.size[0] / BOARD.columns)
    return BoardView(f"view {index}", render(camera, texture(camera.size, rng), [(plane, pose)], rng), pose)


def board_print(square_px: float) -> Print:
    """Return the board with a white border, with a resolution for squares of `square_px` pixels in the image."""
    texels = 8 * max(
        2, round(0.75 * RAYS * square_px / 8)
    )  # a square has 8 modules: 6 of the marker and 1 on each side
    columns, rows = BOARD.columns, BOARD.rows
    grey = BOARD.opencv.generateImage((columns * texels, rows * texels), marginSize=0)
    grey = np.pad(np.asarray(grey), texels // 2, constant_values=255)
    return Print(np.where(grey > 127, _WHITE, _BLACK).astype(np.uint8), BOARD.square / texels)


def random_pose(camera: Lens, rng: np.random.Generator) -> tuple[float, Pose]:
    """Return a pose that shows at least three corners of the board, and the share of the width that it fills."""
    size = np.array(camera.size)
    half = np.array([*BOARD.size, 0]) / 2
    rim = np.array([(x, y, 0) for x, y in itertools.product((-1, 1), (-1, 1))]) * half
    while True:
        fill = rng.uniform(*FILLS)
        distance = camera.matrix[0, 0] * BOARD.size[0] / (fill * size[0])
        tilt, towards, roll = rng.uniform(0, LARGEST_TILT), rng.uniform(0, 2 * np.pi), rng.normal(0, ROLL)
        ray = camera.rays(rng.uniform(MIDDLES[0] * size, MIDDLES[1] * size))
        axis = np.array([np.cos(towards), np.sin(towards), 0])
        facing = cv2.Rodrigues(axis * tilt)[0] @ np.diag([1.0, -1, -1]) @ cv2.Rodrigues(np.array([0, 0, roll]))[0]
        pose = Pose(facing, np.append(ray, 1.0) * distance)
        corners = project(camera, pose, rim)
        if ((corners > 0) & (corners < size)).all(axis=1).sum() >= 3:
            return fill, pose
