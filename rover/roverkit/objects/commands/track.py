"""Detect objects in images, and send them to the basestation.

Detect objects in camera images and follow them from image to image, so that each keeps its number. They
are published on ROS 2 topics; a running bridge sends them to the basestation (row detected_object).
With a depth camera as source, their positions are published, too; `roverlink objects select` needs them.
With --json or --save, no ROS 2 is needed.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL. With -p use_sim_time:=true, the time is
that on /clock.

Example: roverlink objects track topic:/camera/camera/color/image_raw --model rocks.onnx --classes classes.yaml
"""

from __future__ import annotations

import argparse

from roverkit.node.camera_outputs import add_outputs, middleware_of
from roverkit.node.camera_source import add_playing, add_source
from roverkit.node.program import node_arguments
from roverkit.objects.commands.model_options import add_model, add_score, share
from roverkit.objects.object_declarations import TRACKER
from roverlink.console import Subparsers, add_project, documented_command


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_source(parser)
    add_playing(parser)
    parser.add_argument(
        "--depth",
        metavar="TOPIC",
        help="with a ROS 2 topic as source: topic with the depth that is aligned to its images (default: as of "
        "realsense2_camera, aligned_depth_to_color/image_raw beside color/image_raw, if it is published)",
    )
    parser.add_argument(
        "--camera-info",
        metavar="TOPIC",
        help="with --depth: topic with the camera's parameters (default: camera_info beside the images)",
    )
    add_model(parser)
    add_score(parser)
    parser.add_argument(
        "--certain",
        type=share,
        metavar="S",
        help="confidence from which a detection is the first of an object (default: 0.7, or 0.5 for a network of "
        "`roverlink objects train`)",
    )
    add_outputs(parser, "objects")
    add_project(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Track objects until the source of frames ends or a signal comes; the exit code is 0 in both cases."""
    ros, logger = node_arguments(arguments, TRACKER.name)
    arguments.middleware = middleware_of(arguments)
    from roverkit.objects.object_tracker_program import track  # only here, so that the help needs no OpenCV

    return track(arguments, ros, logger)
