"""Run a router of zenoh, through which the nodes of --middleware zenoh find each other.

Run a router of zenoh, for laptops and CI without ROS 2; beside an installed ROS 2, `ros2 run rmw_zenoh_cpp
rmw_zenohd` is the same. Nodes with `--middleware zenoh`, and ROS 2 nodes with
RMW_IMPLEMENTATION=rmw_zenoh_cpp, connect to the router of their own computer. On other computers, they
need its address: ZENOH_CONFIG_OVERRIDE='mode="client";connect/endpoints=["tcp/10.0.0.5:7447"]'.

The router obeys ZENOH_ROUTER_CONFIG_URI, a file in zenoh's own format with TLS, access control and
down-sampling, and ZENOH_CONFIG_OVERRIDE. It runs until Ctrl-C.

Example: roverlink zenoh-router --listen tcp/0.0.0.0:7447
"""

from __future__ import annotations

import argparse
import threading

from roverlink.console import Subparsers, documented_command, print_note
from roverlink.runtime.middleware import open_zenoh_router


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "--listen",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help="endpoint of zenoh to listen on, such as tcp/10.0.0.5:7447; may be repeated (default: that of the "
        "configuration, or tcp/[::]:7447)",
    )
    parser.set_defaults(run=run, runs_until_stopped=True)


def run(arguments: argparse.Namespace) -> int:
    """Route until Ctrl-C. Raises `MiddlewareError` if the router cannot listen."""
    with open_zenoh_router(arguments.listen) as router:
        print_note(f"zenoh router {router.zid()} runs; Ctrl-C ends it")
        threading.Event().wait()
    return 0
