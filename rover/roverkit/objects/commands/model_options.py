"""Options that select a detector."""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.console import parsed_number


def add_model(parser: argparse.ArgumentParser) -> None:
    """Add the options that select a detector to a parser."""
    parser.add_argument(
        "--model",
        type=Path,
        metavar="FILE",
        help="ONNX file of a detector (default: the model of roverlink, for rendered rocks and panels)",
    )
    parser.add_argument(
        "--layout",
        metavar="NAME",
        help="layout of the model's inputs and outputs (default: recognized from the model)",
    )
    parser.add_argument(
        "--classes",
        type=Path,
        metavar="FILE",
        help="YAML file with the names of the model's classes, if the model has none, and with the type of object for "
        "each class (default: that of the same name)",
    )


def add_score(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--score`` to a parser."""
    parser.add_argument(
        "--score",
        type=share,
        metavar="S",
        help="ignore detections with a smaller confidence than this, from 0 to 1 (default: that of the detector)",
    )


def share(text: str) -> float:
    """Parse the value of an option that is a number from 0 to 1."""
    return parsed_number(text, float, lambda number: 0 <= number <= 1, "a number from 0 to 1, such as 0.4")
