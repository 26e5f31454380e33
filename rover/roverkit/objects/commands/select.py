"""Publish the position of the object that the operator selects.

Publish the position of the object whose number the operator selects (row object_selection), in the frames
of the rover and of the field. `roverlink objects track` must run with a depth camera. While the object is
hidden, its position is held, and its covariance grows. Number 0 ends the selection.
All options must stand before --ros-args. After it, these arguments are known: -r FROM:=TO (remap a
topic), -r __ns:=/NAMESPACE, -r __node:=NAME, --log-level LEVEL. With -p use_sim_time:=true, the time is
that on /clock.

Example: roverlink objects select --hold 5
"""

from __future__ import annotations

import argparse

from roverkit.node.program import node_arguments
from roverkit.objects.object_declarations import SELECTOR
from roverlink.console import OK, Subparsers, add_middleware, add_project, documented_command, seconds


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "--hold",
        type=seconds,
        default=5.0,
        metavar="SECONDS",
        help="report a selected object as lost when it has been hidden for this time (default: %(default)g)",
    )
    parser.add_argument(
        "--base-frame",
        default="base_link",
        metavar="NAME",
        help="name of the rover's coordinate frame (default: %(default)s)",
    )
    parser.add_argument(
        "--map-frame",
        default="map",
        metavar="NAME",
        help="name of the coordinate frame of the field (default: %(default)s)",
    )
    parser.add_argument("--json", action="store_true", help="print each change of the selection as a JSON object")
    add_middleware(parser)
    add_project(parser)
    parser.set_defaults(run=run, runs_until_stopped=True, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Publish positions until a signal comes; the exit code is then 0."""
    ros, logger = node_arguments(arguments, SELECTOR.name)
    from roverkit.objects.selecting import select_objects  # only here, so that the help needs no OpenCV

    select_objects(arguments, ros, logger)
    return OK
