"""``roverlink video``: commands about video streams, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``video`` with its subcommands to the command line."""
    command_group(
        commands,
        "video",
        "send cameras to the basestation as H.264 in RTP, and show them there",
        "roverlink video send topic:/camera/camera/color/image_raw --host 10.0.0.7",
        "Send camera images to the basestation as H.264 in RTP packets over UDP, and show them there on a page.\n"
        "The commands send and receive need OpenCV: pip install 'opencv-contrib-python-headless>=4.8', and PyAV:\n"
        "pip install 'av>=12'. Other receivers can use GStreamer or FFmpeg; see rover/docs/video.md.",
        __name__,
        ("send", "receive", "set"),
    )
