"""``roverlink drive``: drive along velocities and paths, while the operator lets the rover drive by itself."""

from __future__ import annotations

import argparse

from roverkit.driving.drive_declaration import NODE
from roverkit.node.program import node_arguments
from roverlink.console import OK, Subparsers, add_middleware, add_project, command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "drive",
        "drive along velocities and paths",
        "roverlink drive --ros-args -p speed:=0.3 -p smallest_radius:=0.8",
        "Drive the rover. Velocities on cmd_vel (Twist or TwistStamped), or a path on path, become commands for the\n"
        "driving board (row drive_motor). A path needs the rover's pose on odometry/global, in the frame of the path.\n"
        "Commands are sent only while the basestation says MODE_AUTO (row control_mode) again and again. The rover\n"
        "stops if velocities end, if its pose is lost on a path, and if the mode is manual or does not come any more.\n"
        "The topic drive/state says why the rover stands.\n"
        "All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a\n"
        "topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL, -p NAME:=VALUE and --params-file FILE.\n"
        "The documentation (page Driving) lists the parameters, such as speed, acceleration, smallest_radius and\n"
        "reverse. ROS 2 can change them while the program runs.",
    )
    parser.add_argument("--json", action="store_true", help="print each command and each state as a JSON object")
    add_middleware(parser)
    add_project(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Drive until a signal comes; the exit code is then 0."""
    ros, logger = node_arguments(arguments, NODE.name)
    from roverkit.driving.drive_node import drive

    drive(arguments, ros, logger)
    return OK
