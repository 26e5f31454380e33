"""Timekeeper: a thread that runs timed tasks, such as sending a message that had to wait.

Another task is to send the stop to a peer if a topic is silent (table key ``deadman``).

The tasks have a thread of their own so that the stop is sent even if the middleware's thread or the receiving thread is
blocked.

The thread uses CLOCK_MONOTONIC, which nobody can set, and waits in poll(2), whose timeout uses that clock too. Before
Python 3.11, waiting for a lock with a timeout uses the wall clock (bpo-41710): if somebody set the wall clock back by
an hour, the thread would wait for an hour.
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
"""Longest time in seconds between two runs of a task; the loss of a publisher is noticed after this time at most."""
_WAKES = 4096  # bytes read at once; each call of `wake` writes one


class TimedTask(Protocol):
    """Task that a `Timekeeper` runs at certain times."""

    def run_due(self, now: float) -> None:
        """Do the work whose time has come, if any. Must never block.

        The timekeeper calls this in every round: when a task is due, after `Timekeeper.wake`, and at least every 0.1 s.
        """

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
        # A socket and not a lock or an Event: poll can wait for it with a timeout on the monotonic clock (see above).
        self._wake, self._woken = socket.socketpair()
        # `wake` must never block its caller.
        self._wake.setblocking(False)
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def wake(self) -> None:
        """Wake the thread, so that it asks all tasks again when they are due.

        Call this when a task is due earlier than before.
        """
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
                for task in self._tasks:
                    task.run_due(now)
                due = min(task.next_due for task in self._tasks)
                wait_s = max(0.0, min(due - time.monotonic(), _LOOK_S))
                # poll takes whole milliseconds. Rounded down, it would wake before the task is due, and turn in circles
                # until then.
                if poll.poll(math.ceil(wait_s * 1000)):  # in milliseconds
                    self._woken.recv(_WAKES)
        except BaseException as failure:  # noqa: BLE001  # `run` of the bridge raises it
            self._fail(failure)
