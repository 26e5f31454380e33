"""Measure rocks that the operator marks.

Measure rocks with a depth camera.
It needs OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.

Example: roverlink rocks measure /camera/camera/color/image_raw
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add ``rocks`` with its subcommand to the command line."""
    add_subcommands(documented_command(commands, __name__, __doc__, name="rocks"), __name__, ("measure",))
