"""How far a long piece of work is."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress

Report = Callable[[int, int], None]
"""Called with how much is done, and how much there is to do."""


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """A bar on a terminal, which goes when it is full; nothing elsewhere."""
    shown = sys.stderr.isatty()
    with Progress(console=Console(file=sys.stderr), transient=True, disable=not shown, redirect_stdout=False) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
