"""Progress bar of a long task on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[int, int], None]
"""Function that a long task calls with two amounts: done so far, and in total."""


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """Show a progress bar on a terminal until the block ends; show nothing if there is no terminal.

    Yields a function. The task calls it with the amount done so far and the total amount, such as ``report(30, 200)``.
    ``what`` is the text beside the bar.
    """
    from rich.console import Console  # here: the help of a command needs no rich
    from rich.progress import Progress

    shown = sys.stderr.isatty()
    with Progress(console=Console(file=sys.stderr), transient=True, disable=not shown, redirect_stdout=False) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
