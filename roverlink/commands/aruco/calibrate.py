"""``roverlink aruco calibrate``: a camera's parameters, and how well they are known."""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.aruco.board_options import add_board
from roverlink.aruco.camera_source import PARAMETERS, add_source
from roverlink.console import Subparsers, command, count, port

_MODELS = ("plumb_bob", "rational_polynomial", "equidistant")


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "calibrate",
        "find a camera's parameters with a ChArUco board",
        "roverlink aruco calibrate 0 --square 0.0238 --marker 0.01785",
        "Find a camera's parameters with a ChArUco board (`roverlink aruco board` prints one; measure its squares).\n"
        "Of a camera, a stream or a video, views are taken that add something, until nothing is missing or Ctrl-C\n"
        "says that it is enough; a folder's images are all taken. Exit code 1 where the views are not enough.",
    )
    add_source(parser)
    add_board(parser)
    parser.add_argument(
        "--model",
        choices=_MODELS,
        default=_MODELS[0],
        help="of the lens: 5 coefficients, 8 for wide lenses, or fisheye (default: %(default)s)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=PARAMETERS,
        metavar="FILE",
        help="where the parameters are written, and a report beside them as .html (default: %(default)s)",
    )
    parser.add_argument(
        "--views", type=count, default=20, metavar="N", help="views to collect at least (default: %(default)s)"
    )
    parser.add_argument(
        "--json", action="store_true", help="print an object for each view that is taken, and the result"
    )
    parser.add_argument(
        "--page",
        action="store_true",
        help="show the picture and what is missing on a page for a browser; views are dropped, and all is saved there",
    )
    parser.add_argument(
        "--page-port", type=port, default=8788, metavar="PORT", help="TCP port of the page (default: %(default)s)"
    )
    parser.add_argument(
        "--page-address",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="where the page is served (default: %(default)s, for this computer alone)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Calibrate; exit code 1 where the views do not determine the camera."""
    from roverlink.aruco.calibration import calibrate  # only here, so that the help needs no OpenCV

    return calibrate(arguments)
