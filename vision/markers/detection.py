"""Detection of markers: in the whole frame, thoroughly or quickly, or in a part of the frame.

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

CELL = 5
"""Side in pixels to which OpenCV resamples each black or white cell of a marker before it reads the cell.

With OpenCV's default of 4, it misses small markers. From 8 on, it does not read the rim of a cell, and misses a third
of the markers of 96 pixels that are crossed by thin bars.
"""
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


@dataclass(frozen=True, slots=True)
class _Threshold:
    """Adaptive threshold: a pixel is black if it is darker than the mean of a window around it by `contrast` levels.

    OpenCV tries each of the windows from `smallest` to `largest` pixels in steps of `step`.
    """

    contrast: int
    smallest: int
    largest: int
    step: int


# CPU time of OpenCV's detector for a textured scene of 720p: 15 to 18 ms with `_THOROUGH`, 3 to 5 ms with one of
# `_QUICK`. It spends most of its time on the contours of noise, and a larger contrast leaves fewer of them. At half
# resolution with a small contrast, it takes 6 ms and misses most markers below 25 pixels.
_THOROUGH = _Threshold(7, 3, 23, 10)
"""OpenCV's default."""
_QUICK = tuple(_Threshold(15, window, window, 2) for window in (7, 23))
"""Thresholds of successive quick scans: small markers need the first one, large and blurred ones the second one.

Markers whose white and black differ by less than about 60 grey levels need a thorough scan.
"""
_REGION = _Threshold(7, 15, 15, 2)
"""Threshold in a region: it is usually enough; if not, `_THOROUGH` is tried."""


def to_grey(image: Image) -> Image:
    """Convert an image, grey (H, W) or BGR (H, W, 3), to a grey image (H, W)."""
    return np.ascontiguousarray(image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))


class Detector:
    """Finds markers in images with OpenCV's detector, with different parameters for each kind of search."""

    def __init__(self, markers: MarkerSet) -> None:
        self._markers = markers
        self._detectors: dict[tuple[_Threshold, int], Any] = {}
        self._scans = 0

    def scan(self, image: Image) -> list[Detection]:
        """Return the markers in a whole grey image (H, W)."""
        return self._detect(image, _THOROUGH)

    def scan_quickly(self, image: Image) -> list[Detection]:
        """Return the markers of good contrast in a whole grey image, in a quarter of the time.

        Successive scans use different thresholds, because no single one finds all markers.
        """
        self._scans += 1
        return self._detect(image, _QUICK[self._scans % len(_QUICK)])

    def look(self, image: Image, region: Region) -> list[Detection]:
        """Return the markers in a part of a grey image (H, W); their corners are in pixels of the whole image."""
        part = np.ascontiguousarray(image[region.top : region.bottom, region.left : region.right])
        offset = (region.left, region.top)
        found = self._detect(part, _REGION) or self._detect(part, _THOROUGH)
        return [Detection(one.number, one.corners + offset) for one in found]

    def _detect(self, image: Image, threshold: _Threshold) -> list[Detection]:
        height, width = image.shape
        if min(height, width) < 2 * _SMALLEST_SIDE:
            return []
        # shapes differ between OpenCV versions: ids are (N, 1), (N,) or None
        corners, numbers, _ = self._detector(threshold, max(height, width)).detectMarkers(image)
        found = [] if numbers is None else np.reshape(numbers, -1).tolist()
        return [
            Detection(number, np.reshape(corner, (4, 2)).astype(float))
            for number, corner in zip(found, corners)
            if number in self._markers
        ]

    def _detector(self, threshold: _Threshold, longest: int) -> Any:
        longest = -(-longest // _STEP) * _STEP
        if (threshold, longest) not in self._detectors:
            self._detectors[threshold, longest] = cv2.aruco.ArucoDetector(
                self._markers.bits, _parameters(threshold, longest)
            )
        return self._detectors[threshold, longest]


def _parameters(threshold: _Threshold, longest: int) -> Any:
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshConstant = threshold.contrast
    parameters.adaptiveThreshWinSizeMin = threshold.smallest
    parameters.adaptiveThreshWinSizeMax = threshold.largest
    parameters.adaptiveThreshWinSizeStep = threshold.step
    parameters.perspectiveRemovePixelPerCell = CELL
    # OpenCV wants the perimeter relative to the longer side of the image.
    parameters.minMarkerPerimeterRate = 4 * _SMALLEST_SIDE / longest
    return parameters
