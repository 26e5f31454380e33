"""The thread that looks after what has a time: messages that wait for theirs, and topics that have fallen silent.

It is a thread of its own so that a thread that stands still, in the middleware or in the network, counts as silent too.
It goes by CLOCK_MONOTONIC, which nobody sets, and waits in poll(2), whose timeout does too: a wait for a lock does not
(before Python 3.11), and would last for an hour where the clock is set back by one.
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
"""How often it looks up without being asked to: whether publishers have gone, say."""
_WAKES = 4096  # bytes; one is sent each time it is woken


class Tended(Protocol):
    """Something that has a time."""

    def tend(self, now: float) -> None:
        """Do what is due. Never waits for anybody."""

    @property
    def next_due(self) -> float:
        """When something is due next, in seconds of the monotonic clock; infinity for nothing."""


class Timekeeper:
    """Tends what it is given. A context manager; of nothing it makes no thread."""

    def __init__(self, name: str, tended: Sequence[Tended], fail: Callable[[BaseException], None]) -> None:
        """``name`` is the thread's; ``fail`` is told what ended the thread before it was asked to end."""
        self._tended, self._fail = tended, fail
        self._wake, self._woken = socket.socketpair()
        self._wake.setblocking(False)
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def wake(self) -> None:
        """Something is due earlier than it was."""
        with contextlib.suppress(OSError):  # it was told so often that no more fits, or it has ended
            self._wake.send(b"\0")

    def __enter__(self) -> Timekeeper:
        if self._tended:
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
                for one in self._tended:
                    one.tend(now)
                due = min(one.next_due for one in self._tended)
                wait_s = max(0.0, min(due - time.monotonic(), _LOOK_S))
                if poll.poll(math.ceil(wait_s * 1000)):  # in milliseconds
                    self._woken.recv(_WAKES)
        except BaseException as failure:  # noqa: BLE001  # handed to whoever waits for the bridge
            self._fail(failure)
