"""Layout of sheets: where markers, boards and rulers are on the paper."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.calibration.board import CalibrationBoard
from roverlink.vision.markers.marker_set import MarkerSet, black_modules
from roverlink.vision.printing.sheet import Label, Rectangle, Sheet, moved

PAPERS = {
    "A0": (0.841, 1.189),
    "A1": (0.594, 0.841),
    "A2": (0.420, 0.594),
    "A3": (0.297, 0.420),
    "A4": (0.210, 0.297),
    "letter": (0.2159, 0.2794),
    "tabloid": (0.2794, 0.4318),
}
"""Width and height in portrait orientation in metres (ISO 216 and ANSI)."""

RULER = 0.1
"""Length of a ruler in metres."""
_MARGIN = 0.005
"""Border in metres that printers cannot reach."""
_STRIP = 0.004
"""Width in metres of the strip at the edge of a sheet for a ruler with its text."""
_LINE, _TICK, _LONG_TICK = 0.0003, 0.0012, 0.002
_CAPITALS = 0.0022
_STEP = 0.01  # between ticks


def board_sheet(board: CalibrationBoard, paper: str) -> Sheet:
    """Return a sheet with a board in the centre, and rulers. Raises `SetupError` if the board does not fit."""
    width, height = board.size
    page_width, page_height = _page(paper, width, height, f"the board ({board.description})")
    left, top = (page_width - width) / 2, (page_height - height) / 2
    rulers, labels = _rulers(page_height, board.description)
    return Sheet(page_width, page_height, (*moved(_board(board), left, top), *rulers), labels)


def marker_sheets(markers: MarkerSet, numbers: Sequence[int], paper: str) -> list[Sheet]:
    """Return sheets with markers and rulers. Each marker has a white border, and its number below it.

    The border is as wide as one module, which is one black or white cell of the marker. Raises `SetupError` if a marker
    is larger than the sheet.
    """
    sides = {number: float(markers.points(number)[1, 0] - markers.points(number)[0, 0]) for number in numbers}
    modules = markers.bits.markerSize + 2
    largest = max(sides.values())
    cell = largest * (modules + 2) / modules
    page_width, page_height = _page(paper, cell, cell + _STRIP, f"a marker of {_mm(largest)} with its white border")
    inside = (page_width - 2 * (_MARGIN + _STRIP), page_height - 2 * (_MARGIN + _STRIP))
    columns, rows = max(1, int(inside[0] / cell)), max(1, int(inside[1] / (cell + _STRIP)))
    sheets = []
    for first in range(0, len(numbers), columns * rows):
        rectangles, labels = _rulers(page_height, markers.dictionary)
        for place, number in enumerate(numbers[first : first + columns * rows]):
            row, column = divmod(place, columns)
            left = (page_width - columns * cell) / 2 + column * cell + (cell - sides[number]) / 2
            top = (page_height - rows * (cell + _STRIP)) / 2 + row * (cell + _STRIP) + (cell - sides[number]) / 2
            rectangles += moved(_marker(black_modules(markers.bits, number), sides[number]), left, top)
            base = top + sides[number] + sides[number] / modules + _CAPITALS
            labels += (Label(left, base, _CAPITALS, f"{number}: {_mm(sides[number])}"),)
        sheets.append(Sheet(page_width, page_height, tuple(rectangles), labels))
    return sheets


def _page(paper: str, width: float, height: float, what: str) -> tuple[float, float]:
    """Return width and height of the paper: upright, or turned if the content fits only then.

    Raises `SetupError` if the content is too large; `what` names the content.
    """
    rim = 2 * (_MARGIN + _STRIP)
    upright = PAPERS[paper]
    for page in (upright, upright[::-1]):
        if width + rim <= page[0] + 1e-9 and height + rim <= page[1] + 1e-9:
            return page
    fitting = [
        name
        for name, (short, long) in sorted(PAPERS.items(), key=lambda one: one[1])
        if min(width, height) + rim <= short and max(width, height) + rim <= long
    ]
    cure = f"use {fitting[0]}, or smaller sides" if fitting else "use smaller sides"
    raise SetupError(f"{what} ({_mm(width)} x {_mm(height)}) is too large for {paper} with its margins; {cure}")


def _board(board: CalibrationBoard) -> Iterator[Rectangle]:
    """Yield the black parts of a board."""
    artwork = board.artwork
    for left, top in artwork.squares:
        yield Rectangle(left, top, artwork.square, artwork.square)
    for marker in artwork.markers:
        yield from moved(_marker(marker.black, artwork.marker), marker.left, marker.top)


def _marker(black: NDArray[np.bool_], side: float) -> Iterator[Rectangle]:
    """Yield rectangles for the black modules (cells) of a marker.

    Neighbouring black modules in a row become one rectangle.
    """
    module = side / len(black)
    for row, modules in enumerate(black):
        column = 0
        for is_black, run in itertools.groupby(modules.tolist()):
            count = len(list(run))
            if is_black:
                yield Rectangle(column * module, row * module, count * module, module)
            column += count


def _rulers(height: float, words: str) -> tuple[list[Rectangle], tuple[Label, ...]]:
    """Return a ruler along the lower edge and one along the left edge, and the text beside the lower ruler."""
    lower = height - _MARGIN - _LINE
    across = [Rectangle(_MARGIN, lower, RULER, _LINE)]
    down = [Rectangle(_MARGIN, lower - RULER, _LINE, RULER)]
    for index in range(round(RULER / _STEP) + 1):
        length, place = (_TICK if index % 5 else _LONG_TICK), index * _STEP
        across.append(Rectangle(_MARGIN + place - (_LINE if place else 0), lower - length, _LINE, length))
        down.append(Rectangle(_MARGIN, lower - place, length, _LINE))
    text = f"If a ruler is not {_mm(RULER)} long, the printer has scaled the page.  {words}"
    return across + down, (Label(_MARGIN + RULER + _LONG_TICK, lower + _LINE, _CAPITALS, text),)


def _mm(metres: float) -> str:
    return f"{metres * 1000:g} mm"
