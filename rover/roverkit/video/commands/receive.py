"""Show video of the rover on a page, save it, publish it.

Receive H.264 in RTP packets, and show all streams on a page in the browser. The sender can be GStreamer,
FFmpeg, or `roverlink video send`, which hears what is lost, sends it again, and adapts its bitrate.

Example: roverlink video receive front=4500 arm=4501 --save today/
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from roverkit.node.camera_outputs import NO_MIDDLEWARE
from roverkit.node.program import node_arguments
from roverkit.video.video_declarations import RECEIVER
from roverlink.console import MIDDLEWARES_HELP, Subparsers, documented_command, listen_address, port
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import NAMES

_PORTS = (4500, 4501, 4502)
_ALL = "0.0.0.0"  # noqa: S104  # the rover is another computer
_PAGE = ("127.0.0.1", 8085)


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "ports",
        nargs="*",
        type=_named_port,
        metavar="[NAME=]PORT",
        help="UDP ports of the streams, with names for the page, files and topics (default: 4500 4501 4502)",
    )
    parser.add_argument("--listen", default=_ALL, metavar="ADDRESS", help="address to listen on (default: all of IPv4)")
    parser.add_argument(
        "--page",
        type=listen_address,
        default=_PAGE,
        metavar="[HOST:]PORT",
        help="address of the page (default: 127.0.0.1:8085, which only this computer can open)",
    )
    parser.add_argument("--no-page", action="store_const", dest="page", const=None, help="show no page")
    parser.add_argument(
        "--save",
        type=Path,
        metavar="FOLDER",
        help="save each stream as a Matroska file in this folder, as it was received, without encoding it again",
    )
    parser.add_argument("--mp4", action="store_true", help="save MP4 files")
    parser.add_argument("--topic", action="store_true", help="publish the images on video/NAME/compressed")
    parser.add_argument("--json", action="store_true", help="print the statistics of all streams each second as JSON")
    parser.add_argument(
        "--middleware",
        choices=(*NAMES, NO_MIDDLEWARE),
        help=f"{MIDDLEWARES_HELP}; {NO_MIDDLEWARE}: no ROS 2 (default: {NO_MIDDLEWARE}; auto with --topic)",
    )
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Receive until a signal comes; the exit code is 0 then."""
    ros, logger = node_arguments(arguments, RECEIVER.name)
    arguments.ports = _different(arguments.ports or [(str(number), number) for number in _PORTS])
    from roverkit.video.receiving import receive  # only here, so that the help needs no OpenCV

    return receive(arguments, ros, logger)


def _different(ports: Sequence[tuple[str, int]]) -> dict[str, int]:
    """Return the ports by their names. Raises `SetupError` if two streams have the same name or port."""
    for index, (name, number) in enumerate(ports):
        for other, taken in ports[:index]:
            if name == other or number == taken != 0:
                raise SetupError(f"the streams {other}={taken} and {name}={number} must have different names and ports")
    return dict(ports)


def _named_port(text: str) -> tuple[str, int]:
    """Parse a port with or without a name."""
    name, _, number = text.rpartition("=")
    if name and not name.replace("_", "").isalnum():
        raise argparse.ArgumentTypeError(f"{name!r} is not a name of letters, digits and _, such as front")
    return name or number, port(number)
