"""``roverlink aruco``: what is done with a camera; one module a subcommand."""

from __future__ import annotations

import importlib

from roverlink.console import Subparsers, command

_COMMANDS = ("track", "calibrate", "board")


def add(commands: Subparsers) -> None:
    """Declare the subcommands."""
    parser = command(
        commands,
        "aruco",
        "find ArUco markers with a camera, and where that puts it",
        "roverlink aruco track 0",
        "What is done with a camera. Needs OpenCV: pip install 'roverlink[vision]'.",
    )
    subcommands = parser.add_subparsers(required=True, metavar="command")
    for name in _COMMANDS:
        importlib.import_module(f"roverlink.commands.aruco.{name}").add(subcommands)
