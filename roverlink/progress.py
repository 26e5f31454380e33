"""Progress bar of a long task on the terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache

_EVERY_S = 20.0
Report = Callable[[int, int], None]
"""Function that a long task calls with two amounts: done so far, and in total."""


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """Show a progress bar on a terminal until the block ends. Without a terminal, print a line every 20 s.

    Yields a function. The task calls it with the amount done so far and the total amount, such as ``report(30, 200)``.
    ``what`` is the text beside the bar.
    """
    with ExitStack() as stack:

        @cache
        def bar() -> Report:
            from rich.console import Console  # here: rich is slow to import, and most commands end before a report
            from rich.progress import Progress

            shown = Progress(console=Console(file=sys.stderr), transient=True, redirect_stdout=False)
            task = stack.enter_context(shown).add_task(what, total=None)
            return lambda done, total: shown.update(task, completed=done, total=total)

        told = time.monotonic()

        def show(done: int, total: int) -> None:
            nonlocal told
            if sys.stderr.isatty():
                bar()(done, total)
            elif time.monotonic() - told > _EVERY_S:
                print(f"{what}: {done} of {total} done, still running", file=sys.stderr, flush=True)
                told = time.monotonic()

        yield show
