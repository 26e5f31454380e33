"""Track ArUco markers, calibrate cameras, print boards.

Camera commands: track ArUco markers, calibrate a camera, print boards and markers.
They need OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.

Example: roverlink aruco track 0
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add ``aruco`` with its subcommands to the command line."""
    parser = documented_command(commands, __name__, __doc__, name="aruco")
    add_subcommands(parser, __name__, ("track", "calibrate", "board"))
