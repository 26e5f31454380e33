"""Layout of sheets: where markers, boards and rulers are on the paper."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.board import CalibrationBoard
from roverkit.vision.markers.marker_set import MarkerSet, black_modules
from roverkit.vision.printing.sheet import Label, Rectangle, Sheet, moved
from roverlink.runtime.core.errors import SetupError

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
_RIM = _MARGIN + _STRIP
_LINE, _TICK, _LONG_TICK = 0.0003, 0.0012, 0.002
_CAPITALS = 0.0022
_STEP = 0.01  # between ticks
_BORDERS = (1, 0.5)
"""Widths of the white border around a marker, in modules; the first one that fits on the paper is taken.

In rendered frames with a black wall behind the sheet, the tracker found all markers of 40 to 160 pixels with half a
module, and as accurately as with a whole one. Of those with a third of a module, it missed 3 of 10.
"""


def board_sheet(board: CalibrationBoard, paper: str) -> Sheet:
    """Return a sheet with a board in the centre, and rulers. Raises `SetupError` if the board does not fit."""
    width, height = board.size
    page = _fitting_page(paper, width, height, _RIM)
    if page is None:
        raise _too_large(f"the board ({board.description})", width, height, _RIM, paper)
    page_width, page_height = page
    left, top = (page_width - width) / 2, (page_height - height) / 2
    rulers, labels = _rulers(page_height, board.description)
    return Sheet(page_width, page_height, (*moved(_board(board), left, top), *rulers), labels)


def marker_sheets(markers: MarkerSet, numbers: Sequence[int], paper: str) -> list[Sheet]:
    """Return sheets with markers and rulers. Each marker has a white border, and its number below it.

    The border is as wide as one module, which is one black or white cell of the marker, or as half a module if the
    largest marker does not fit otherwise. It may reach into the margin of the paper, which is white as well. Raises
    `SetupError` if a marker is too large for the paper.
    """
    sides = {number: float(markers.points(number)[1, 0] - markers.points(number)[0, 0]) for number in numbers}
    modules = markers.bits.markerSize + 2
    largest = max(sides.values())
    for border in _BORDERS:
        cell = largest * (modules + 2 * border) / modules
        # The rulers are at the left and at the lower edge. At the other edges, the border may lie in the margin.
        far_rim = max(0.0, _MARGIN - border * min(sides.values()) / modules)
        page = _fitting_page(paper, cell, cell + _STRIP, far_rim)
        if page:
            break
    else:
        raise _too_large(f"a marker of {_mm(largest)} with its white border", cell, cell + _STRIP, far_rim, paper)
    page_width, page_height = page
    inside = (page_width - _RIM - far_rim, page_height - _RIM - far_rim)
    columns, rows = max(1, int(inside[0] / cell)), max(1, int(inside[1] / (cell + _STRIP)))
    # The cells are in the middle of the part of the sheet that has no rulers.
    start = (_RIM + (inside[0] - columns * cell) / 2, far_rim + (inside[1] - rows * (cell + _STRIP)) / 2)
    sheets = []
    for first in range(0, len(numbers), columns * rows):
        rectangles, labels = _rulers(page_height, markers.dictionary)
        for place, number in enumerate(numbers[first : first + columns * rows]):
            row, column = divmod(place, columns)
            gap = (cell - sides[number]) / 2
            left, top = start[0] + column * cell + gap, start[1] + row * (cell + _STRIP) + gap
            rectangles += moved(_marker(black_modules(markers.bits, number), sides[number]), left, top)
            base = top + sides[number] * (1 + border / modules) + _CAPITALS
            labels += (Label(left, base, _CAPITALS, f"{number}: {_mm(sides[number])}"),)
        sheets.append(Sheet(page_width, page_height, tuple(rectangles), labels))
    return sheets


def _fitting_page(paper: str, width: float, height: float, far_rim: float) -> tuple[float, float] | None:
    """Return width and height of the paper: upright, or turned if the content fits only then; None if it never fits.

    `far_rim` is what has to stay free at the right and at the upper edge.
    """
    rim = _RIM + far_rim
    upright = PAPERS[paper]
    for page in (upright, upright[::-1]):
        if width + rim <= page[0] + 1e-9 and height + rim <= page[1] + 1e-9:
            return page
    return None


def _too_large(what: str, width: float, height: float, far_rim: float, paper: str) -> SetupError:
    """Return the error that a content, which `what` names, does not fit on the paper, with a paper on which it fits."""
    by_size = sorted(PAPERS, key=lambda name: PAPERS[name])
    fitting = next((name for name in by_size if _fitting_page(name, width, height, far_rim)), None)
    cure = f"use {fitting}, or smaller sides" if fitting else "use smaller sides"
    return SetupError(f"{what} ({_mm(width)} x {_mm(height)}) is too large for {paper} with its margins; {cure}")


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
    text = f"If a ruler is not {_mm(RULER)} long, the page was scaled.  {words}"
    return across + down, (Label(_MARGIN + RULER + _LONG_TICK, lower + _LINE, _CAPITALS, text),)


def _mm(metres: float) -> str:
    return f"{metres * 1000:g} mm"
