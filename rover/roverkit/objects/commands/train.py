"""Train a small detector with labelled images.

Train a small network with a folder of labelled images in YOLO's format, as CVAT, Label Studio and Roboflow
export it, and measure it with the folder's images 'val': the average precision of each class at an overlap of
50 % (AP50). After Ctrl-C, the result is that of the epochs that are complete; --resume goes on.
It needs jax, optax and onnx: pip install 'jax>=0.4.30' 'optax>=0.2' 'onnx>=1.16'.

Example: roverlink objects train scenes --out rocks.onnx
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverkit.node.camera_source import image_size
from roverlink.console import OK, Subparsers, count, documented_command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder with data.yaml")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("objects.onnx"),
        metavar="FILE",
        help="file for the network; one that this command wrote is replaced (default: %(default)s)",
    )
    parser.add_argument(
        "--size",
        type=image_size,
        default=(320, 256),
        metavar="WxH",
        help="size of the network's input, multiples of 32; a large one finds smaller objects (default: 320x256)",
    )
    parser.add_argument(
        "--epochs",
        type=count,
        default=30,
        metavar="N",
        help="number of times that each image is learnt (default: %(default)s)",
    )
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="another network for another number (default: %(default)s)"
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on with a stopped training of the same images and options, from its checkpoint beside --out",
    )
    parser.add_argument("--json", action="store_true", help="print the result as a JSON object")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Train and measure, and return the exit code."""
    from roverkit.objects.training.training_run import train  # only here, so that the help needs no OpenCV

    train(arguments)
    return OK
