"""Progress bar of a long task."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress

Report = Callable[[int, int], None]
"""Function called with the amounts done and to do."""


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """Show a progress bar on a terminal until the block ends; show nothing if there is no terminal.

    Yields a function to call with the amounts that are done and to do. ``what`` is the text beside the bar.
    """
    shown = sys.stderr.isatty()
    with Progress(console=Console(file=sys.stderr), transient=True, disable=not shown, redirect_stdout=False) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
