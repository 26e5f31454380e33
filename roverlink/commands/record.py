"""``roverlink record``: run the bridge and record all messages of its topics, and all datagrams."""

from __future__ import annotations

from pathlib import Path

from roverlink.commands.run import add_options, run
from roverlink.console import Subparsers, command
from roverlink.observers import RECORDING_HELP


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "record",
        "run the bridge and record all topics and datagrams",
        "roverlink record run.mcap --rotate 1000 --ros-args -p dst_ip:=10.0.0.7",
        "Run the bridge and record its topics and datagrams, until Ctrl-C (the same as\n"
        "`roverlink run --record FILE`). `roverlink recording info` shows the contents of a recording,\n"
        "`roverlink recording replay` sends it again, and `roverlink recording export` makes tables of it.\n\n"
        "With FILE run.mcap, the topics are in run.mcap, which `ros2 bag` and Foxglove can read, and the datagrams\n"
        "are in run.datagrams.mcap. If the program is killed, about the last second of the recording is lost. If the\n"
        "disk is full, the recording ends, but the bridge continues.",
    )
    parser.add_argument(
        "record",
        type=Path,
        metavar="FILE",
        help=RECORDING_HELP,
    )
    add_options(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)
