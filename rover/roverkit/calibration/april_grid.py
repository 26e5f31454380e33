"""AprilGrids of Kalibr: rows of AprilTags of the family 36h11, with small black squares between their corners.

The tags are numbered row by row from the lower left, as `kalibr_create_target_pdf` draws them. Their black border is
two modules (cells) wide. The black squares make each corner of a tag a crossing of two edges.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.board import (
    Artwork,
    CalibrationBoard,
    Finder,
    PrintedMarker,
    millimetres,
    nothing_found,
)
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import CELL, Image, MarkerDetection
from roverkit.vision.markers.marker_set import black_modules
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError

COLUMNS, ROWS = 6, 6
TAG, SPACING = 0.022, 0.3
"""Default side of a tag in metres, with which 6x6 tags fit on A4, and Kalibr's default spacing."""
_FAMILY = cv2.aruco.DICT_APRILTAG_36h11
_BORDER = 2
"""Width of a tag's black border in modules."""
_WINDOW = 0.5
"""Half the side of the window in which a corner is searched, divided by the side of a black square."""
_SUBPIX = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 30, 0.01)


@dataclass(frozen=True, slots=True, eq=False)
class AprilGrid(CalibrationBoard):
    """AprilGrid of `columns` x `rows` tags. Raises `SetupError` for an impossible board.

    `tag` is the side of a tag in metres. `spacing` is the distance between two tags, divided by the side of a tag:
    Kalibr's ``tagSpacing``.
    """

    columns: int = COLUMNS
    rows: int = ROWS
    tag: float = TAG
    spacing: float = SPACING

    def __post_init__(self) -> None:
        there = len(_tags().bytesList)
        if min(self.columns, self.rows) < 2:
            raise SetupError(f"an AprilGrid of {self.columns}x{self.rows} tags is too small; it needs at least 2x2")
        if self.columns * self.rows > there:
            raise SetupError(f"an AprilGrid of {self.columns}x{self.rows} tags is too large; only {there} tags exist")
        if not 0 < self.tag < math.inf:
            raise SetupError(f"the side of a tag is {self.tag} m; it must be positive and finite")
        if not 0 < self.spacing <= 1:
            raise SetupError(
                f"the spacing is {self.spacing}; it is the distance between two tags divided by the side of a tag, "
                "and must be above 0 and at most 1"
            )

    @property
    def description(self) -> str:
        """Kind and sizes of the board in words, without an article."""
        return f"AprilGrid of {self.columns} x {self.rows} tags of {millimetres(self.tag)}, spacing {self.spacing:g}"

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the board with its outer black squares, in metres."""
        return self.columns * self._pitch + self._square, self.rows * self._pitch + self._square

    @property
    def points(self) -> Floats:
        """Corners (N, 3) of the tags in the board's frame in metres: rows of corners, from the upper left."""
        # Along an axis, the corners are at both ends of each tag.
        x, y = (
            self._square + (np.arange(2 * count) // 2) * self._pitch + (np.arange(2 * count) % 2) * self.tag
            for count in (self.columns, self.rows)
        )
        across, down = np.meshgrid(x, y)
        return np.column_stack([across.ravel(), down.ravel(), np.zeros(across.size)])

    @property
    def gap(self) -> float:
        """Distance in metres from a corner to the code inside its tag, along both axes."""
        return self.tag * _BORDER / (int(_tags().markerSize) + 2 * _BORDER)

    @property
    def reach(self) -> float:
        """Distance in metres from a corner, along its edges, up to which the edges are straight and uncrossed."""
        return self._square

    @property
    def artwork(self) -> Artwork:
        """Black parts of the board."""
        places = itertools.product(range(self.columns + 1), range(self.rows + 1))
        squares = tuple((column * self._pitch, row * self._pitch) for column, row in places)
        markers = []
        for number in range(self.columns * self.rows):
            column, row = self._place(number)
            # OpenCV's tags are turned by half a turn against those of Kalibr.
            black = black_modules(_tags(), number, _BORDER)[::-1, ::-1]
            left, top = (self._square + index * self._pitch for index in (column, row))
            markers.append(PrintedMarker(left, top, black))
        return Artwork(squares, self._square, tuple(markers), self.tag)

    def finder(self) -> Finder:
        """Return a function that finds the corners of the tags in an image."""

        def find(image: Image) -> tuple[NDArray[np.intp], Floats]:
            found: dict[int, Floats] = {}
            for tag in find_tags(image):
                if tag.number < self.columns * self.rows:
                    found |= dict(zip(self._corner_ids(tag.number), self._refined(image, tag.corners)))
            if not found:
                return nothing_found()
            order = sorted(found)
            return np.array(order, np.intp), np.array([found[number] for number in order])

        return find

    @property
    def _square(self) -> float:
        """Side of a small black square, which is the distance between two tags."""
        return self.spacing * self.tag

    @property
    def _pitch(self) -> float:
        return self.tag + self._square

    def _refined(self, image: Image, corners: Floats) -> Floats:
        """Return better positions of the corners (4, 2) of a tag.

        The detector takes parts of the black squares for parts of the tag, so its corners may be off by five pixels.
        """
        side = float(np.min(np.linalg.norm(np.roll(corners, 1, axis=0) - corners, axis=1)))
        window = max(2, round(_WINDOW * self.spacing * side))
        start = np.array(corners, np.float32).reshape(4, 1, 2)
        places = cv2.cornerSubPix(image, start, (window, window), (-1, -1), _SUBPIX)
        return np.reshape(places, (4, 2)).astype(float)

    def _place(self, number: int) -> tuple[int, int]:
        """Return the column and row of a tag, from the upper left."""
        from_below, column = divmod(number, self.columns)
        return column, self.rows - 1 - from_below

    def _corner_ids(self, number: int) -> tuple[int, int, int, int]:
        """Return the ids of a tag's corners in OpenCV's order: the first is the lower right corner of the print."""
        column, row = self._place(number)
        across = 2 * self.columns
        upper = 2 * row * across + 2 * column
        lower = upper + across
        return lower + 1, lower, upper, upper + 1


def find_tags(image: Image) -> list[MarkerDetection]:
    """Return the tags of any AprilGrid in a grey image (H, W); their corners may be off by five pixels."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.markerBorderBits = _BORDER
    parameters.perspectiveRemovePixelPerCell = CELL
    detector: Any = cv2.aruco.ArucoDetector(_tags(), parameters)
    corners, ids, _ = detector.detectMarkers(image)
    numbers = [] if ids is None else np.ravel(ids).tolist()
    return [MarkerDetection(number, np.reshape(place, (4, 2))) for number, place in zip(numbers, corners)]


def _tags() -> Any:
    return cv2.aruco.getPredefinedDictionary(_FAMILY)
