"""Drive along velocities and paths.

Drive the rover. Velocities on cmd_vel (Twist or TwistStamped), or a path on path, become commands for the
driving board (row drive_motor). A path needs the rover's pose on odometry/global, in the frame of the path.
Commands are sent only while the basestation says MODE_AUTO (row control_mode) again and again. The rover
stops if velocities end, if its pose is lost on a path, and if the mode is manual or does not come any more.
The topic drive/state says why the rover stands.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL, -p NAME:=VALUE and --params-file FILE.
The documentation (page Driving) lists the parameters, such as speed, acceleration, smallest_radius and
reverse. ROS 2 can change them while the program runs.

Example: roverlink drive --ros-args -p speed:=0.3 -p smallest_radius:=0.8
"""

from __future__ import annotations

import argparse

from roverkit.driving.drive_declaration import NODE
from roverkit.node.program import node_arguments
from roverlink.console import OK, Subparsers, add_middleware, add_project, documented_command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__, name="drive")
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
