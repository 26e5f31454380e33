"""Timekeeper: a thread that runs timed tasks, such as sending a message that had to wait.

Another task is to send the stop to a peer if a topic is silent (table key ``deadman``).

The tasks have a thread of their own so that the stop is sent even if the middleware's thread or the receiving thread is
blocked.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Protocol

from roverlink.runtime.core.periodic_thread import AlarmedThread


class TimedTask(Protocol):
    """Task that a `Timekeeper` runs at certain times."""

    def run_due(self, now: float) -> None:
        """Do the work whose time has come, if any. Must never block. The timekeeper calls this when `next_due` says."""

    @property
    def next_due(self) -> float:
        """Time at which `run_due` should be called next, in seconds of the monotonic clock; infinity for never."""


class Timekeeper:
    """Thread that runs timed tasks. A context manager; it starts no thread if there are no tasks."""

    def __init__(self, name: str, tasks: Sequence[TimedTask], fail: Callable[[BaseException], None]) -> None:
        """Prepare the thread; ``name`` is the thread's name.

        If a task raises an error, ``fail`` is called with the error.
        """
        self._tasks, self._fail = tasks, fail
        self._looks_at = math.inf  # while it looks, each call of `wake` makes it look again
        self._thread = AlarmedThread(name, self._run)

    def wake(self) -> None:
        """Wake the thread if a task is due before it looks again. Call this when a task is due earlier than before."""
        if self._first_due() < self._looks_at:
            self._thread.wake()

    def _first_due(self) -> float:
        return min((task.next_due for task in self._tasks), default=math.inf)

    def __enter__(self) -> Timekeeper:
        if self._tasks:
            self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()

    def _run(self) -> None:
        try:
            wait_s = 0.0
            while self._thread.wait(wait_s):
                self._looks_at = math.inf
                now, first = time.monotonic(), math.inf
                for task in self._tasks:
                    if (due := task.next_due) <= now:
                        task.run_due(now)
                        due = task.next_due
                    first = min(first, due)
                self._looks_at = first
                wait_s = max(0.0, first - time.monotonic())
        except BaseException as failure:  # noqa: BLE001  # `run` of the bridge raises it
            self._fail(failure)
