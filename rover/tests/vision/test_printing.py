"""Sheets to print. PDFium draws the PDF, OpenCV finds what is on it; neither knows how it was made."""

from __future__ import annotations

import struct
from collections.abc import Callable

import cv2
import numpy as np
import pypdfium2
import pytest
from numpy.typing import NDArray
from roverkit.calibration import AprilGrid, BoardDetector, CalibrationBoard, CharucoBoard, Chessboard
from roverkit.vision import MarkerSet
from roverkit.vision.printing import PAPERS, board_sheet, marker_sheets, to_pdf, to_png
from roverkit.vision.printing.sheet import Label, Sheet
from roverkit.vision.printing.sheet_layout import RULER

from roverlink.runtime.core.errors import SetupError

SCALE = 8000  # Pixels a metre
BOARDS = {
    "default": CharucoBoard(),
    "odd": CharucoBoard(5, 7, 0.03, 0.022, "DICT_5X5_100"),
    "legacy": CharucoBoard(6, 8, 0.025, 0.015, "DICT_4X4_50", legacy=True),
    "chessboard": Chessboard(),
    "aprilgrid": AprilGrid(),
}


def drawn(pdf: bytes, page: int = 0) -> NDArray[np.uint8]:
    """A page as PDFium draws it, at `SCALE`."""
    bitmap = pypdfium2.PdfDocument(pdf)[page].render(scale=SCALE * 0.0254 / 72, grayscale=True)
    return np.ascontiguousarray(bitmap.to_numpy())


@pytest.mark.slow
@pytest.mark.parametrize("board", BOARDS.values(), ids=BOARDS)
def test_a_board_on_paper_is_as_large_as_it_should_be(board: CalibrationBoard) -> None:
    """Every corner is found by its number, and is where it should be to 0.05 mm, in the middle of the sheet."""
    sheet = board_sheet(board, "A4")
    page = drawn(to_pdf([sheet]))
    view = BoardDetector(board).find(page)
    assert view.ids.tolist() == list(range(len(board.points)))
    corners = (view.corners + 0.5) / page.shape[::-1] * (sheet.width, sheet.height)  # PDFium rounds up to whole pixels
    middle = np.array([sheet.width, sheet.height]) / 2
    expected = board.points[:, :2] - np.array(board.size) / 2 + middle
    assert corners == pytest.approx(expected, abs=5e-5)


def test_a_png_is_the_same_board() -> None:
    """Its corners are where they should be to half a pixel, by the resolution that is in the file."""
    board = BOARDS["default"]
    png = to_png(board_sheet(board, "A4"), 150)
    place = png.index(b"pHYs") + 4
    across, down, unit = struct.unpack(">IIB", png[place : place + 9])
    assert (across, down, unit) == (round(150 / 0.0254), across, 1)
    image = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_GRAYSCALE)
    corners = (BoardDetector(board).find(image).corners + 0.5) / across
    assert np.ptp(corners, axis=0) == pytest.approx(np.ptp(board.points[:, :2], axis=0), abs=0.0254 / 150)


def test_markers_on_paper_are_as_large_as_they_should_be() -> None:
    """All that were asked for, each of its own size, on as many sheets as it takes."""
    markers = MarkerSet(side=0.05, sides={7: 0.03})
    numbers = [7, *range(10, 21)]
    pdf = to_pdf(marker_sheets(markers, numbers, "A4"))
    found = {}
    detector = cv2.aruco.ArucoDetector(markers.bits)
    for page in range(len(pypdfium2.PdfDocument(pdf))):
        corners, ids, _ = detector.detectMarkers(drawn(pdf, page))
        found |= dict(zip(np.ravel(ids).tolist(), np.reshape(corners, (-1, 4, 2))))
    assert sorted(found) == numbers
    for number, square in found.items():
        sides = np.linalg.norm(np.roll(square, -1, axis=0) - square, axis=1) / SCALE
        assert sides == pytest.approx(0.03 if number == 7 else 0.05, abs=2.5e-4)  # OpenCV's corners are whole pixels


@pytest.mark.parametrize("paper", PAPERS)
def test_pages_and_rulers_are_as_large_as_they_say(paper: str) -> None:
    """Pages upright or across, in points of 1/72 inch; both rulers meet in a corner, as one shape of 100 mm."""
    pdf = to_pdf([board_sheet(BOARDS["odd"], paper)])
    size = pypdfium2.PdfDocument(pdf)[0].get_size()
    assert sorted(size) == pytest.approx(sorted(np.array(PAPERS[paper]) / 0.0254 * 72), abs=1e-3)
    if paper in ("A4", "letter"):
        _, _, shapes, _ = cv2.connectedComponentsWithStats((drawn(pdf) < 128).astype(np.uint8))
        left, _, width, height, _ = min(shapes[1:].tolist())
        assert left / SCALE == pytest.approx(0.005, abs=1.5e-4)
        assert (width / SCALE, height / SCALE) == pytest.approx((RULER, RULER + 0.0003), abs=3e-4)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: marker_sheets(MarkerSet(side=0.18), [3], "A4"),
            "a marker of 180 mm .* too large for A4 .*; use letter",
        ),
        (lambda: marker_sheets(MarkerSet(side=1.5), [3], "A0"), "use smaller sides"),
        (lambda: to_png(board_sheet(CharucoBoard(), "A0"), 1200), "write a PDF"),
    ],
)
def test_what_does_not_fit_is_refused_with_a_paper_that_does(make: Callable[[], object], words: str) -> None:
    """Nothing is cut off, and nothing is scaled."""
    with pytest.raises(SetupError, match=words):
        make()


def test_the_same_sheets_give_the_same_bytes() -> None:
    """A PDF has no date and no number of its own; its words are as they are, which PDF writes otherwise."""
    assert to_pdf([board_sheet(CharucoBoard(), "A4")]) == to_pdf([board_sheet(CharucoBoard(), "A4")])
    pdf = to_pdf([Sheet(0.2, 0.1, (), (Label(0.01, 0.05, 0.004, r"a (b\c) 7"),))])
    assert pypdfium2.PdfDocument(pdf)[0].get_textpage().get_text_range() == r"a (b\c) 7"
