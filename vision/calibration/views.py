"""Views of a board: which of its corners were seen where in an image."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverlink.vision.calibration.board import CharucoBoard
from roverlink.vision.calibration.saddles import Sites, find_saddles
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.markers.detection import CELL, Image, to_grey
from roverlink.vision.opencv import cv2

FEWEST_CORNERS = 8
"""A view with fewer corners says little, and hides what is wrong with it."""
OFFSET = 0.495 if int(cv2.__version__.split(".")[0]) < 5 else 0.0
"""Pixels by which OpenCV's ChArUco corners are too far right and down: measured, see `tests/vision/test_views.py`."""

_FLAT = 0.05
"""Corners that spread less across than so many times along are in one line."""
_STRAY = 5.0
"""Pixels that corners may be off a plane that is seen by a camera without distortion, to tell where their edges go."""


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """The corners of a board in one image. Integer pixel coordinates are centres of pixels."""

    name: str
    """The image's file, or when the frame was taken: what a report calls it."""
    ids: NDArray[np.intp]
    """(N,) numbers of the corners: places in `CharucoBoard.points`; rising."""
    corners: Floats
    """(N, 2) in pixels."""
    sigmas: Floats
    """(N,) in pixels: standard deviation of a corner's coordinate, by the noise of the image alone."""
    size: tuple[int, int]
    """Width and height of the image."""
    blur: float = 0.0
    """Standard deviation of the blur in pixels: the median of the corners'; 0 where there are none."""
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
        self._detector: Any = cv2.aruco.CharucoDetector(board.opencv, *_parameters())

    def find(self, image: Image, name: str = "", stamp_ns: int = 0) -> View:
        """The corners that are seen in an image, grey (H, W) or in colours (H, W, 3); there may be none."""
        image = to_grey(image)
        height, width = image.shape
        ids, corners = self._detect(image)
        axes = self._axes(ids, corners)
        if axes is None:
            return View(name, ids[:0], corners[:0], np.zeros(0), (width, height), stamp_ns=stamp_ns)
        gap = (self.board.square - self.board.marker) / 2
        saddles = find_saddles(image, Sites(corners, axes, gap, self.board.square))
        found = saddles.found
        blur = float(np.median(saddles.blurs[found])) if found.any() else 0.0
        return View(name, ids[found], saddles.places[found], saddles.sigmas[found], (width, height), blur, stamp_ns)

    def _detect(self, image: Image) -> tuple[NDArray[np.intp], Floats]:
        """Numbers (N,), rising, and corners (N, 2) as OpenCV finds them."""
        corners, ids, _, _ = self._detector.detectBoard(image)
        if ids is None:
            return np.zeros(0, np.intp), np.zeros((0, 2))
        # (N, 1, 2) and (N, 1) in OpenCV 4, (N, 2) and (N,) in 5
        found, places = np.reshape(ids, -1).astype(np.intp), np.reshape(corners, (-1, 2)).astype(float) - OFFSET
        order = np.argsort(found)
        return found[order], places[order]

    def _axes(self, ids: NDArray[np.intp], corners: Floats) -> Floats | None:
        """The derivative (N, 2, 2) of the pixels by the board's x and y at each corner; None of too few corners."""
        if len(ids) < 4:
            return None
        points = self.board.points[ids, :2]
        homography, _ = cv2.findHomography(points, corners, cv2.RANSAC, _STRAY)
        if homography is None:
            return None
        lifted = np.column_stack([points, np.ones(len(points))]) @ homography.T
        places = lifted[:, :2] / lifted[:, 2:]
        slope: Floats = (homography[:2, :2] - places[:, :, None] * homography[2, :2]) / lifted[:, 2, None, None]
        return slope


def _parameters() -> tuple[Any, Any]:
    """Of OpenCV's detector: of boards far away, they find half as many corners again as the defaults."""
    charuco, markers = cv2.aruco.CharucoParameters(), cv2.aruco.DetectorParameters()
    charuco.tryRefineMarkers = True  # looks again where the board says that markers must be
    markers.perspectiveRemovePixelPerCell = CELL
    return charuco, markers
