"""``roverlink aruco track``: compute the poses of ArUco markers, and the camera's pose relative to landmarks."""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.aruco.board_options import metres
from roverlink.aruco.camera_source import PARAMETERS, add_source
from roverlink.console import Subparsers, add_project, command, count, node_logger
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import NAMES
from roverlink.runtime.ros_arguments import ros_args

NODE = "aruco_tracker"
NO_MIDDLEWARE = "none"


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "track",
        "find ArUco markers and publish their poses",
        "roverlink aruco track 192.168.0.7:8080 --side 0.15 --landmarks landmarks.yaml --ros-args -r __ns:=/front",
        "Find ArUco markers and publish their poses: on /tf, with covariances, as detections, and drawn into the\n"
        "image. With --landmarks, publish the camera's position too; a running bridge sends it to the basestation.\n"
        "With --json or --save, no ROS 2 is needed.\n"
        "After --ros-args: -r from:=to, -r __ns:=/x, -r __node:=n, --log-level LEVEL.",
    )
    add_source(parser)
    parser.add_argument("--loop", action="store_true", help="repeat a recording until interrupted")
    parser.add_argument("--count", type=count, metavar="N", help="stop after N frames")
    _add_camera(parser)
    _add_markers(parser)
    _add_outputs(parser)
    add_project(parser)
    parser.set_defaults(run=run, takes_ros_args=True)


def _add_camera(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--parameters",
        type=Path,
        default=PARAMETERS,
        metavar="FILE",
        help="camera parameters from `roverlink aruco calibrate` (default: %(default)s)",
    )
    parser.add_argument(
        "--rescale", action="store_true", help="scale camera parameters of another image size to this one"
    )
    parser.add_argument(
        "--camera-frame", default="camera_frame", metavar="NAME", help="frame of the camera (default: %(default)s)"
    )


def _add_markers(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--dictionary", default="DICT_5X5_250", metavar="NAME", help="dictionary of the markers (default: %(default)s)"
    )
    parser.add_argument(
        "--side",
        type=_side,
        action="append",
        default=[],
        metavar="[ID=]METRES",
        help="side of the black square, of all markers or of marker ID (default: 0.05)",
    )
    parser.add_argument(
        "--boards", type=Path, metavar="FILE", help="YAML file of boards: markers that form one landmark"
    )
    parser.add_argument(
        "--landmarks", type=Path, metavar="FILE", help="YAML file with the positions of the landmarks on the field"
    )
    parser.add_argument(
        "--marker-frame",
        default="aruco_",
        metavar="PREFIX",
        help="frame of a marker: PREFIX and its number (default: %(default)s)",
    )


def _add_outputs(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print a JSON object for each frame")
    parser.add_argument("--save", type=Path, metavar="FILE", help="save a video with the poses drawn into it")
    parser.add_argument(
        "--middleware",
        choices=(*NAMES, NO_MIDDLEWARE),
        help=f"auto: rclpy if it can be imported, else dds (default: auto, or {NO_MIDDLEWARE} with --json or --save)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Track markers until the source of frames ends or a signal comes; the exit code is 0 in both cases."""
    ros = ros_args.parse(arguments.ros_args, NODE)
    if names := [name for name in ros.parameters if name != "use_sim_time"]:
        raise SetupError(f"{NODE} has no parameter {names[0]!r}; it is set by options (see --help)")
    logger = node_logger(ros.node.name, ros.log_level if ros.logs_to_console else None)
    if arguments.middleware is None and not (arguments.json or arguments.save):
        arguments.middleware = "auto"
    elif arguments.middleware == NO_MIDDLEWARE:
        arguments.middleware = None
    from roverlink.aruco.tracking import track  # only here, so that the help needs no OpenCV

    return track(arguments, ros, logger)


def _side(text: str) -> tuple[int | None, float]:
    """Parse the side of all markers (``0.15``) or of one marker (``7=0.1``), in metres.

    Returns the number of the marker (None for all) and the side.
    """
    number, separator, side = text.rpartition("=")
    try:
        return (int(number) if separator else None), metres(side)
    except (ValueError, argparse.ArgumentTypeError) as error:
        raise argparse.ArgumentTypeError(f"{text!r} is not METRES or ID=METRES, such as 0.15 or 7=0.1") from error
