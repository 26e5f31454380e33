"""``roverlink rocks``: commands about rocks, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``rocks`` with its subcommand to the command line."""
    command_group(
        commands,
        "rocks",
        "measure rocks that the operator marks",
        "roverlink rocks measure /camera/camera/color/image_raw",
        "Measure rocks with a depth camera.\nIt needs OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.",
        __name__,
        ("measure",),
    )
