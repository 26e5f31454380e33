"""The thread that looks after what has a time: messages that wait for theirs, and topics that have fallen silent.

It is a thread of its own so that a thread that stands still, in the middleware or in the network, counts as silent too.
It goes by CLOCK_MONOTONIC, which nobody sets.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import Protocol

_LOOK_S = 0.1
"""How often it looks up without being asked to: whether publishers have gone, say."""


class Tended(Protocol):
    """Something that has a time."""

    def tend(self, now: float) -> None:
        """Do what is due. Never waits for anybody."""

    @property
    def next_due(self) -> float:
        """When something is due next, in seconds of the monotonic clock; infinity for nothing."""


class Timekeeper:
    """Tends what it is given. A context manager; of nothing it makes no thread."""

    def __init__(self, tended: Sequence[Tended], fail: Callable[[BaseException], None]) -> None:
        """``fail`` is told what ended the thread before it was asked to end."""
        self._tended, self._fail = tended, fail
        self._wake = threading.Event()
        self._stopping = False
        self._thread = threading.Thread(target=self._run, name="timekeeper", daemon=True)

    def wake(self) -> None:
        """Something is due earlier than it was."""
        self._wake.set()

    def __enter__(self) -> Timekeeper:
        if self._tended:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopping = True
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        try:
            while not self._stopping:
                now = time.monotonic()
                for one in self._tended:
                    one.tend(now)
                due = min(one.next_due for one in self._tended)
                self._wake.wait(max(0.0, min(due - time.monotonic(), _LOOK_S)))
                self._wake.clear()
        except BaseException as failure:  # noqa: BLE001  # handed to whoever waits for the bridge
            self._fail(failure)
