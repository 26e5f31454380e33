"""ChArUco boards: chessboards with a marker in each white square, so that each corner can be identified."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.board import Artwork, Finder, PrintedMarker, millimetres, nothing_found
from roverkit.calibration.checkered_board import CheckeredBoard
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import CELL, Image
from roverkit.vision.markers.marker_set import black_modules
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError, nearest

MARKER = 0.018
"""Default side of a marker in metres."""
# Few and coarse modules: the board's markers are small, and 50 are enough for 100 squares.
DICTIONARY = "DICT_4X4_50"
"""Default dictionary of the board's markers, by OpenCV's name.

It differs from the default dictionary of the markers on the field, because both may be visible in the same image.
"""
OFFSET = 0.495 if int(cv2.__version__.split(".")[0]) < 5 else 0.0
"""Error of OpenCV's ChArUco corners, to the right and down, in pixels; measured in `tests/vision/test_views.py`."""


@dataclass(frozen=True, slots=True, eq=False)
class CharucoBoard(CheckeredBoard):
    """ChArUco board of `columns` x `rows` squares. Raises `SetupError` for an impossible board.

    `square` and `marker` are the sides of a square and of a marker in metres. `dictionary` is OpenCV's name of the
    dictionary of the markers, such as ``DICT_4X4_50``. Set `legacy` for a board with an even number of rows that was
    made with OpenCV before 4.6.
    """

    marker: float = MARKER
    dictionary: str = DICTIONARY
    legacy: bool = False
    _opencv: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if min(self.columns, self.rows) < 3:
            raise SetupError(f"a board of {self.columns}x{self.rows} squares is too small; it needs at least 3x3")
        if not 0 < self.marker < self.square < math.inf:
            raise SetupError(
                f"markers of {self.marker} m do not fit squares of {self.square} m: a marker must be smaller than a "
                "square"
            )
        known = [name for name in dir(cv2.aruco) if name.startswith("DICT_")]
        if self.dictionary not in known:
            raise SetupError(f"unknown dictionary {self.dictionary!r}; {nearest(self.dictionary, known)}")
        bits = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, self.dictionary))
        there, needed = len(bits.bytesList), self.columns * self.rows // 2
        if there < needed:
            raise SetupError(
                f"{self.dictionary} has only {there} markers, but {self.columns}x{self.rows} squares need {needed}; "
                "use a larger dictionary or fewer squares"
            )
        board = cv2.aruco.CharucoBoard((self.columns, self.rows), self.square, self.marker, bits)
        # OpenCV 4.6 changed the pattern of boards with an even number of rows.
        board.setLegacyPattern(self.legacy)
        object.__setattr__(self, "_opencv", board)

    @property
    def opencv(self) -> Any:
        """Same board as an OpenCV object, `cv2.aruco.CharucoBoard`."""
        return self._opencv

    @property
    def description(self) -> str:
        """Kind and sizes of the board in words, without an article."""
        return (
            f"{self.columns} x {self.rows} squares of {millimetres(self.square)}, markers of "
            f"{millimetres(self.marker)}, {self.dictionary}{', legacy' if self.legacy else ''}"
        )

    @property
    def gap(self) -> float:
        """Distance in metres from a corner to the nearest marker, along both axes."""
        return (self.square - self.marker) / 2

    @property
    def artwork(self) -> Artwork:
        """Black parts of the board; a square without a marker is black."""
        markers, white = [], set()
        for number, corners in zip(np.ravel(self._opencv.getIds()).tolist(), self._opencv.getObjPoints()):
            left, top = np.reshape(corners, (4, 3))[:, :2].astype(float).min(axis=0).tolist()
            column, row = int(left / self.square), int(top / self.square)
            white.add((column, row))
            place = column * self.square + self.gap, row * self.square + self.gap
            markers.append(PrintedMarker(*place, black_modules(self._opencv.getDictionary(), number)))
        squares = (
            (column * self.square, row * self.square)
            for column, row in itertools.product(range(self.columns), range(self.rows))
            if (column, row) not in white
        )
        return Artwork(tuple(squares), self.square, tuple(markers), self.marker)

    def finder(self) -> Finder:
        """Return a function that finds the board's corners in an image."""
        detector: Any = cv2.aruco.CharucoDetector(self._opencv, *_parameters())

        def find(image: Image) -> tuple[NDArray[np.intp], Floats]:
            corners, ids, _, _ = detector.detectBoard(image)
            if ids is None:
                return nothing_found()
            # (N, 1, 2) and (N, 1) in OpenCV 4, (N, 2) and (N,) in 5
            found, places = np.reshape(ids, -1).astype(np.intp), np.reshape(corners, (-1, 2)).astype(float) - OFFSET
            order = np.argsort(found)
            return found[order], places[order]

        return find


def _parameters() -> tuple[Any, Any]:
    """Return parameters for OpenCV's detector.

    With them it finds 1.5 times as many corners of distant boards as by default.
    """
    charuco, markers = cv2.aruco.CharucoParameters(), cv2.aruco.DetectorParameters()
    charuco.tryRefineMarkers = True  # searches again at positions where the board must have markers
    markers.perspectiveRemovePixelPerCell = CELL
    return charuco, markers
