"""``roverlink aruco``: camera commands, one module each."""

from __future__ import annotations

import importlib

from roverlink.console import Subparsers, command

_COMMANDS = ("track", "calibrate", "board")


def add(commands: Subparsers) -> None:
    """Add ``aruco`` with its subcommands to the command line."""
    parser = command(
        commands,
        "aruco",
        "track ArUco markers, calibrate cameras, print boards",
        "roverlink aruco track 0",
        "Camera commands: track ArUco markers, calibrate a camera, print boards and markers.\n"
        "They need OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.",
    )
    subcommands = parser.add_subparsers(required=True, metavar="command")
    for name in _COMMANDS:
        importlib.import_module(f"roverlink.commands.aruco.{name}").add(subcommands)
