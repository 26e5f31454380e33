"""Detection of markers: in the whole frame, thoroughly or quickly, or in a part of the frame.

The corners have the accuracy of OpenCV's detector without refinement, which is about a pixel; the module `edges` makes
them more accurate. Without refinement, OpenCV 4.11 and 5.0 agree that integer coordinates are the centres of pixels; a
test checks this. With the refinement APRILTAG, the corners of 5.0 are shifted by half a pixel.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.markers.square_reading import SquareReader
from roverkit.vision.opencv import cv2

Image = NDArray[np.uint8]

SMALLEST_SIDE = 9
"""Side in pixels of the smallest marker that can be read."""
_APART = 0.02
"""Distance between the corners of two squares, relative to their perimeter, below which OpenCV takes them for one.

By default, it returns only one of a marker and the paper around it if it can read neither.
"""
_CORRECTED = 0.6
"""Share of the wrong cells that a dictionary can correct, which OpenCV corrects by default."""
_STEP = 64
"""Step in pixels to which the sizes of regions are rounded up, so that regions of similar size share a detector."""


@dataclass(frozen=True, slots=True, eq=False)
class MarkerDetection:
    """Detected marker: its number, and its corners (4, 2) in pixels, in OpenCV's order."""

    number: int
    corners: Floats
    doubtful: bool = False
    """True if so many cells were wrong that squares that are no markers can look the same."""


@dataclass(frozen=True, slots=True)
class Region:
    """Rectangular part of an image in pixels; `right` and `bottom` are the first column and row outside."""

    left: int
    top: int
    right: int
    bottom: int


@dataclass(frozen=True, slots=True)
class _Search:
    """Way to search an image.

    A pixel is black if it is darker than the mean of a window around it by `contrast` levels. OpenCV tries each of the
    windows from `smallest` to `largest` pixels in steps of `step`. Each black or white cell of a marker is resampled to
    `cell` x `cell` pixels before it is read.
    """

    contrast: int
    smallest: int
    largest: int
    step: int
    cell: int


CELL = 8
"""Side in pixels to which OpenCV resamples each black or white cell of a marker before it reads the cell.

With OpenCV's default of 4, cells of markers below 30 pixels are often misread.
"""
_WHOLE_CELL = 5
"""As `CELL`, for partly covered markers: from 8 pixels on, OpenCV does not read the rim of a cell.

Without the rim, a third of the markers of 96 pixels that are crossed by thin bars are not found.
"""
# CPU time of OpenCV's detector for a textured scene of 720p: 15 to 18 ms with `_THOROUGH`, 2 with `_SHARP`, 5 with
# `_BLURRED`. It spends most of its time on the contours of noise, and a larger contrast leaves fewer of them. At half
# resolution with a contrast of 7, it takes 6 ms and misses most markers below 25 pixels.
_THOROUGH = _Search(7, 3, 23, 10, _WHOLE_CELL)
"""The threshold is OpenCV's default."""
_SHARP = _Search(15, 5, 5, 2, CELL)
"""Finds sharp markers of all sizes whose white and black differ by 60 grey levels or more."""
_BLURRED = _Search(7, 23, 23, 2, _WHOLE_CELL)
"""Finds markers that are blurred, partly covered or of less contrast, in an image that is smoothed against noise."""
_LARGE = _Search(7, 33, 33, 2, CELL)
"""Finds markers, in an image of half the size, whose border is wider than the windows of `_THOROUGH`.

Within the border, a pixel is then not darker than the mean around it, and what covers the interior opens the outline.
"""
_REGION = _Search(7, 15, 15, 2, CELL)
"""Enough for most regions; if nothing is found, `_THOROUGH` is tried."""


def to_grey(image: Image) -> Image:
    """Convert an image, grey (H, W) or BGR (H, W, 3), to a grey image (H, W)."""
    return np.ascontiguousarray(image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))


def to_colour(image: Image) -> Image:
    """Convert an image, grey (H, W) or BGR (H, W, 3), to a BGR image (H, W, 3), which is a copy."""
    colour: Image = image.copy() if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    return colour


