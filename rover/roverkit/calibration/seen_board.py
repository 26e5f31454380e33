"""Search for the board that images show, if it is not the one that the user has described.

A wrong dictionary or number of squares gives no corners at all, or few and wrong ones; without help, the user takes
more and more images. The numbers of the markers and their places tell how many columns the board has.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import numpy as np

from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.charuco_board import CharucoBoard
from roverkit.calibration.start import GUESS, ideal_camera
from roverkit.calibration.views import View
from roverkit.vision.markers.detection import Detector, Image, MarkerDetection, to_grey
from roverkit.vision.markers.dictionaries import other_dictionary
from roverkit.vision.markers.marker_fits import extent
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.opencv import cv2

_COLUMNS = range(3, 31)
_FEWEST = 6
"""Least number of markers that determine the columns of a board."""
_NEAR = 0.25
"""Largest median distance between the markers and their places on a board, relative to the side of a marker."""
_FEW = 1 / 3
"""Share of a board's corners below which a view is suspicious."""


class SeenBoards:
    """Tells the user once which board the images show, if it is another one."""

    def __init__(self, board: CalibrationBoard, say: Callable[[str], None]) -> None:
        self._board, self._say = board, say
        self._suspicious = 0
        self._done = False

    def look(self, image: Image, view: View) -> None:
        """Examine an image in which few corners of the board were found, such as the 1st, 2nd, 4th, 8th and so on."""
        if len(view.ids) >= _FEW * len(self._board.points):
            self._done = True
        if self._done:
            return
        self._suspicious += 1
        if self._suspicious.bit_count() == 1 and (found := other_board(image, self._board)):
            self._done = True
            self._say(f"{view.name}: the board is not the one that you have described: the image shows {found}")


def other_board(image: Image, board: CalibrationBoard) -> str:
    """Describe the ChArUco board in an image, (H, W) or (H, W, 3); the text is empty for none, and for `board`."""
    grey = to_grey(image)
    height, width = grey.shape
    given = board.dictionary if isinstance(board, CharucoBoard) else ""
    found = _distinct(Detector(MarkerSet(given)).scan(grey)) if given else []
    dictionary = given
    if len(found) < _FEWEST:
        other = other_dictionary(
            grey, ideal_camera(GUESS * width, (width, height)), MarkerSet(given) if given else None
        )
        if other is None or len(other[1]) < _FEWEST:
            return ""
        dictionary = other[0]
        found = [one for one in _distinct(Detector(MarkerSet(dictionary)).scan(grey)) if one.number in other[1]]
    layout = _layout(found)
    if layout is None:
        return f"markers of {dictionary}" if dictionary != given else ""
    columns, legacy = layout
    rows = -(-2 * (max(one.number for one in found) + 1) // columns)
    if (
        isinstance(board, CharucoBoard)
        and (dictionary, columns) == (given, board.columns)
        and rows <= board.rows
        and (legacy == board.legacy or board.rows % 2)
    ):
        return ""
    options = f"--board charuco --dictionary {dictionary} --squares {columns}x{rows}{' --legacy' if legacy else ''}"
    return f"a ChArUco board with {columns} squares in a row, and at least {rows} rows; use {options}"


def _distinct(found: list[MarkerDetection]) -> list[MarkerDetection]:
    """Return one detection of each number; numbers that several markers have are left out."""
    kept = []
    for _, same in itertools.groupby(sorted(found, key=lambda one: one.number), key=lambda one: one.number):
        detections = list(same)
        apart = max(
            float(np.abs(one.corners.mean(axis=0) - detections[0].corners.mean(axis=0)).max()) for one in detections
        )
        if apart < extent(detections[0].corners) / 2:
            kept.append(detections[0])
    return kept


def _layout(found: list[MarkerDetection]) -> tuple[int, bool] | None:
    """Return the columns of the ChArUco board on which markers lie as in the image, and true if it is a legacy one."""
    if len(found) < _FEWEST:
        return None
    centres = np.array([one.corners.mean(axis=0) for one in found])
    side = float(np.median([extent(one.corners) for one in found]))
    best: tuple[float, int, bool] | None = None
    for columns, legacy in itertools.product(_COLUMNS, (False, True)):
        places = np.array([_place(one.number, columns, legacy=legacy) for one in found], dtype=float)
        if np.linalg.matrix_rank(places - places.mean(axis=0)) < 2:
            continue
        # The markers of two neighbouring squares touch at a corner: a marker is about as wide as the distance.
        homography, _ = cv2.findHomography(places, centres, cv2.RANSAC, side / 4)
        if homography is None:
            continue
        missed = cv2.perspectiveTransform(places[:, None], homography)[:, 0] - centres
        median = float(np.median(np.linalg.norm(missed, axis=1)))
        if best is None or median < best[0]:
            best = median, columns, legacy
    return best[1:] if best and best[0] < _NEAR * side else None


def _place(number: int, columns: int, *, legacy: bool) -> tuple[int, int]:
    """Return the column and row of a marker: the white squares are numbered row by row, and the first one is black."""
    return next(itertools.islice(_white_squares(columns, legacy=legacy), number, None))


def _white_squares(columns: int, *, legacy: bool) -> Iterator[tuple[int, int]]:
    for row in itertools.count():
        for column in range(columns):
            if (column + row) % 2 != legacy:
                yield column, row
