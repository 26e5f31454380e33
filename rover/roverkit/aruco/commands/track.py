"""Find ArUco markers and publish their poses.

Find ArUco markers in camera images, and publish their poses relative to the camera: on /tf, as messages
with covariances, and drawn into the image. With --landmarks, publish also the poses of the camera and the
rover on the field; a running bridge can send the rover's position to the basestation.
SOURCE can be a file of several cameras, such as cameras.yaml.
With --json or --save, no ROS 2 is needed.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL, -p NAME:=VALUE and --params-file FILE.
The parameters dictionary, side, sides (such as 7=0.1) and landmarks replace the options of these names;
ROS 2 can change them while the program runs. With -p use_sim_time:=true, the time is that on /clock.

Example: roverlink aruco track 192.168.0.7:8080 --side 0.15 --landmarks landmarks.yaml --ros-args -r __ns:=/front
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from roverkit.aruco.target_options import add_targets
from roverkit.aruco.tracker_declaration import NODE
from roverkit.node.camera_outputs import add_outputs, middleware_of
from roverkit.node.camera_source import PARAMETERS, add_playing, add_source
from roverkit.node.program import node_arguments
from roverlink.console import Subparsers, add_project, documented_command, parsed_number


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_source(parser)
    add_playing(parser)
    _add_camera(parser)
    _add_rover(parser)
    _add_markers(parser)
    _add_uncertainty(parser)
    add_outputs(parser, "poses")
    add_project(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def _add_camera(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--parameters",
        type=Path,
        metavar="FILE",
        help="file with the camera parameters, made by `roverlink aruco calibrate` (default: the camera info beside a "
        f"ROS 2 topic; for other sources, {PARAMETERS})",
    )
    parser.add_argument(
        "--camera-info",
        metavar="TOPIC",
        help="with a ROS 2 topic as source: topic with the camera parameters (default: camera_info in the namespace of "
        "the source)",
    )
    parser.add_argument(
        "--rescale",
        action="store_true",
        help="if the camera was calibrated with another image size, scale its parameters to the current size",
    )


def _add_rover(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--base-frame",
        default="base_link",
        metavar="NAME",
        help="name of the rover's coordinate frame; the transforms on /tf and /tf_static from the cameras to it are "
        "their mounts, unless a file of cameras gives them (default: %(default)s)",
    )
    parser.add_argument(
        "--odom-frame",
        metavar="NAME",
        help="name of the odometry's coordinate frame; publish the transform to it from the frame of the field on /tf "
        "(default: publish no transform of the rover)",
    )


def _add_markers(parser: argparse.ArgumentParser) -> None:
    add_targets(parser)
    parser.add_argument(
        "--scan-period",
        type=_at_least_zero,
        default=0.09,
        metavar="SECONDS",
        help="search the whole image for new markers when so much time has passed since the last search; known markers "
        "are followed in all images (default: %(default)s, every third image at 30 images a second)",
    )
    parser.add_argument(
        "--marker-frame",
        default="aruco_",
        metavar="PREFIX",
        help="start of the name of a landmark's coordinate frame on /tf; the number of the marker or the name of the "
        "board follows (default: %(default)s)",
    )


def _add_uncertainty(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--side-sigma",
        type=_at_least_zero,
        metavar="FRACTION",
        help="standard deviation of the sides of the markers, as a fraction of the side, for the covariances of the "
        "poses (default: 0.005)",
    )
    parser.add_argument(
        "--corner-floor",
        type=_at_least_zero,
        metavar="PIXELS",
        help="standard deviation of the corners of markers by errors that the image does not show, such as bent paper, "
        "for the covariances (default: 0.05)",
    )
    parser.add_argument(
        "--covariance-scale",
        type=_at_least_zero,
        metavar="FACTOR",
        help="multiply the standard deviations of the poses by this factor, for a filter that takes the errors of "
        "successive images for independent (default: 1)",
    )
    parser.add_argument(
        "--readout-time",
        type=_at_least_zero,
        metavar="SECONDS",
        help="time from the first row of an image to the last one; a rolling shutter distorts moving markers "
        "(default: 0, a global shutter)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Track markers until the source of frames ends or a signal comes; the exit code is 0 in both cases."""
    ros, logger = node_arguments(arguments, NODE.name)
    arguments.middleware = middleware_of(arguments)
    from roverkit.aruco.tracker_program import track  # only here, so that the help needs no OpenCV

    return track(arguments, ros, logger)


def _at_least_zero(text: str) -> float:
    what = "a finite number of at least 0, such as 0.005"
    return parsed_number(text, float, lambda number: 0 <= number < math.inf, what)
