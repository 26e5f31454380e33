"""``roverlink recording``: commands about recordings, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``recording`` with its subcommands to the command line."""
    command_group(
        commands,
        "recording",
        "show, export and replay what `roverlink record` wrote",
        "roverlink recording info run.mcap",
        "Commands about recordings: show what one contains, export its values as tables, and replay it.",
        __name__,
        ("info", "export", "replay"),
    )
