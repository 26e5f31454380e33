"""Threads that do some work again and again; a `PeriodicThread` goes on after an error.

An error of the work must not end the thread silently: the bridge would run on without its diagnostics, for example.
"""

from __future__ import annotations

import contextlib
import logging
import math
import select
import socket
import threading
from collections.abc import Callable

_WAKES = 4096  # bytes read at once; each call of `wake` writes one


class AlarmedThread:
    """Thread whose waits another thread can end. A context manager: the end of the block ends the thread.

    A wait uses poll(2), whose timeout is on the monotonic clock, which nobody can set. Before Python 3.11, waiting for
    a lock or an `Event` with a timeout uses the wall clock (bpo-41710): if somebody set the wall clock back by an hour,
    the thread would wait for an hour.
    """

    def __init__(self, name: str, run: Callable[[], object]) -> None:
        """Prepare the thread; ``run`` is what it does, and returns when `wait` returns false."""
        self._wake, self._woken = socket.socketpair()
        # `wake` must never block its caller.
        self._wake.setblocking(False)
        self._poll = select.poll()
        self._poll.register(self._woken, select.POLLIN)
        self._ending = False
        self._thread = threading.Thread(target=run, name=name, daemon=True)

    def wake(self) -> None:
        """End the present wait, or else the next one. Safe in any thread and in a signal handler."""
        with contextlib.suppress(OSError):  # the pipe is full, so the thread wakes anyway; or it has ended
            self._wake.send(b"\0")

    def wait(self, seconds: float) -> bool:
        """Wait in the thread until `wake` is called, but not longer than a number of seconds, which may be infinite.

        Return false if the thread has to end.
        """
        # poll takes whole milliseconds. Rounded down, the wait would end before a task is due.
        timeout = None if seconds == math.inf else math.ceil(seconds * 1000)
        if not self._ending and self._poll.poll(timeout):
            self._woken.recv(_WAKES)
        return not self._ending

    def __enter__(self) -> AlarmedThread:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ending = True
        self.wake()
        if self._thread.is_alive():  # a thread without work was never started
            self._thread.join()
        self._wake.close()
        self._woken.close()


class PeriodicThread:
    """Thread that calls a function at intervals, until the block of this context manager ends.

    If the function raises an error, the thread logs it and goes on. Errors that follow each other are logged once.
    """

    def __init__(self, name: str, interval_s: float, work: Callable[[], object], logger: logging.Logger) -> None:
        self._name, self._interval_s, self._work, self._logger = name, interval_s, work, logger
        self._failing = False
        self._thread = AlarmedThread(name, self._run)

    def __enter__(self) -> PeriodicThread:
        self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()

    def _run(self) -> None:
        while self._thread.wait(self._interval_s):
            try:
                self._work()
                self._failing = False
            except Exception as error:  # the next call may succeed
                if not self._failing:
                    # The formatters of our nodes show no traceback.
                    self._logger.exception("the thread %s goes on after %r", self._name, error)  # noqa: TRY401
                self._failing = True
