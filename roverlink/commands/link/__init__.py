"""``roverlink link``: commands for the links between the bridge and its peers, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``link`` with its subcommands to the command line."""
    command_group(
        commands,
        "link",
        "make the keys for signed datagrams",
        "roverlink link keygen basestation",
        "Commands for the links between the bridge and its peers: make the keys with which both ends sign datagrams.",
        __name__,
        ("keygen",),
    )
