"""Send camera images to the basestation.

Send camera images as H.264 in RTP packets over UDP: one stream for each camera of the file video.yaml, or
the stream of one source. `roverlink video receive`, GStreamer and FFmpeg show them (rover/docs/video.md).
Each stream has ROS 2 parameters, such as front.bitrate, which `ros2 param set` changes.
All options must stand before --ros-args. After it, these arguments are known: -p NAME.KEY:=VALUE (such as
video.bitrate:=500), -r FROM:=TO (remap a topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL.

Example: roverlink video send video.yaml --host 10.0.0.7
"""

from __future__ import annotations

import argparse

from roverkit.node.camera_outputs import NO_MIDDLEWARE
from roverkit.node.camera_source import image_size
from roverkit.node.program import node_arguments
from roverkit.video.video_declarations import SENDER
from roverlink.console import MIDDLEWARES_HELP, Subparsers, documented_command, port, rate
from roverlink.runtime.middleware import NAMES


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "source",
        help="video.yaml with several streams; or one source: number of a camera, topic:NAME (ROS 2 topic with "
        "images), video file, folder of images, or URL (http, https, rtsp)",
    )
    parser.add_argument(
        "--host", help="name or address of the receiver (default: that of the file; for one source, this computer)"
    )
    add = parser.add_argument_group("options for one source (for several, they are keys in the file)").add_argument
    add("--port", type=port, help="UDP port of the receiver (default: 4500)")
    add(
        "--size",
        type=image_size,
        metavar="WxH",
        help="size of the sent images, such as 640x480 (default: the source's)",
    )
    add("--rate", type=rate, metavar="HZ", help="most images a second (default: 30)")
    add("--bitrate", type=float, metavar="KBIT/S", help="most kbit/s (default: 1000)")
    add(
        "--overlay",
        type=_names,
        metavar="WHAT",
        help="draw into the images: time, objects (of `roverlink objects track`), link; several with commas",
    )
    add(
        "--pipeline",
        metavar="TEXT",
        help="let GStreamer encode and send, with a pipeline, in which $host, $port, $bitrate, $rate, $width and "
        "$height are replaced, or with the one named legacy (the rover's earlier script)",
    )
    add(
        "--link-rate",
        type=float,
        metavar="KBIT/S",
        help="rate at which all packets together leave, so that they fill no queue on a slow radio (default: 20000)",
    )
    parser.add_argument(
        "--budget-of",
        metavar="PEER",
        help="let all packets together leave at the rate that the bridge leaves of this peer's budget (key of "
        "mapping.yaml), by its diagnostics, instead of --link-rate",
    )
    parser.add_argument("--loop", action="store_true", help="play a video or a folder again and again, until Ctrl-C")
    parser.add_argument(
        "--middleware",
        choices=(*NAMES, NO_MIDDLEWARE),
        default="auto",
        help=f"{MIDDLEWARES_HELP}; {NO_MIDDLEWARE}: no parameters and no ROS 2 at all (default: auto)",
    )
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Send until the sources end or a signal comes; the exit code is 0 in both cases."""
    ros, logger = node_arguments(arguments, SENDER.name)
    arguments.middleware = None if arguments.middleware == NO_MIDDLEWARE else arguments.middleware
    from roverkit.video.sending import send  # only here, so that the help needs no OpenCV

    return send(arguments, ros, logger)


def _names(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())
