"""``roverlink mission``: commands about missions, one module each."""

from __future__ import annotations

from roverlink.commands.mission import run
from roverlink.console import Subparsers, command


def add(commands: Subparsers) -> None:
    """Add ``mission`` with its subcommands to the command line."""
    parser = command(
        commands,
        "mission",
        "drive to the goals of a file with Nav2",
        "roverlink mission run mission.yaml",
        "Drive to goals: positions on the map, places in front of landmarks, GPS positions. Nav2 drives the rover.\n"
        "It needs OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.",
    )
    run.add(parser.add_subparsers(required=True, metavar="command"))
