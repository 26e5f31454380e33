"""Answer requests with the sizes of rocks.

Measure rocks. A request of the basestation (row rock_measure_request) is a line across a rock in the colour
image; the answer (row rock_measure_result) is the rock's length along the line and its width. If the rock
cannot be measured, both are NaN, and the log has the reason.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL, -p NAME:=VALUE and --params-file FILE.
The parameters camera, depth and camera_info replace the argument and the options; ROS 2 can change them
while the program runs, to select another camera.

Example: roverlink rocks measure /camera/camera/color/image_raw
"""

from __future__ import annotations

import argparse

from roverkit.node.program import node_arguments
from roverkit.rocks.rocks_declaration import NODE
from roverlink.console import OK, Subparsers, add_middleware, add_project, documented_command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "camera", metavar="COLOUR_TOPIC", help="topic with the colour images in which the operator draws the line"
    )
    parser.add_argument(
        "--depth",
        metavar="TOPIC",
        help="topic with the depth that is aligned to the colour images (default: as of realsense2_camera, "
        "aligned_depth_to_color/image_raw beside color/image_raw)",
    )
    parser.add_argument(
        "--camera-info",
        metavar="TOPIC",
        help="topic with the parameters of the colour camera (default: camera_info beside the colour images)",
    )
    parser.add_argument("--json", action="store_true", help="print each answer as a JSON object, in metres")
    add_middleware(parser)
    add_project(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Answer requests until a signal comes; the exit code is then 0."""
    ros, logger = node_arguments(arguments, NODE.name)
    from roverkit.rocks.measuring import measure_rocks  # only here, so that the help needs no OpenCV

    measure_rocks(arguments, ros, logger)
    return OK
