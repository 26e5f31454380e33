"""Make a sheet with a calibration board or markers, for printing to scale.

Write a board for `roverlink aruco calibrate`, or single markers with --markers, as PDF or PNG.
Print the sheet at 100 % (actual size). The rulers on it show whether the printer kept the scale.

Example: roverlink aruco board --paper A3 --square 0.036 --marker 0.027 --out board.pdf
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from roverkit.aruco.board_options import APRILGRID, CHARUCO, CHESSBOARD, add_board, board_of, metres
from roverlink.console import OK, Subparsers, documented_command, parsed_number
from roverlink.numerals import counted
from roverlink.runtime.atomic_files import write_whole
from roverlink.runtime.core.errors import SetupError

if TYPE_CHECKING:
    from roverkit.vision.printing import Sheet

_PAPERS = ("A0", "A1", "A2", "A3", "A4", "letter", "tabloid")
_FORMATS = (".pdf", ".png")
_NAMES = {CHARUCO: "charuco_board.pdf", CHESSBOARD: "chessboard.pdf", APRILGRID: "aprilgrid.pdf"}
_MARKERS = "DICT_5X5_250"
_RANGE = re.compile(r"(\d{1,4})(?:-(\d{1,4}))?")


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_board(parser)
    parser.add_argument(
        "--markers",
        type=_numbers,
        metavar="IDS",
        help=f"make a sheet with the markers of these numbers, such as 0-5,20, instead of a board (then the default of "
        f"--dictionary is {_MARKERS})",
    )
    parser.add_argument(
        "--side",
        type=metres,
        default=0.05,
        metavar="METRES",
        help="with --markers: length of the side of each marker (default: %(default)s)",
    )
    parser.add_argument("--paper", choices=_PAPERS, default="A4", help="size of the paper (default: %(default)s)")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="file to write; its name ends with .pdf or .png (default: charuco_board.pdf, or the kind of the other "
        "boards, or markers.pdf with --markers)",
    )
    parser.add_argument(
        "--dpi", type=_dpi, default=600.0, help="resolution of a PNG in pixels per inch (default: %(default)g)"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the sheets with the board or the markers to files."""
    out: Path = arguments.out or Path("markers.pdf" if arguments.markers else _NAMES[arguments.board])
    if out.suffix.lower() not in _FORMATS:
        raise SetupError(f"{out}: unknown format; the name must end with {' or '.join(_FORMATS)}")
    from roverkit.vision import printing  # only here, so that the help needs no OpenCV

    sheets = _sheets(arguments)
    if out.suffix.lower() == ".pdf":
        content = printing.to_pdf(sheets)
    elif len(sheets) == 1:
        content = printing.to_png(sheets[0], arguments.dpi)
    else:
        raise SetupError(f"{out}: the markers need {len(sheets)} sheets, but a PNG holds only one; write a PDF")
    write_whole(out, content)
    print(f"{out}: {counted(len(sheets), 'sheet')} of {arguments.paper}; print it at 100 % and check the rulers")
    return OK


def _sheets(arguments: argparse.Namespace) -> list[Sheet]:
    from roverkit.vision.markers.marker_set import MarkerSet
    from roverkit.vision.printing import board_sheet, marker_sheets

    if arguments.markers:
        sides = dict.fromkeys(arguments.markers, arguments.side)
        markers = MarkerSet(arguments.dictionary or _MARKERS, side=None, sides=sides)
        return marker_sheets(markers, arguments.markers, arguments.paper)
    return [board_sheet(board_of(arguments), arguments.paper)]


def _numbers(text: str) -> list[int]:
    """Parse a list of marker numbers such as ``0-5,20``. The order of the list is kept."""
    numbers: list[int] = []
    for part in text.split(","):
        found = _RANGE.fullmatch(part.strip())
        first, last = (int(found[1]), int(found[2] or found[1])) if found else (1, 0)
        if first > last:
            raise argparse.ArgumentTypeError(f"{text!r} is not a list of marker numbers, such as 0-5,20")
        numbers += range(first, last + 1)
    return list(dict.fromkeys(numbers))


def _dpi(text: str) -> float:
    what = "a resolution from 30 to 4800 pixels per inch"
    return parsed_number(text, float, lambda number: 30 <= number <= 4800, what)
