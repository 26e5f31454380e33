"""``roverlink doctor``: check the installation on this machine."""

from __future__ import annotations

import argparse
import json

from rich.console import Console
from rich.text import Text

from roverlink import doctor_checks
from roverlink.console import FINDINGS, OK, Subparsers, add_project, command
from roverlink.runtime import NODE
from roverlink.runtime.ros_arguments import ros_args

_STYLES = {"ok": "green", "warning": "yellow", "error": "bold red"}


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "doctor",
        "check this machine for problems that keep the bridge from working",
        "roverlink doctor --ros-args --params-file udp.yaml",
        "Check this machine for problems that keep the bridge from working: generated code, versions, ports, buffers,\n"
        "firewall, multicast, ROS 2. For each problem, print the command that solves it. Write the same --ros-args as\n"
        "for `roverlink run`, so that the ports and addresses of that bridge are checked.",
    )
    add_project(parser)
    parser.add_argument(
        "--json", action="store_true", help="print the results as a JSON list, with one object for each check"
    )
    parser.set_defaults(run=run, takes_ros_args=True)


def run(arguments: argparse.Namespace) -> int:
    """Print the results of all checks. The exit code is 1 if a result is an error."""
    ros = ros_args.parse(arguments.ros_args, NODE)
    found = doctor_checks.examine(arguments.project, ros)
    if arguments.json:
        print(json.dumps([diagnosis.as_dict() for diagnosis in found], indent=2))
    else:
        console = Console(highlight=False, soft_wrap=True)
        for diagnosis in found:
            verdict = Text(f"{diagnosis.verdict:<8}", _STYLES[diagnosis.verdict])
            console.print(Text.assemble(verdict, f"{diagnosis.check}: {diagnosis.says}"))
            if diagnosis.cure:
                console.print(Text(f"        {diagnosis.cure}"))
    return FINDINGS if any(diagnosis.verdict == "error" for diagnosis in found) else OK
