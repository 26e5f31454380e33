"""Simulate the boards of a rover that drives as ROS 2 says.

Simulate the boards of one rover. It drives the arcs that ROS 2 sends, its wheels slip, and its boards
report progress, motors, IMU and GPS to a running bridge. The topic ground_truth/odometry has its true pose.
The scenarios lossy, stale, padded and malformed change its datagrams; reboot restarts its driving board.

Example: roverlink simulate-rover --clock --speed 4
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from roverkit.node.camera_outputs import NO_MIDDLEWARE

from roverlink.console import (
    MIDDLEWARES_HELP,
    Subparsers,
    add_key_file,
    add_project,
    documented_command,
    parsed_number,
    port,
    seconds,
)
from roverlink.runtime.middleware import NAMES
from roverlink.runtime.ros_arguments import parameters

ROVER_SCENARIOS = ("lossy", "stale", "padded", "malformed", "reboot")
"""Scenarios that a rover can have. The other ones need example values, or signatures."""
_AS_FAST_AS_POSSIBLE = "max"


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__, name="simulate-rover")
    add_project(parser)
    parser.add_argument(
        "--to",
        default=f"127.0.0.1:{parameters.LISTEN_PORT}",
        metavar="HOST:PORT",
        help="address of the bridge (default: %(default)s)",
    )
    parser.add_argument(
        "--listen",
        type=port,
        metavar="PORT",
        help="UDP port on which the rover's boards receive (default: that of the peer in the table)",
    )
    parser.add_argument(
        "--scenario",
        action="append",
        default=[],
        choices=ROVER_SCENARIOS,
        help="fault to simulate; may be repeated (default: no fault)",
    )
    parser.add_argument(
        "--seed",
        type=int,
        default=0,
        metavar="N",
        help="seed of the random numbers; the same seed gives the same drive and faults (default: %(default)s)",
    )
    parser.add_argument(
        "--speed",
        type=_speed,
        default=1.0,
        metavar="X",
        help=f"let the time of the simulation go X times as fast as the real time; {_AS_FAST_AS_POSSIBLE}: as fast as "
        "possible (default: 1)",
    )
    parser.add_argument(
        "--seconds",
        type=seconds,
        default=math.inf,
        metavar="S",
        help="stop after S seconds of the rover's time (default: drive until Ctrl-C)",
    )
    parser.add_argument(
        "--clock", action="store_true", help="publish the time of the simulation on /clock, for use_sim_time"
    )
    parser.add_argument(
        "--landmarks",
        type=Path,
        metavar="FILE",
        help="publish the images of a camera that sees the markers of this file, of 0.15 m and DICT_5X5_250",
    )
    add_key_file(parser, "file with the keys of a board that must sign, a copy of the bridge's file; may be repeated")
    parser.add_argument(
        "--middleware",
        choices=(*NAMES, NO_MIDDLEWARE),
        default="auto",
        help=f"{MIDDLEWARES_HELP}; {NO_MIDDLEWARE}: publish nothing (default: auto)",
    )
    parser.add_argument("--json", action="store_true", help="print the report as a JSON object")
    parser.set_defaults(run=run, runs_until_stopped=True)


def run(arguments: argparse.Namespace) -> int:
    """Simulate the rover; the exit code is 0."""
    from roverkit.simulation.simulated_rover import simulate_rover  # only here, so that the help comes at once

    return simulate_rover(arguments)


def _speed(text: str) -> float:
    if text == _AS_FAST_AS_POSSIBLE:
        return math.inf
    what = f"a factor above 0, or {_AS_FAST_AS_POSSIBLE}"
    return parsed_number(text, float, lambda factor: 0 < factor < math.inf, what)
