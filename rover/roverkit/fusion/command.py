"""Fuse odometry, landmarks and GPS to the rover's pose on the field.

Fuse the odometry (odometry/wheel), the landmarks that `roverlink aruco track` sees (aruco/detections) and,
with --datum, GPS (gps/fix). Publish the rover's pose on the field (odometry/global) and the transform from
the frame of the field to that of the odometry. A landmark that somebody has moved is found and left out.
This is for computers without robot_localization, such as laptops with a simulated rover. On a rover, use
robot_localization with rover/navigation/config/ekf.yaml: run only one of the two.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL.

Example: roverlink fuse --landmarks landmarks.yaml --cameras cameras.yaml
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from roverkit.fusion.fusion_declaration import NODE
from roverkit.node.program import node_arguments
from roverkit.odometry.dead_reckoning import OdometryNoise
from roverlink.console import OK, Subparsers, add_middleware, documented_command, parsed_number


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__, name="fuse")
    parser.add_argument(
        "--landmarks",
        type=Path,
        required=True,
        metavar="FILE",
        help="file with the places of the landmarks on the field",
    )
    parser.add_argument(
        "--cameras",
        type=Path,
        metavar="FILE",
        help="file of cameras that `roverlink aruco track` uses; its cameras are received, with their mounts (default: "
        "one camera, whose mount is on /tf)",
    )
    parser.add_argument(
        "--datum",
        type=_finite,
        nargs=3,
        metavar=("LATITUDE", "LONGITUDE", "HEADING"),
        help="use GPS: origin of the field in degrees, and direction of its x axis in radians, counterclockwise from "
        "the east (default: GPS is not used)",
    )
    parser.add_argument(
        "--mean-slip",
        type=_part,
        default=OdometryNoise().mean_slip,
        metavar="PART",
        help="standard deviation of the mean slip, as a part of the distance: the parameter mean_slip of `roverlink "
        "odometry` (default: %(default)s)",
    )
    parser.add_argument(
        "--base-frame",
        default="base_link",
        metavar="NAME",
        help="name of the rover's coordinate frame (default: %(default)s)",
    )
    parser.add_argument("--json", action="store_true", help="print each pose as a JSON object")
    add_middleware(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Fuse until a signal comes; the exit code is then 0."""
    ros, logger = node_arguments(arguments, NODE.name)
    from roverkit.fusion.fusing import fuse  # only here, so that the help needs neither OpenCV nor GTSAM

    fuse(arguments, ros, logger)
    return OK


def _finite(text: str) -> float:
    return parsed_number(text, float, math.isfinite, "a finite number, such as 50.06")


def _part(text: str) -> float:
    return parsed_number(text, float, lambda part: 0 <= part < math.inf, "a number from 0 on, such as 0.02")
