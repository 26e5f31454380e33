"""Publishing again and again, as a driver does, while a test runs."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def repeated(publish: Callable[[int], None], every_s: float = 0.02) -> Iterator[None]:
    """Call a function with 0, 1, 2, ..., on a thread, until the block ends."""
    stopped = threading.Event()

    def run() -> None:
        number = 0
        while not stopped.wait(every_s):
            publish(number)
            number += 1

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        stopped.set()
        thread.join()
