"""Show, export and replay what `roverlink record` wrote.

Commands about recordings: show what one contains, export its values as tables, and replay it.

Example: roverlink recording info run.mcap
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add the command with its subcommands to the command line."""
    add_subcommands(documented_command(commands, __name__, __doc__), __name__, ("info", "export", "replay"))
