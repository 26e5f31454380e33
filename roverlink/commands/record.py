"""``roverlink record``: run the bridge and record everything that passes it."""

from __future__ import annotations

from pathlib import Path

from roverlink.commands.run import add_options, run
from roverlink.console import Subparsers, command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "record",
        "run the bridge and record all topics and datagrams",
        "roverlink record run.mcap --rotate 1000 --ros-args -p dst_ip:=10.0.0.7",
        "Run the bridge and record all topics and datagrams (the same as `roverlink run --record FILE`). Topics go\n"
        "to run.mcap, which `ros2 bag` and Foxglove can read, and datagrams to run.datagrams.mcap. If the program\n"
        "is killed, about the last second is lost. A full disk ends the recording, not the bridge.",
    )
    parser.add_argument(
        "record",
        type=Path,
        metavar="FILE",
        help="file for the topics, such as run.mcap; in a folder, the file is named after the date and time",
    )
    add_options(parser)
    parser.set_defaults(run=run, takes_ros_args=True)
