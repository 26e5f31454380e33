"""Check this machine for problems that keep the bridge from working.

Check this machine for problems that keep the bridge from working: Python packages, generated code, the
bridge's UDP port and receive buffer, the peers' address, firewall, multicast and ROS 2. Use it before the
first `roverlink run`, or if no messages arrive. Stop the bridge before, so that its UDP port is free. Write
the same --middleware and --ros-args as for `roverlink run`, so that the port and the addresses of that bridge
are checked. With zenoh, the command looks for the router and for mistakes in the configuration.

If the table has the link message, the command exchanges link messages with the peers for a moment, and
names the boards that have another schema.

The output has one line for each check: ok, warning or error, the name of the check, and the result. A line
`help` below it says how to solve a problem. The command changes nothing. Exit code 0: no check has the
result error; 1: at least one has.

Example: roverlink doctor --ros-args --params-file udp.yaml
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from roverlink import doctor_checks
from roverlink.console import (
    FINDINGS,
    OK,
    UNABLE,
    Subparsers,
    add_end,
    add_middleware,
    add_project,
    documented_command,
    project_folder,
)
from roverlink.diagnostic_text import show_error
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.runtime import NODE
from roverlink.runtime.ros_arguments import ros_args

_STYLES = {"ok": "green", "warning": "yellow", "error": "bold red"}


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    add_end(parser)
    add_middleware(parser)
    parser.add_argument(
        "--json",
        action="store_true",
        help="print the results as a JSON list, with an object for each check (keys: verdict, check, says, cure)",
    )
    parser.add_argument(
        "--pins",
        nargs="+",
        type=Path,
        default=[],
        metavar="FILE|REPO",
        help="say if a board with another schema is compatible: one of the commits of the .proto files that other "
        "projects use must have its schema. The commits are read as for `roverlink lint --pins`",
    )
    parser.set_defaults(run=run, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Print the results of all checks. The exit code is 1 if a result is an error."""
    ros = ros_args.parse(arguments.ros_args, NODE)
    try:
        found = doctor_checks.examine(arguments.project, ros, arguments.pins, arguments.end, arguments.middleware)
    except DiagnosticsError as error:
        show_error(error, project_folder(arguments.project))
        return UNABLE
    if arguments.json:
        print(json.dumps([result.as_dict() for result in found], indent=2))
    else:
        from rich.console import Console  # here: --help needs no rich
        from rich.text import Text

        console = Console(highlight=False, soft_wrap=True)
        for result in found:
            verdict = Text(f"{result.verdict:<8}", _STYLES[result.verdict])
            console.print(Text.assemble(verdict, f"{result.check}: {result.says}"))
            if result.cure:
                console.print(Text(f"        help: {result.cure}"))
    return FINDINGS if any(result.verdict == "error" for result in found) else OK
