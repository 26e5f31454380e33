"""Print a file that starts the bridge on the rover's computer: a systemd unit, a Dockerfile.

Print a file with which the bridge of this project's ROS 2 package runs on another computer, to be changed and
kept by you. systemd: a unit that starts the bridge with the computer, restarts it, and records. dockerfile and
compose: an image with the package, and how to run it. devcontainer: an editor's container with ROS 2 and roverlink.
Each file says at its top where to save it, and what to run.

Example: roverlink deploy --print systemd
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.console import OK, TABLE, Subparsers, add_project, documented_command, project_folder
from roverlink.generated_code import load_project
from roverlink.generator.content_digest import text_at
from roverlink.installed_packages import git_source
from roverlink.transport_addresses import on_serial_line

_PREFIX = "/opt/rover"
"""Folder into which colcon installs the package."""
_DISTRO = "humble"
"""Distribution of ROS 2, if the table names none."""


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    parser.add_argument(
        "--print",
        dest="kind",
        required=True,
        choices=("systemd", "dockerfile", "compose", "devcontainer"),
        help="the file to print",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the file."""
    from roverlink.generator.emit.render import render  # here: it imports Jinja, which the help of a command lacks
    from roverlink.generator.emit.targets.ros2 import PROTOBUF

    project: Path = project_folder(arguments.project)
    registry = load_project(project)
    package = registry.package
    text = render(
        f"deploy/{arguments.kind}.j2",
        package=package,
        folder=(text_at(project / TABLE, "python", "package") or "generated").replace(".", "/"),
        distro=text_at(project / TABLE, "ros", "distro") or _DISTRO,
        prefix=_PREFIX,
        program=f"{_PREFIX}/{package}/lib/{package}/{package}_node",
        requirement=PROTOBUF,
        serial=on_serial_line(end.host for end in registry.ends.values()),
        keys=[f"{peer.name}.keys" for peer in registry.peers if peer.must_sign],
        source=git_source("roverlink") or "SOURCE",
    )
    print(text, end="")
    return OK
