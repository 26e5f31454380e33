"""Run the bridge and record all topics and datagrams.

Run the bridge and record its topics and datagrams, until Ctrl-C (the same as
`roverlink run --record FILE`). `roverlink recording info` shows the contents of a recording,
`roverlink recording replay` sends it again, and `roverlink recording export` makes tables of it.

With FILE run.mcap, the topics are in run.mcap, which `ros2 bag` and Foxglove can read, and the datagrams
are in run.datagrams.mcap. If the program is killed, about the last second of the recording is lost. If the
disk is full, the recording ends, but the bridge continues.

Example: roverlink record run.mcap --rotate 1000 --ros-args -p dst_ip:=10.0.0.7
"""

from __future__ import annotations

from pathlib import Path

from roverlink.commands.run import add_options, run
from roverlink.console import Subparsers, documented_command
from roverlink.observers import RECORDING_HELP


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "record",
        type=Path,
        metavar="FILE",
        help=RECORDING_HELP,
    )
    add_options(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)
