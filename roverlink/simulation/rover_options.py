"""Options of ``roverlink simulate --rover``."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from roverlink.console import MIDDLEWARES_HELP, NO_MIDDLEWARE, port
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import NAMES

_AS_FAST_AS_POSSIBLE = "max"
_NEEDS_ROVER = {"listen": None, "speed": 1.0, "clock": False, "landmarks": None, "middleware": "auto"}
"""Defaults of the options that need ``--rover``."""
_WITHOUT_ROVER = {"bridge": None, "rate": None}
"""Defaults of the options that do not go with ``--rover``."""


def add_rover_options(parser: argparse.ArgumentParser) -> None:
    """Add the options to the parser of ``roverlink simulate``."""
    group = parser.add_argument_group("simulated rover")
    group.add_argument(
        "--rover",
        action="store_true",
        help="simulate a rover that drives as the commands on drive_motor say, and that measures how it drives",
    )
    group.add_argument(
        "--listen",
        type=port,
        metavar="PORT",
        help="UDP port on which the rover's boards receive (default: that of the peer in the table)",
    )
    group.add_argument(
        "--speed",
        type=_speed,
        default=1.0,
        metavar="X",
        help=f"let the time of the simulation go X times as fast as the real time; {_AS_FAST_AS_POSSIBLE}: as fast as "
        "possible (default: 1)",
    )
    group.add_argument(
        "--clock", action="store_true", help="publish the time of the simulation on /clock, for use_sim_time"
    )
    group.add_argument(
        "--landmarks",
        type=Path,
        metavar="FILE",
        help="publish the images of a camera that sees the markers of this file, of 0.15 m and DICT_5X5_250",
    )
    group.add_argument(
        "--middleware",
        choices=(*NAMES, NO_MIDDLEWARE),
        default="auto",
        help=f"{MIDDLEWARES_HELP}; {NO_MIDDLEWARE}: publish nothing (default: auto)",
    )


def check_rover_options(arguments: argparse.Namespace) -> None:
    """Raise `SetupError` if an option needs ``--rover``, or does not go with it."""
    others = _WITHOUT_ROVER if arguments.rover else _NEEDS_ROVER
    for name, default in others.items():
        if getattr(arguments, name) != default:
            verb = "does not go with" if arguments.rover else "needs"
            raise SetupError(f"--{name} {verb} --rover")


def _speed(text: str) -> float:
    if text == _AS_FAST_AS_POSSIBLE:
        return math.inf
    try:
        factor = float(text)
    except ValueError:
        factor = math.nan
    if not 0 < factor < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a factor above 0, or {_AS_FAST_AS_POSSIBLE}")
    return factor
