"""Search for the board that images show, if it is not the one that the user has described.

A wrong dictionary or number of squares gives no corners at all, or few and wrong ones; without help, the user takes
more and more images. The numbers of the markers and their places tell how many columns the board has.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TypeVar

import numpy as np

from roverkit.calibration.april_grid import AprilGrid, find_tags
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.charuco_board import CharucoBoard
from roverkit.calibration.chessboard import Chessboard
from roverkit.calibration.start import GUESS, ideal_camera
from roverkit.calibration.views import View
from roverkit.vision.markers.detection import Detector, Image, MarkerDetection, to_grey
from roverkit.vision.markers.dictionaries import other_dictionary, smallest
from roverkit.vision.markers.marker_fits import extent
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.opencv import cv2

Way = TypeVar("Way")
Place = tuple[int, int]
"""Column and row on a board."""

_COLUMNS = range(2, 31)
_FEWEST = 6
"""Least number of markers that determine the columns of a board."""
_FEWEST_CORNERS = 4
"""Least number of inner corners in a row and in a column of a chessboard; fewer may be something else."""
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
    """Describe the board in an image, (H, W) or (H, W, 3); the text is empty for none, and for `board`."""
    grey = to_grey(image)
    for look in (_april_grid, _charuco_board, _chessboard):
        seen = look(grey, board)
        if seen is not None:
            return seen
    return ""


# Each function describes the board of its kind in a grey image. It returns None for none, and no text for `board`.


def _april_grid(grey: Image, board: CalibrationBoard) -> str | None:
    found = _distinct(find_tags(grey))
    if len(found) < _FEWEST:
        return None
    layout = _layout(found, [(columns, partial(_row_by_row, columns)) for columns in _COLUMNS])
    if layout is None:
        return "" if isinstance(board, AprilGrid) else "tags of an AprilGrid"
    columns, last = layout
    rows = -(-(last + 1) // columns)
    if isinstance(board, AprilGrid) and columns == board.columns and rows <= board.rows:
        return ""
    return (
        f"an AprilGrid with {columns} tags in a row, and at least {rows} rows; use --board aprilgrid --squares "
        f"{columns}x{rows}"
    )


def _charuco_board(grey: Image, board: CalibrationBoard) -> str | None:
    height, width = grey.shape
    given = board.dictionary if isinstance(board, CharucoBoard) else ""
    found = _distinct(Detector(MarkerSet(given)).scan(grey)) if given else []
    dictionary = given
    if len(found) < _FEWEST:
        other = other_dictionary(
            grey, ideal_camera(GUESS * width, (width, height)), MarkerSet(given) if given else None
        )
        if other is None or len(other[1]) < _FEWEST:
            return None
        dictionary = other[0]
        found = [one for one in _distinct(Detector(MarkerSet(dictionary)).scan(grey)) if one.number in other[1]]
    ways = itertools.product(_COLUMNS, (False, True))
    layout = _layout(
        found, [((columns, legacy), partial(_white_square, columns, legacy=legacy)) for columns, legacy in ways]
    )
    if layout is None:
        return f"markers of {dictionary}" if dictionary != given else None
    (columns, legacy), last = layout
    rows = -(-2 * (last + 1) // columns)
    if dictionary != given:
        dictionary = smallest(dictionary, last)
    if (
        isinstance(board, CharucoBoard)
        and (dictionary, columns) == (given, board.columns)
        and rows <= board.rows
        and (legacy == board.legacy or board.rows % 2)
    ):
        return ""
    options = f"--board charuco --dictionary {dictionary} --squares {columns}x{rows}{' --legacy' if legacy else ''}"
    return f"a ChArUco board with {columns} squares in a row, and at least {rows} rows; use {options}"


def _chessboard(grey: Image, board: CalibrationBoard) -> str | None:
    found, _, meta = cv2.findChessboardCornersSBWithMeta(grey, (_FEWEST_CORNERS,) * 2, cv2.CALIB_CB_LARGER)
    if not found:
        return None
    sides = sorted(count + 1 for count in meta.shape[:2])
    if isinstance(board, Chessboard) and np.less_equal(sides, sorted((board.columns, board.rows))).all():
        return ""  # perhaps a part of it
    return "a chessboard with at least {1}x{0} squares; use --board chessboard --squares {1}x{0}".format(*sides)


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


def _layout(
    found: Sequence[MarkerDetection], ways: Sequence[tuple[Way, Callable[[int], Place]]]
) -> tuple[Way, int] | None:
    """Return the way to place markers by their numbers that explains where they are in the image.

    The second value is the largest number of a marker that is at its place.
    """
    if len(found) < _FEWEST:
        return None
    centres = np.array([one.corners.mean(axis=0) for one in found])
    side = float(np.median([extent(one.corners) for one in found]))
    best, nearest = None, _NEAR * side
    for way, place in ways:
        places = np.array([place(one.number) for one in found], dtype=float)
        if np.linalg.matrix_rank(places - places.mean(axis=0)) < 2:
            continue
        # The markers of two neighbouring squares touch at a corner: a marker is about as wide as the distance.
        homography, _ = cv2.findHomography(places, centres, cv2.RANSAC, side / 4)
        if homography is None:
            continue
        missed = cv2.perspectiveTransform(places[:, None], homography)[:, 0] - centres
        misses = np.linalg.norm(missed, axis=1)
        if np.median(misses) < nearest:
            nearest = float(np.median(misses))
            best = way, max(one.number for one, miss in zip(found, misses.tolist()) if miss < side / 2)
    return best


def _row_by_row(columns: int, number: int) -> Place:
    """Return the column and row of a tag of an AprilGrid, which are numbered row by row, from the lowest one."""
    return number % columns, -(number // columns)


def _white_square(columns: int, number: int, *, legacy: bool) -> Place:
    """Return the column and row of a marker: the white squares are numbered row by row, and the first one is black."""
    return next(itertools.islice(_white_squares(columns, legacy=legacy), number, None))


def _white_squares(columns: int, *, legacy: bool) -> Iterator[tuple[int, int]]:
    for row in itertools.count():
        for column in range(columns):
            if (column + row) % 2 != legacy:
                yield column, row
