"""Detect objects in camera images, locate the selected one, train detectors.

Detect and track objects in camera images, and locate the one that the operator selects.
They need OpenCV: pip install 'opencv-contrib-python-headless>=4.8', and track needs ONNX Runtime and SciPy:
pip install 'onnxruntime>=1.17' 'scipy>=1.11'.

Example: roverlink objects track topic:/camera/camera/color/image_raw --model rocks.onnx
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add ``objects`` with its subcommands to the command line."""
    parser = documented_command(commands, __name__, __doc__, name="objects")
    add_subcommands(parser, __name__, ("track", "detect", "select", "train", "measure", "render"))
