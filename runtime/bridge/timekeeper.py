"""Thread that runs timed tasks: messages that wait for their slot, and watchdogs of topics.

It is a thread of its own so that a blocked middleware or network thread still counts as silence.

It uses CLOCK_MONOTONIC, which is never set, and waits in poll(2), whose timeout uses that clock too. Before Python
3.11, waiting for a lock with a timeout uses the wall clock (bpo-41710): if somebody set the clock back by an hour, it
would wait for an hour.
"""

from __future__ import annotations

import contextlib
import math
import select
import socket
import threading
import time
from collections.abc import Callable, Sequence
from typing import Protocol

_LOOK_S = 0.1
"""Longest sleep between two rounds; it bounds how late a lost publisher is noticed."""
_WAKES = 4096  # bytes read at once; each call of `wake` writes one


class TimedTask(Protocol):
    """A task that has to run at certain times."""

    def run_due(self, now: float) -> None:
        """Run whatever is due. Must never block."""

    @property
    def next_due(self) -> float:
        """Time of the next run in seconds of the monotonic clock; infinity for none."""


class Timekeeper:
    """Runs timed tasks on one thread. A context manager; it starts no thread if there are no tasks."""

    def __init__(self, name: str, tasks: Sequence[TimedTask], fail: Callable[[BaseException], None]) -> None:
        """Name the thread; ``fail`` is called with the error if the thread dies."""
        self._tasks, self._fail = tasks, fail
        # A socket and not a lock or an Event: poll can wait for it with a timeout on the monotonic clock (see above).
        self._wake, self._woken = socket.socketpair()
        # `wake` must never block its caller.
        self._wake.setblocking(False)
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def wake(self) -> None:
        """Make the thread compute its next wake-up time again, because a task is due earlier."""
        with contextlib.suppress(OSError):  # the pipe is full, so the thread wakes anyway; or it has ended
            self._wake.send(b"\0")

    def __enter__(self) -> Timekeeper:
        if self._tasks:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopping = True
        self.wake()
        if self._thread.is_alive():
            self._thread.join()
        self._wake.close()
        self._woken.close()

    def _run(self) -> None:
        poll = select.poll()
        poll.register(self._woken, select.POLLIN)
        try:
            while not self._stopping:
                now = time.monotonic()
                for one in self._tasks:
                    one.run_due(now)
                due = min(one.next_due for one in self._tasks)
                wait_s = max(0.0, min(due - time.monotonic(), _LOOK_S))
                # poll takes whole milliseconds. Rounded down, it would wake before the task is due, and turn in circles
                # until then.
                if poll.poll(math.ceil(wait_s * 1000)):  # in milliseconds
                    self._woken.recv(_WAKES)
        except BaseException as failure:  # noqa: BLE001  # `run` of the bridge raises it
            self._fail(failure)
