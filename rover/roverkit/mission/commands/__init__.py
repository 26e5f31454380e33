"""``roverlink mission``: commands about missions, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``mission`` with its subcommands to the command line."""
    command_group(
        commands,
        "mission",
        "drive to the goals of a file with Nav2",
        "roverlink mission run mission.yaml",
        "Drive to goals: positions on the map, places in front of landmarks, GPS positions. Nav2 drives the rover.\n"
        "It needs OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.",
        __name__,
        ("run",),
    )
