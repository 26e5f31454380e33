"""``roverlink aruco track``: where ArUco markers are, and where that puts the camera."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from roverlink.camera_source import add_source, open_source
from roverlink.console import OK, Subparsers, command


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "track",
        "find ArUco markers and say where they are",
        "roverlink aruco track 192.168.0.7:8080",
    )
    add_source(parser)
    parser.add_argument("--parameters", type=Path, metavar="FILE", help="the camera's parameters")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Track until the source ends."""
    from vision import MarkerSet, Tracker
    from vision.parameters import PARAMETERS, read_parameters
    from vision.view import look

    camera = read_parameters(arguments.parameters or PARAMETERS)
    with open_source(arguments, camera.size) as source:
        for view in look(source, Tracker(camera, MarkerSet())):
            print(json.dumps(view.as_dict()))
    return OK