class Detector:
    """Finds markers in images with OpenCV's detector, with different parameters for each kind of search."""

    def __init__(self, markers: MarkerSet, *, exact: bool = False) -> None:
        """Find these markers; with `exact`, only those without a wrong cell."""
        self._markers = markers
        self._exact = exact
        self._correctable = int(_CORRECTED * markers.bits.maxCorrectionBits)
        self._reader = SquareReader(markers.white, exact=exact)
        self._detectors: dict[tuple[_Search, int], Any] = {}

    def scan(self, image: Image) -> list[MarkerDetection]:
        """Return the markers in a whole grey image (H, W); a marker may be returned twice."""
        return self._detect(image, _THOROUGH) + self._detect_large(image)

    def scan_quickly(self, image: Image) -> list[MarkerDetection]:
        """Return the markers in a whole grey image, in a third of the time; a marker may be returned twice.

        It misses some that are partly covered or of little contrast.
        """
        return self._detect(image, _SHARP) + self._detect(cv2.GaussianBlur(image, (3, 3), 0), _BLURRED)

    def scan_region(self, image: Image, region: Region) -> list[MarkerDetection]:
        """Return the markers in a part of a grey image (H, W); their corners are in pixels of the whole image."""
        part = np.ascontiguousarray(image[region.top : region.bottom, region.left : region.right])
        offset = (region.left, region.top)
        found = self._detect(part, _REGION) or self._detect(part, _THOROUGH)
        return [replace(marker, corners=marker.corners + offset) for marker in found]

    def _detect(self, image: Image, search: _Search) -> list[MarkerDetection]:
        height, width = image.shape
        if min(height, width) < 2 * SMALLEST_SIDE:
            return []
        # shapes differ between OpenCV versions: ids are (N, 1), (N,) or None
        corners, numbers, unread = self._detector(search, max(height, width)).detectMarkers(image)
        found = [] if numbers is None else np.reshape(numbers, -1).tolist()
        seen = [
            MarkerDetection(number, np.reshape(corner, (4, 2)).astype(float)) for number, corner in zip(found, corners)
        ]
        read = self._reader.read(image, unread)
        seen += [MarkerDetection(number, corner, wrong > self._correctable) for number, corner, wrong in read]
        return [one for one in seen if one.number in self._markers]

    def _detect_large(self, image: Image) -> list[MarkerDetection]:
        """Return the large markers in an image, from one of half the size."""
        height, width = (pixels // 2 for pixels in image.shape)
        if not (height and width):
            return []
        half = cv2.resize(image[: 2 * height, : 2 * width], (width, height), interpolation=cv2.INTER_AREA)
        # the first pixel of the smaller image has its centre between the first two pixels of each row
        return [replace(one, corners=2 * one.corners + 0.5) for one in self._detect(half, _LARGE)]

    def _detector(self, search: _Search, longest: int) -> Any:
        longest = -(-longest // _STEP) * _STEP
        if (search, longest) not in self._detectors:
            self._detectors[search, longest] = cv2.aruco.ArucoDetector(
                self._markers.bits, _parameters(search, longest, exact=self._exact)
            )
        return self._detectors[search, longest]


def _parameters(search: _Search, longest: int, *, exact: bool) -> Any:
    parameters = cv2.aruco.DetectorParameters()
    if exact:
        parameters.errorCorrectionRate = 0.0
    parameters.adaptiveThreshConstant = search.contrast
    parameters.adaptiveThreshWinSizeMin = search.smallest
    parameters.adaptiveThreshWinSizeMax = search.largest
    parameters.adaptiveThreshWinSizeStep = search.step
    parameters.perspectiveRemovePixelPerCell = search.cell
    parameters.minMarkerDistanceRate = _APART
    # OpenCV wants the perimeter relative to the longer side of the image.
    parameters.minMarkerPerimeterRate = 4 * SMALLEST_SIDE / longest
    return parameters
