"""``roverlink video``: commands about video streams, one module each."""

from __future__ import annotations

import importlib

from roverlink.console import Subparsers, command

_MODULES = ("send", "receive", "set")


def add(commands: Subparsers) -> None:
    """Add ``video`` with its subcommands to the command line."""
    parser = command(
        commands,
        "video",
        "send cameras to the basestation as H.264 in RTP, and show them there",
        "roverlink video send topic:/camera/camera/color/image_raw --host 10.0.0.7",
        "Send camera images to the basestation as H.264 in RTP packets over UDP, and show them there on a page.\n"
        "The commands send and receive need OpenCV: pip install 'opencv-contrib-python-headless>=4.8', and PyAV:\n"
        "pip install 'av>=12'. Other receivers can use GStreamer or FFmpeg; see docs/video.md.",
    )
    subcommands = parser.add_subparsers(required=True, metavar="command")
    for name in _MODULES:
        importlib.import_module(f"roverlink.commands.video.{name}").add(subcommands)
