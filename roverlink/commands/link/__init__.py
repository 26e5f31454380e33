"""Make the keys for signed datagrams.

Commands for the links between the bridge and its peers: make the keys with which both ends sign datagrams.

Example: roverlink link keygen basestation
"""

from __future__ import annotations

from roverlink.console import Subparsers, add_subcommands, documented_command


def add(commands: Subparsers) -> None:
    """Add the command with its subcommands to the command line."""
    add_subcommands(documented_command(commands, __name__, __doc__), __name__, ("keygen",))
