"""Send cameras to the basestation as H.264 in RTP, and show them there.

Send camera images to the basestation as H.264 in RTP packets over UDP, and show them there on a page.
The commands send and receive need OpenCV: pip install 'opencv-contrib-python-headless>=4.8', and PyAV:
pip install 'av>=12'. Other receivers can use GStreamer or FFmpeg; see rover/docs/video.md.

Example: roverlink video send topic:/camera/camera/color/image_raw --host 10.0.0.7
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add ``video`` with its subcommands to the command line."""
    add_subcommands(documented_command(commands, __name__, __doc__, name="video"), __name__, ("send", "receive", "set"))
