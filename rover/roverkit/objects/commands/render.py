"""Render images of rocks and panels with their labels.

Render images of rocks and maintenance panels, and write them with their labels to a new folder in YOLO's
format. `roverlink objects train` can learn from them. Every eighth image is for the measurement.

Example: roverlink objects render scenes --images 3000 --seed 1
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.console import OK, Subparsers, count, documented_command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder that does not exist, or is empty")
    parser.add_argument(
        "--images", type=count, default=3000, metavar="N", help="number of images (default: %(default)s)"
    )
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="other images for another number (default: %(default)s)"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Render the images, and return the exit code."""
    from roverkit.objects.training.training_run import render  # only here, so that the help needs no OpenCV

    render(arguments.folder, arguments.images, abs(arguments.seed))
    return OK
