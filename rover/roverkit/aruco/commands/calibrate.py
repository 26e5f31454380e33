"""Calibrate a camera with a printed board.

Calibrate a camera with a printed board. `roverlink aruco board` makes a board; after printing, measure
its squares. Hold the board before the camera at different places and angles. The command takes useful
images (views) from a camera, a stream or a video, until the views cover the whole image or you press
Ctrl-C. From a folder, it takes every image. Exit code 1: the views are not sufficient to calibrate, or
the parameters must not be used; then they are written to another file, with .rejected in its name.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME.

Example: roverlink aruco calibrate 0 --square 0.0238 --marker 0.01785
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverkit.aruco.board_options import add_board
from roverkit.aruco.calibration_declaration import NODE
from roverkit.node.camera_source import PARAMETERS, add_source
from roverlink.console import Subparsers, add_middleware, count, documented_command, port
from roverlink.runtime.ros_arguments import ros_args

_MODELS = ("plumb_bob", "rational_polynomial", "equidistant")


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_source(parser)
    add_board(parser)
    parser.add_argument(
        "--model",
        choices=_MODELS,
        default=_MODELS[0],
        help="lens model: 5 coefficients, 8 coefficients for wide lenses, or fisheye (default: %(default)s)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=PARAMETERS,
        metavar="FILE",
        help="file for the camera parameters; the report is written beside it, with the ending .html (default: "
        "%(default)s)",
    )
    parser.add_argument(
        "--views",
        type=count,
        default=20,
        metavar="N",
        help="take at least N views, that is, images of the board (default: %(default)s)",
    )
    parser.add_argument(
        "--json",
        action="store_true",
        help="print a JSON object for each view that is taken from a camera or a video, and one for the result",
    )
    parser.add_argument(
        "--page",
        action="store_true",
        help="serve a page for a web browser, which shows the image and the views that are still missing; there you "
        "can remove views and save the result",
    )
    parser.add_argument(
        "--page-port",
        type=port,
        default=8788,
        metavar="PORT",
        help="with --page: TCP port of the page (default: %(default)s)",
    )
    parser.add_argument(
        "--page-address",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="with --page: IPv4 address of the page (default: %(default)s, which only this computer can reach)",
    )
    add_middleware(parser)
    parser.set_defaults(run=run, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Calibrate the camera. The exit code is 1 if the views do not determine its parameters well enough."""
    from roverkit.calibration.calibrating import calibrate  # only here, so that the help needs no OpenCV

    return calibrate(arguments, ros_args.parse(arguments.ros_args, NODE.name))
