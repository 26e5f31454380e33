"""Options that describe a calibration board."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING, Any

from roverlink.console import parsed_number
from roverlink.runtime.core.errors import SetupError

if TYPE_CHECKING:
    from roverkit.calibration import CalibrationBoard

CHARUCO, CHESSBOARD, APRILGRID = "charuco", "chessboard", "aprilgrid"
_OPTIONS = {
    CHARUCO: ("squares", "square", "marker", "dictionary", "legacy"),
    CHESSBOARD: ("squares", "square"),
    APRILGRID: ("squares", "marker", "spacing"),
}
"""Options that each kind of board has."""
_SQUARES = re.compile(r"(\d{1,3})x(\d{1,3})")


def add_board(parser: argparse.ArgumentParser) -> None:
    """Add the options that describe a calibration board to a parser."""
    parser.add_argument(
        "--board",
        choices=tuple(_OPTIONS),
        default=CHARUCO,
        help="kind of board: a chessboard with markers, a plain chessboard, or Kalibr's grid of AprilTags (default: "
        "%(default)s)",
    )
    parser.add_argument(
        "--squares",
        type=_squares,
        metavar="WxH",
        help="board: number of squares, or of tags of an aprilgrid, in a row, and number of rows (default: 11x8, or "
        "6x6 for an aprilgrid)",
    )
    parser.add_argument(
        "--square", type=metres, metavar="METRES", help="board: length of the side of a square (default: 0.024)"
    )
    parser.add_argument(
        "--marker",
        type=metres,
        metavar="METRES",
        help="board: length of the side of a marker or tag (default: 0.018, or 0.022 for an aprilgrid)",
    )
    parser.add_argument(
        "--spacing",
        type=_ratio,
        metavar="RATIO",
        help="aprilgrid: distance between two tags, divided by the side of a tag: Kalibr's tagSpacing (default: 0.3)",
    )
    parser.add_argument(
        "--dictionary",
        metavar="NAME",
        help="OpenCV's name of the dictionary of the markers (default: DICT_4X4_50)",
    )
    parser.add_argument(
        "--legacy",
        action="store_true",
        default=None,
        help="board: use the pattern of OpenCV before 4.6, which differs for boards with an even number of rows",
    )


def board_of(arguments: argparse.Namespace) -> CalibrationBoard:
    """Return the board that the options describe.

    Raises `SetupError` if such a board is impossible, or if an option does not belong to this kind of board.
    """
    from roverkit.calibration import AprilGrid, CharucoBoard, Chessboard  # only here: the help needs no OpenCV

    kind = arguments.board
    names = dict.fromkeys(name for options in _OPTIONS.values() for name in options)
    given: dict[str, Any] = {name: value for name in names if (value := getattr(arguments, name)) is not None}
    for name in given:
        if name not in _OPTIONS[kind]:
            known = ", ".join(f"--{option}" for option in _OPTIONS[kind])
            raise SetupError(f"--{name} does not belong to --board {kind}, which has {known}")
    if size := given.pop("squares", None):
        given["columns"], given["rows"] = size
    if kind == CHESSBOARD:
        return Chessboard(**given)
    if kind == APRILGRID:
        if "marker" in given:
            given["tag"] = given.pop("marker")
        return AprilGrid(**given)
    return CharucoBoard(**given)


def metres(text: str) -> float:
    """Parse the value of an option that is a length in metres, from 1 micrometre to 10 kilometres."""
    return parsed_number(text, float, lambda number: 1e-6 <= number <= 1e4, "a length in metres, such as 0.024")


def _ratio(text: str) -> float:
    return parsed_number(text, float, lambda _: True, "a number, such as 0.3")


def _squares(text: str) -> tuple[int, int]:
    found = _SQUARES.fullmatch(text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of columns and rows, such as 11x8")
    return int(found[1]), int(found[2])
