"""Choose, look up and retire numbers of the envelope.

Commands about the field numbers of the envelope: the next free ones, what a number meant in the history of
the repository, and the end of a number.

Example: roverlink number next
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add the command with its subcommands to the command line."""
    add_subcommands(documented_command(commands, __name__, __doc__), __name__, ("next", "history", "retire"))
