"""Change the streams of a sender while it runs.

Change streams of `roverlink video send` while it runs: stop one (running=false), start it again, give it
another source, size, rate, bitrate, host or overlay. The keys are those of the ROS 2 parameters of the
sender. Without changes, the present values of all streams are printed.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE (that of the sender), -r __node:=NAME.
Exit code 0: the streams were changed; 2: the sender refused a value, or it was not found.

Example: roverlink video set front.bitrate=500 mast.running=false
"""

from __future__ import annotations

import argparse

from roverkit.video.video_declarations import SETTER
from roverlink.console import OK, Subparsers, add_middleware, documented_command
from roverlink.runtime.ros_arguments import ros_args


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "changes",
        nargs="*",
        type=_change,
        metavar="STREAM.KEY=VALUE",
        help="new value of a key, such as front.size=320x240; an empty size is that of the source",
    )
    parser.add_argument("--json", action="store_true", help="print the values of the streams as a JSON object")
    add_middleware(parser)
    parser.set_defaults(run=run, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Change the streams, and print their values; the exit code is 0 then."""
    from roverkit.video.setting import set_streams

    set_streams(dict(arguments.changes), arguments, ros_args.parse(arguments.ros_args, SETTER.name))
    return OK


def _change(text: str) -> tuple[str, str]:
    """Parse a change as the name of the parameter and its value."""
    name, equals, value = text.partition("=")
    if not equals or not all(name.partition(".")):
        raise argparse.ArgumentTypeError(f"{text!r} is not STREAM.KEY=VALUE, such as front.bitrate=500")
    return name, value
