"""Detect objects in photographs.

Detect objects in an image, or in each image of a folder, and print their boxes: x and y of the upper left corner,
width and height in pixels. The images need not follow each other, and no ROS 2 is needed. For the images of a
camera or a film, `roverlink objects track` gives the objects numbers.

Example: roverlink objects detect photographs --model rocks.onnx --save drawn
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverkit.objects.commands.model_options import add_model, add_score
from roverlink.console import OK, Subparsers, documented_command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument("images", type=Path, metavar="IMAGES", help="image, or folder of images")
    add_model(parser)
    add_score(parser)
    parser.add_argument("--json", action="store_true", help="print the objects as a JSON object for each image")
    parser.add_argument(
        "--save",
        type=Path,
        metavar="FOLDER",
        help="write the images with the objects drawn into them to a folder that does not exist, or is empty",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Detect objects in all images, and return the exit code."""
    from roverkit.objects.detecting import detect_objects  # only here, so that the help needs no OpenCV

    detect_objects(arguments)
    return OK
