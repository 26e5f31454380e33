"""Drive to the goals of a file with Nav2.

Drive to goals: positions on the map, places in front of landmarks, GPS positions. Nav2 drives the rover.
It needs OpenCV: pip install 'opencv-contrib-python-headless>=4.8'.

Example: roverlink mission run mission.yaml
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add ``mission`` with its subcommands to the command line."""
    add_subcommands(documented_command(commands, __name__, __doc__, name="mission"), __name__, ("run",))
