"""Publish where the rover is, from its driving board and an IMU.

Compute odometry. The distance left on each command (row drive_progress) and the angular velocity of an IMU
(topic imu/data_raw, z axis up) become the rover's pose and velocity on odometry/wheel, with covariances,
and the transform from odom to base_link. Without an IMU, the commands (row drive_motor) tell the turn,
which is far less exact. The speeds of the motors (row drive_diag) tell how far the rover drives between
reports, and when it stands.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL, -p NAME:=VALUE and --params-file FILE.
The documentation (page Odometry) lists the parameters, such as slip, gyro_noise and publish_tf. ROS 2 can
change them while the program runs. With -p use_sim_time:=true, the time is that on /clock.

Example: roverlink odometry --ros-args -p publish_tf:=false
"""

from __future__ import annotations

import argparse
import math

from roverkit.node.program import node_arguments
from roverkit.odometry.odometry_declaration import NODE
from roverlink.console import OK, Subparsers, add_middleware, add_project, documented_command, parsed_number


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__, name="odometry")
    parser.add_argument("--json", action="store_true", help="print each pose as a JSON object, in metres and radians")
    parser.add_argument(
        "--tape",
        type=_length,
        metavar="METRES",
        help="compute the parameters distance_scale, mean_slip and slip from drives along a tape: the rover stands at "
        "its start, drives straight to its end, and stands there",
    )
    add_middleware(parser)
    add_project(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Publish odometry until a signal comes; the exit code is then 0."""
    ros, logger = node_arguments(arguments, NODE.name)
    from roverkit.odometry.wheel_odometry_node import publish_odometry

    publish_odometry(arguments, ros, logger)
    return OK


def _length(text: str) -> float:
    return parsed_number(text, float, lambda length: 0 < length < math.inf, "a length in metres, such as 4")
