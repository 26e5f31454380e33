"""Measure a detector with labelled images.

Measure a detector with the images 'val' of a folder in YOLO's format: the average precision of each class
at an overlap of 50 % (AP50), as COCO defines it. The names of the classes must be those of the detector.

Example: roverlink objects measure photographs --model rocks.onnx
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverkit.objects.commands.model_options import add_model
from roverlink.console import OK, Subparsers, documented_command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder with data.yaml")
    add_model(parser)
    parser.add_argument("--json", action="store_true", help="print the result as a JSON object")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure, and return the exit code."""
    from roverkit.objects.training.training_run import measure  # only here, so that the help needs no OpenCV

    measure(arguments)
    return OK
