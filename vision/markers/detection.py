"""Finds markers: a scan of the whole frame, the same at half resolution, or a region of it.

The corners are as good as OpenCV finds them without refinement, about a pixel; `edges` makes them better. Without
refinement OpenCV 4.11 and 5.0 agree with the centres of pixels being integers (a test measures it); with refinement by
APRILTAG, 5.0 is half a pixel off.
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
"""Pixels to which OpenCV resamples a bit before it reads it; its 4 loses markers below 30 pixels."""
_WINDOWS = (7, 23, 16)
"""Smallest and largest window of the adaptive threshold, and the step between, at full resolution."""
_HALF_WINDOWS = (5, 13, 8)
_WINDOW = (15, 15, 2)
"""In a region, where one window mostly does; where it does not, the others are tried."""
_SMALLEST_SIDE = 9
"""Pixels; what is smaller cannot be read."""
_STEP = 64
"""Pixels to which the size of a region is rounded, so that regions of about one size share a detector."""


@dataclass(frozen=True, slots=True, eq=False)
class Detection:
    """A marker's number, and its corners (4, 2) in pixels, in OpenCV's order."""

    number: int
    corners: Floats


@dataclass(frozen=True, slots=True)
class Region:
    """A part of an image, in pixels: `right` and `bottom` are the first outside."""

    left: int
    top: int
    right: int
    bottom: int


def to_grey(image: Image) -> Image:
    """An image (H, W) or, blue green red, (H, W, 3) as one of grey (H, W)."""
    return np.ascontiguousarray(image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))


class Detector:
    """OpenCV's detector, set up for each way to look."""

    def __init__(self, markers: MarkerSet) -> None:
        self._markers = markers
        self._detectors: dict[tuple[tuple[int, int, int], int], Any] = {}

    def scan(self, image: Image) -> list[Detection]:
        """Look at a whole grey image (H, W)."""
        return self._detect(image, _WINDOWS)

    def scan_half(self, image: Image) -> list[Detection]:
        """Look at a whole image at half its resolution: a quarter of the time, and nothing below some 25 pixels."""
        height, width = image.shape
        half = cv2.resize(
            image[: height // 2 * 2, : width // 2 * 2], None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA
        )
        # the centre of the half image's first pixel is the corner between four pixels
        found = self._detect(half, _HALF_WINDOWS)
        return [Detection(one.number, one.corners * 2 + 0.5) for one in found]

    def look(self, image: Image, region: Region) -> list[Detection]:
        """Look at a region of an image."""
        part = np.ascontiguousarray(image[region.top : region.bottom, region.left : region.right])
        offset = (region.left, region.top)
        found = self._detect(part, _WINDOW) or self._detect(part, _WINDOWS)
        return [Detection(one.number, one.corners + offset) for one in found]

    def _detect(self, image: Image, windows: tuple[int, int, int]) -> list[Detection]:
        height, width = image.shape
        if min(height, width) < 2 * _SMALLEST_SIDE:
            return []
        # every version has (N, 1, 4, 2) corners in one shape or another, and ids (N, 1) or (N,) or None
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
    parameters.minMarkerPerimeterRate = 4 * _SMALLEST_SIDE / longest
    return parameters
