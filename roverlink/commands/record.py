"""``roverlink record``: the bridge, and everything that passes it on disk."""

from __future__ import annotations

from pathlib import Path

from roverlink.commands.run import add_options, run
from roverlink.console import Subparsers, command


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "record",
        "bridge as `roverlink run` does, and record everything that passes",
        "roverlink record run.mcap --rotate 1000 --ros-args -p dst_ip:=10.0.0.7",
        "Bridge as `roverlink run` does (it is `roverlink run --record FILE`), and record everything that passes:\n"
        "the topics to run.mcap, which `ros2 bag` and Foxglove read, and the datagrams to run.datagrams.mcap.\n"
        "A kill costs the last second. A full disk ends the recording, and not the bridge.",
    )
    parser.add_argument("record", type=Path, metavar="FILE", help="run.mcap, or a folder for files named by the time")
    add_options(parser)
    parser.set_defaults(run=run, takes_ros_args=True)
