"""``roverlink odometry``: publish where the rover is, from what the driving board and an IMU report."""

from __future__ import annotations

import argparse

from roverkit.node.program import node_arguments
from roverkit.odometry.odometry_declaration import NODE
from roverlink.console import OK, Subparsers, add_middleware, add_project, command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "odometry",
        "publish where the rover is, from its driving board and an IMU",
        "roverlink odometry --ros-args -p publish_tf:=false",
        "Compute odometry. The distance left on each command (row drive_progress) and the angular velocity of an IMU\n"
        "(topic imu/data_raw, z axis up) become the rover's pose and velocity on odometry/wheel, with covariances,\n"
        "and the transform from odom to base_link. Without an IMU, the commands (row drive_motor) tell the turn,\n"
        "which is far less exact. The speeds of the motors (row drive_diag) tell how far the rover drives between\n"
        "reports, and when it stands.\n"
        "All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a\n"
        "topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL, -p NAME:=VALUE and --params-file FILE.\n"
        "The documentation (page Odometry) lists the parameters, such as slip, gyro_noise and publish_tf. ROS 2 can\n"
        "change them while the program runs. With -p use_sim_time:=true, the time is that on /clock.",
    )
    parser.add_argument("--json", action="store_true", help="print each pose as a JSON object, in metres and radians")
    add_middleware(parser)
    add_project(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Publish odometry until a signal comes; the exit code is then 0."""
    ros, logger = node_arguments(arguments, NODE.name)
    from roverkit.odometry.wheel_odometry_node import publish_odometry

    publish_odometry(arguments, ros, logger)
    return OK
