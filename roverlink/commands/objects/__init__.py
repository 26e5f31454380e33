"""``roverlink objects``: commands about detected objects, one module each."""

from __future__ import annotations

import importlib

from roverlink.console import Subparsers, command

_COMMANDS = ("track", "select")


def add(commands: Subparsers) -> None:
    """Add ``objects`` with its subcommands to the command line."""
    parser = command(
        commands,
        "objects",
        "detect objects in camera images, and locate the one that the operator selects",
        "roverlink objects track topic:/camera/camera/color/image_raw --model rocks.onnx",
        "Detect and track objects in camera images, and locate the one that the operator selects.\n"
        "The commands need ONNX Runtime and OpenCV: pip install 'roverlink[detect]'.",
    )
    subcommands = parser.add_subparsers(required=True, metavar="command")
    for name in _COMMANDS:
        importlib.import_module(f"roverlink.commands.objects.{name}").add(subcommands)
