"""Drive to the goals of a mission.

Drive to the goals of a mission in turn. The mission begins when the basestation says MODE_AUTO (row
control_mode), and ends at once when it says anything else. Nav2 drives the rover (actions navigate_to_pose
and backup), and `roverlink aruco track` sees the landmarks. The exit code is 0 if all goals are reached,
and 1 if one is not. The documentation (page Navigation) explains the file.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a topic or
an action), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL. With -p use_sim_time:=true, the time is
that on /clock.

Example: roverlink mission run mission.yaml
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverkit.mission.mission_declaration import NODE
from roverkit.node.program import node_arguments
from roverlink.console import FINDINGS, OK, Subparsers, add_project, documented_command, seconds


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument("mission", type=Path, metavar="FILE", help="YAML file with the goals and rules")
    parser.add_argument(
        "--wait",
        type=seconds,
        default=30.0,
        metavar="SECONDS",
        help="wait for Nav2 and for the rover's pose for this time (default: %(default)g)",
    )
    parser.add_argument(
        "--base-frame",
        default="base_link",
        metavar="NAME",
        help="name of the rover's coordinate frame (default: %(default)s)",
    )
    parser.add_argument("--json", action="store_true", help="print the progress as JSON objects, one a line")
    add_project(parser)
    parser.set_defaults(run=run, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Drive to all goals; the exit code is 1 if one of them is not reached."""
    ros, logger = node_arguments(arguments, NODE.name)
    from roverkit.mission.mission_running import run_mission  # only here, so that the help needs no OpenCV

    return OK if run_mission(arguments, ros, logger) else FINDINGS
