"""``roverlink number``: commands about the numbers of the envelope, one module each."""

from __future__ import annotations

from roverlink.console import Subparsers, command_group


def add(commands: Subparsers) -> None:
    """Add ``number`` with its subcommands to the command line."""
    command_group(
        commands,
        "number",
        "choose, look up and retire numbers of the envelope",
        "roverlink number next",
        "Commands about the field numbers of the envelope: the next free ones, what a number meant in the history of\n"
        "the repository, and the end of a number.",
        __name__,
        ("next", "history", "retire"),
    )
