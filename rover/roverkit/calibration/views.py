"""Views of a board: the pixel positions of its corners in an image."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.edge_curvature import edge_curvatures
from roverkit.calibration.saddles import Saddles, Sites, find_saddles
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import Image, to_grey
from roverkit.vision.opencv import cv2
from roverlink.numerals import counted

FEWEST_CORNERS = 8
"""Least number of corners of a usable view; with fewer, errors of the view cannot be detected."""

_FLAT = 0.05
"""Ratio of the corners' spread across a line to that along it, below which the corners count as collinear."""
_STRAY = 5.0
"""Largest distance in pixels between a corner and its place by the homography of the board (RANSAC threshold)."""
_ELSEWHERE = 1.0
"""Median of this distance, in distances of neighbouring corners, above which this is another board.

Lenses move corners from where the homography has them by less, and the numbering of another board by more.
"""


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Corners of a board in one image. Integer pixel coordinates are the centres of pixels."""

    name: str
    """Name in reports: the image's file, or the time of the frame."""
    ids: NDArray[np.intp]
    """Ids (N,) of the corners, ascending: indices of `CalibrationBoard.points`."""
    corners: Floats
    """Positions (N, 2) of the corners in pixels."""
    sigmas: Floats
    """Standard deviation (N,) of a corner's coordinate in pixels, from the image noise alone."""
    size: tuple[int, int]
    """Width and height of the image."""
    blur: float = 0.0
    """Standard deviation of the blur in pixels: median over the corners; 0 without corners."""
    stamp_ns: int = 0
    """Time of the image in nanoseconds since 1970; 0 if unknown."""

    @property
    def flaw(self) -> str:
        """Reason why the view is unusable; empty if it is usable."""
        if not self.ids.size:
            return "no board found"
        if self.ids.size < FEWEST_CORNERS:
            return f"{counted(self.ids.size, 'corner')} found, but {FEWEST_CORNERS} are needed"
        spread = np.linalg.svd(self.corners - self.corners.mean(axis=0), compute_uv=False)
        return "all corners are on one line" if spread[1] < _FLAT * spread[0] else ""


class BoardDetector:
    """Detector of the corners of a board in images."""

    def __init__(self, board: CalibrationBoard) -> None:
        self.board = board
        self._find = board.finder()

    def find(self, image: Image, name: str = "", stamp_ns: int = 0) -> View:
        """Return the view with the corners in an image, grey (H, W) or BGR (H, W, 3); it may have no corners."""
        image = to_grey(image)
        height, width = image.shape
        # OpenCV identifies the corners; only their positions are fitted again.
        ids, corners = self._find(image)
        axes = self._axes(ids, corners)
        if axes is None:
            return View(name, ids[:0], corners[:0], np.zeros(0), (width, height), stamp_ns=stamp_ns)
        saddles = self._fit(image, ids, Sites(corners, axes, self.board.gap, self.board.reach))
        found = saddles.found
        blur = float(np.median(saddles.blurs[found])) if found.any() else 0.0
        return View(name, ids[found], saddles.places[found], saddles.sigmas[found], (width, height), blur, stamp_ns)

    def _fit(self, image: Image, ids: NDArray[np.intp], sites: Sites) -> Saddles:
        """Fit the corners with straight edges, and again with the curvature of the edges that follows."""
        first = find_saddles(image, sites)
        found = first.found
        curvatures = np.zeros((len(ids), 2, 2))
        curvatures[found] = edge_curvatures(self.board.points[ids[found], :2], first.places[found])
        if not curvatures.any():
            return first
        starts = np.where(found[:, None], first.places, sites.places)
        return find_saddles(image, replace(sites, places=starts, curvatures=curvatures))

    def _axes(self, ids: NDArray[np.intp], corners: Floats) -> Floats | None:
        """Return the derivative (N, 2, 2) of the pixels of the corners with respect to the board's x and y.

        The derivative gives the directions of the edges at each corner. Returns None if there are too few corners, or
        if they do not lie as on the board.
        """
        if len(ids) < 4:
            return None
        points = self.board.points[ids, :2]
        # A homography and not the lens model, which is not known yet: within one board, it is off by some pixels at
        # most, and only the directions of the edges are taken from it.
        homography, _ = cv2.findHomography(points, corners, cv2.RANSAC, _STRAY)
        if homography is None:
            return None
        lifted = np.column_stack([points, np.ones(len(points))]) @ homography.T
        places = lifted[:, :2] / lifted[:, 2:]
        slope: Floats = (homography[:2, :2] - places[:, :, None] * homography[2, :2]) / lifted[:, 2, None, None]
        apart = np.sqrt(np.abs(np.linalg.det(slope)) * math.prod(self.board.size) / len(self.board.points))
        missed = np.linalg.norm(places - corners, axis=1) / apart
        return slope if np.median(missed) < _ELSEWHERE else None
