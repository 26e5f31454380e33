"""Options that describe what a tracker looks for: markers, boards, and the landmarks among them."""

from __future__ import annotations

import argparse
from pathlib import Path

from roverkit.aruco.board_options import metres


def add_targets(parser: argparse.ArgumentParser) -> None:
    """Add the options that describe markers and landmarks to a parser."""
    parser.add_argument(
        "--dictionary",
        default="DICT_5X5_250",
        metavar="NAME",
        help="OpenCV's name of the dictionary of the markers (default: %(default)s)",
    )
    parser.add_argument(
        "--side",
        type=marker_side,
        action="append",
        default=[],
        metavar="[ID=]METRES",
        help="length of the side of a marker's black square; with ID=, only of the marker with this number; may be "
        "repeated (default: 0.05)",
    )
    parser.add_argument(
        "--boards",
        type=Path,
        metavar="FILE",
        help="YAML file with boards; a board is a group of markers whose positions relative to each other are known",
    )
    parser.add_argument(
        "--landmarks",
        type=Path,
        metavar="FILE",
        help="YAML file with the poses of the landmarks (markers and boards) on the field",
    )


def marker_side(text: str) -> tuple[int | None, float]:
    """Parse the side of all markers (``0.15``) or of one marker (``7=0.1``), in metres.

    Returns the number of the marker (None for all) and the side.
    """
    number, separator, side = text.rpartition("=")
    try:
        return (int(number) if separator else None), metres(side)
    except (ValueError, argparse.ArgumentTypeError) as error:
        raise argparse.ArgumentTypeError(f"{text!r} is not METRES or ID=METRES, such as 0.15 or 7=0.1") from error
