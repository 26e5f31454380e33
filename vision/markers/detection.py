"""Detection of markers: in the whole frame, in the whole frame at half resolution, or in a part of the frame.

The corners have the accuracy of OpenCV's detector without refinement, which is about a pixel; the module `edges` makes
them more accurate. Without refinement, OpenCV 4.11 and 5.0 agree that integer coordinates are the centres of pixels; a
test checks this. With the refinement APRILTAG, the corners of 5.0 are shifted by half a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.markers.marker_set import MarkerSet
from roverlink.vision.opencv import cv2

Image = NDArray[np.uint8]

CELL = 8
"""Side in pixels to which OpenCV resamples each black or white cell of a marker before it reads the cell.

With OpenCV's default of 4, it misses markers below 30 pixels.
"""
# Time of OpenCV's detector on one thread, for a textured scene with 4 markers: 54 to 98 ms for a frame of 1080p, 15 to
# 43 at half resolution, 1 to 2 for a region of 200x200 pixels. useAruco3Detection is about as fast as half resolution,
# but loses markers of 40 pixels at 720p and of 60 at 1080p. APRILTAG refinement takes half a second.
_WINDOWS = (7, 23, 16)
"""Adaptive threshold at full resolution: smallest window, largest window, and step in pixels."""
_HALF_WINDOWS = (5, 13, 8)
_WINDOW = (15, 15, 2)
"""Adaptive threshold in a region: one window is usually enough; if not, `_WINDOWS` are tried."""
_SMALLEST_SIDE = 9
"""Side in pixels of the smallest marker that can be read."""
_STEP = 64
"""Step in pixels to which the sizes of regions are rounded up, so that regions of similar size share a detector."""


@dataclass(frozen=True, slots=True, eq=False)
class Detection:
    """Detected marker: its number, and its corners (4, 2) in pixels, in OpenCV's order."""

    number: int
    corners: Floats


@dataclass(frozen=True, slots=True)
class Region:
    """Rectangular part of an image in pixels; `right` and `bottom` are the first column and row outside."""

    left: int
    top: int
    right: int
    bottom: int


def to_grey(image: Image) -> Image:
    """Convert an image, grey (H, W) or BGR (H, W, 3), to a grey image (H, W)."""
    return np.ascontiguousarray(image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))


def to_colour(image: Image) -> Image:
    """Convert an image, grey (H, W) or BGR (H, W, 3), to a BGR image (H, W, 3), which is a copy."""
    colour: Image = image.copy() if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    return colour


class Detector:
    """Finds markers in images with OpenCV's detector, with different parameters for each kind of search."""

    def __init__(self, markers: MarkerSet) -> None:
        self._markers = markers
        self._detectors: dict[tuple[tuple[int, int, int], int], Any] = {}

    def scan(self, image: Image) -> list[Detection]:
        """Return the markers in a whole grey image (H, W)."""
        return self._detect(image, _WINDOWS)

    def scan_half(self, image: Image) -> list[Detection]:
        """Return the markers in a whole grey image, searched at half resolution.

        This takes a quarter of the time, but does not find markers that are less than 25 pixels wide.
        """
        height, width = image.shape
        half = cv2.resize(
            image[: height // 2 * 2, : width // 2 * 2], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA
        )
        # the first pixel of the half image has its centre between four pixels, at (0.5, 0.5)
        found = self._detect(half, _HALF_WINDOWS)
        return [Detection(one.number, one.corners * 2 + 0.5) for one in found]

    def look(self, image: Image, region: Region) -> list[Detection]:
        """Return the markers in a part of a grey image (H, W); their corners are in pixels of the whole image."""
        part = np.ascontiguousarray(image[region.top : region.bottom, region.left : region.right])
        offset = (region.left, region.top)
        found = self._detect(part, _WINDOW) or self._detect(part, _WINDOWS)
        return [Detection(one.number, one.corners + offset) for one in found]

    def _detect(self, image: Image, windows: tuple[int, int, int]) -> list[Detection]:
        height, width = image.shape
        if min(height, width) < 2 * _SMALLEST_SIDE:
            return []
        # shapes differ between OpenCV versions: ids are (N, 1), (N,) or None
        corners, numbers, _ = self._detector(windows, max(height, width)).detectMarkers(image)
        found = [] if numbers is None else np.reshape(numbers, -1).tolist()
        return [
            Detection(number, np.reshape(corner, (4, 2)).astype(float))
            for number, corner in zip(found, corners)
            if number in self._markers
        ]

    def _detector(self, windows: tuple[int, int, int], longest: int) -> Any:
        longest = -(-longest // _STEP) * _STEP
        if (windows, longest) not in self._detectors:
            self._detectors[windows, longest] = cv2.aruco.ArucoDetector(
                self._markers.bits, _parameters(windows, longest)
            )
        return self._detectors[windows, longest]


def _parameters(windows: tuple[int, int, int], longest: int) -> Any:
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMin = windows[0]
    parameters.adaptiveThreshWinSizeMax = windows[1]
    parameters.adaptiveThreshWinSizeStep = windows[2]
    parameters.perspectiveRemovePixelPerCell = CELL
    # OpenCV wants the perimeter relative to the longer side of the image.
    parameters.minMarkerPerimeterRate = 4 * _SMALLEST_SIDE / longest
    return parameters
