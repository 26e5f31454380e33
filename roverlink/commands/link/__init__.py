"""``roverlink link``: commands for the links between the bridge and its peers, one module each."""

from __future__ import annotations

import importlib

from roverlink.console import Subparsers, command

_COMMANDS = ("keygen",)


def add(commands: Subparsers) -> None:
    """Add ``link`` with its subcommands to the command line."""
    parser = command(
        commands,
        "link",
        "make the keys for signed datagrams",
        "roverlink link keygen basestation",
        "Commands for the links between the bridge and its peers: make the keys with which both ends sign datagrams.",
    )
    subcommands = parser.add_subparsers(required=True, metavar="command")
    for name in _COMMANDS:
        importlib.import_module(f"roverlink.commands.link.{name}").add(subcommands)
