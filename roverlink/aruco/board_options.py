"""Options that describe a ChArUco board."""

from __future__ import annotations

import argparse
import math
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from roverlink.vision.calibration import CharucoBoard

DICTIONARY = "DICT_4X4_50"
_SQUARES = re.compile(r"(\d{1,3})x(\d{1,3})")


def add_board(parser: argparse.ArgumentParser) -> None:
    """Add the options that describe a ChArUco board to a parser."""
    parser.add_argument(
        "--squares",
        type=_squares,
        default=(11, 8),
        metavar="WxH",
        help="board: number of squares in a row, and number of rows (default: 11x8)",
    )
    parser.add_argument(
        "--square",
        type=metres,
        default=0.024,
        metavar="METRES",
        help="board: length of the side of a square (default: %(default)s)",
    )
    parser.add_argument(
        "--marker",
        type=metres,
        default=0.018,
        metavar="METRES",
        help="board: length of the side of a marker (default: %(default)s)",
    )
    parser.add_argument(
        "--dictionary", metavar="NAME", help=f"OpenCV's name of the dictionary of the markers (default: {DICTIONARY})"
    )
    parser.add_argument(
        "--legacy",
        action="store_true",
        help="board: use the pattern of OpenCV before 4.6, which differs for boards with an even number of rows",
    )


def board_of(arguments: argparse.Namespace) -> CharucoBoard:
    """Return the board that the options describe. Raises `SetupError` if such a board is impossible."""
    from roverlink.vision.calibration import CharucoBoard  # only here, so that the help needs no OpenCV

    columns, rows = arguments.squares
    dictionary = arguments.dictionary or DICTIONARY
    return CharucoBoard(columns, rows, arguments.square, arguments.marker, dictionary, arguments.legacy)


def metres(text: str) -> float:
    """Parse the value of an option that is a length in metres, from 1 micrometre to 10 kilometres."""
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not 1e-6 <= found <= 1e4:  # false for NaN too
        raise argparse.ArgumentTypeError(f"{text!r} is not a length in metres, such as 0.024")
    return found


def _squares(text: str) -> tuple[int, int]:
    found = _SQUARES.fullmatch(text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of columns and rows, such as 11x8")
    return int(found[1]), int(found[2])
