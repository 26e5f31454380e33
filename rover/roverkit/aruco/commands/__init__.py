"""``roverlink aruco``: camera commands, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``aruco`` with its subcommands to the command line."""
    command_group(
        commands,
        "aruco",
        "track ArUco markers, calibrate cameras, print boards",
        "roverlink aruco track 0",
        "Camera commands: track ArUco markers, calibrate a camera, print boards and markers.\n"
        "They need OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.",
        __name__,
        ("track", "calibrate", "board"),
    )
