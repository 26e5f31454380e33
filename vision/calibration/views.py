"""Views of a board: which of its corners were seen where in an image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision._opencv import cv2
from vision.calibration.board import CharucoBoard
from vision.camera import Floats
from vision.detection import Image

FEWEST_CORNERS = 8
"""A view with fewer corners says little, and hides what is wrong with it."""
_FLAT = 0.05
"""Corners that spread less across than so many times along are in one line."""

_WINDOW = 4
"""Pixels to each side of a corner."""

OFFSET = 0.495 if int(cv2.__version__.split(".")[0]) < 5 else 0.0
"""Pixels by which OpenCV's ChArUco corners are too far right and down: measured, see `tests/vision/test_views.py`."""


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """The corners of a board in one image. Integer pixel coordinates are centres of pixels."""

    name: str
    """The image's file, or when the frame was taken: what a report calls it."""
    ids: NDArray[np.intp]
    """(N,) numbers of the corners: places in `CharucoBoard.points`; rising."""
    corners: Floats
    """(N, 2) in pixels."""
    size: tuple[int, int]
    """Width and height of the image."""
    stamp_ns: int = 0
    """When the image was taken, in nanoseconds since 1970; 0 where that is not known."""

    @property
    def flaw(self) -> str:
        """Why the view is of no use, in words; empty if it is of use."""
        if not self.ids.size:
            return "the board is not seen"
        if self.ids.size < FEWEST_CORNERS:
            return f"{self.ids.size} corners are seen, and {FEWEST_CORNERS} are needed"
        spread = np.linalg.svd(self.corners - self.corners.mean(axis=0), compute_uv=False)
        return "the corners are in one line" if spread[1] < _FLAT * spread[0] else ""


class BoardDetector:
    """Finds a board's corners in images."""

    def __init__(self, board: CharucoBoard) -> None:
        self.board = board
        self._detector: Any = cv2.aruco.CharucoDetector(board.opencv)

    def find(self, image: Image, name: str = "", stamp_ns: int = 0) -> View:
        """The corners that are seen in a grey image (H, W); there may be none."""
        corners, ids, _, _ = self._detector.detectBoard(image)
        height, width = image.shape
        # (N, 1, 2) and (N, 1) in OpenCV 4, (N, 2) and (N,) in 5, None in both
        found = np.zeros(0, np.intp) if ids is None else np.reshape(ids, -1).astype(np.intp)
        places = np.zeros((0, 2)) if ids is None else np.reshape(corners, (-1, 2)).astype(float) - OFFSET
        order = np.argsort(found)
        return View(name, found[order], _refine(image, places[order]), (width, height), stamp_ns)


def _refine(image: Image, corners: Floats) -> Floats:
    """Corners (N, 2) where the image's gradients meet in a small window.

    OpenCV's detector has done so in windows that grow with the squares, where the lens bends the edges.
    """
    if not len(corners):
        return corners
    start = corners.astype(np.float32).reshape(-1, 1, 2)
    ends = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 100, 1e-4)
    refined: Floats = cv2.cornerSubPix(image, start, (_WINDOW, _WINDOW), (-1, -1), ends)
    return refined.reshape(-1, 2).astype(float)
