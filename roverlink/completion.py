"""Words with which a shell completes arguments: rows, topics and numbers of the table, and topics of nodes.

argcomplete looks for the words only when a shell asks for completions. Without a readable table there are none.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from roverlink.console import TABLE

if TYPE_CHECKING:
    from roverlink.generator.table import Row

Words = Callable[[argparse.Namespace], Iterable[str]]
"""Function that returns the possible words; it gets the options that stand before them in the command line."""


def complete(action: argparse.Action, *words: Words) -> None:
    """Let shells complete an argument with the words of some functions."""

    def completer(parsed_args: argparse.Namespace, **_: object) -> list[str]:
        return [word for one in words for word in one(parsed_args)]

    action.completer = completer  # type: ignore[attr-defined]  # argcomplete reads it


def rows(arguments: argparse.Namespace) -> Iterable[str]:
    """Return the names of the rows."""
    return (row.name for row in _table_rows(arguments))


def numbers(arguments: argparse.Namespace) -> Iterable[str]:
    """Return the numbers of the rows."""
    return (str(row.number) for row in _table_rows(arguments))


def topics(arguments: argparse.Namespace) -> Iterable[str]:
    """Return the topics of the rows, with their extra topics."""
    return (topic.topic for row in _table_rows(arguments) for topic in (row, *row.also))


def topics_of_nodes(arguments: argparse.Namespace) -> Iterable[str]:
    """Return the topics of the rows, and those of the nodes that installed packages declare."""
    from roverlink.nodes.installed import declared_topics

    return (*topics(arguments), *declared_topics())


def _table_rows(arguments: argparse.Namespace) -> Iterable[Row]:
    """Return the rows of the table that the options or the current folder select; none if it cannot be read."""
    from roverlink.generator.diagnostics import DiagnosticsError
    from roverlink.generator.table import reader

    given, project = getattr(arguments, "table", None), getattr(arguments, "project", None)
    folders = [project] if project else [Path.cwd(), *Path.cwd().parents]
    files = [given] if given else [folder / TABLE for folder in folders]
    path = next((file for file in files if file.is_file()), None)
    try:
        return reader.read(path, []).rows if path else ()
    except (DiagnosticsError, OSError):
        return ()
