"""Pacing of the packets of all streams of a program, so that they never fill the queue of a slow link.

A key frame is many packets at once. Without pacing, a command that comes next waits behind all of them in the queue of
the radio.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Sequence

Send = Callable[[bytes], None]
"""Function that sends a packet at once; it must not raise."""

_LATE = 1200
"""Bytes that the link may catch up with if the thread wakes late: one packet, for which a command waits at most."""
_SHORTEST_S = 0.001
"""Shortest time in seconds that is slept: on a fast link, waking for each packet would cost more than it spreads."""


class PacedLink:
    """Link with a limited rate. A context manager: the thread that sends runs inside the block.

    Each stream has its own queue, and the queues take turns. Safe to use from several threads.
    """

    def __init__(self, rate: float) -> None:
        """Send at most `rate` bits a second."""
        self._byte_s = 8 / rate
        self._news = threading.Condition()
        self._queues: dict[Send, deque[bytes]] = {}
        self._bytes = 0
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="paced-link", daemon=True)

    def add(self, send: Send, packets: Sequence[bytes], *, first: bool = False) -> None:
        """Queue packets of a stream, which its function `send` will send; with `first`, before those that wait."""
        if not packets:  # a receiver may ask for packets that nobody remembers any more
            return
        with self._news:
            queue = self._queues.setdefault(send, deque())
            if first:
                queue.extendleft(reversed(packets))
            else:
                queue.extend(packets)
            self._bytes += sum(map(len, packets))
            self._news.notify()

    def limit(self, rate: float) -> None:
        """Send at most `rate` bits a second from now on."""
        self._byte_s = 8 / rate

    @property
    def delay(self) -> float:
        """Time in seconds until what waits now is sent."""
        return self._bytes * self._byte_s

    def __enter__(self) -> PacedLink:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        with self._news:
            self._ended = True
            self._news.notify()
        self._thread.join()

    def _run(self) -> None:
        free = time.monotonic()
        """Time at which the link has sent all before."""
        while True:
            with self._news:
                self._news.wait_for(lambda: self._queues or self._ended)
                if self._ended:
                    return
                send, queue = next(iter(self._queues.items()))
                packet = queue.popleft()
                del self._queues[send]
                if queue:  # at the end: the next stream is next
                    self._queues[send] = queue
                self._bytes -= len(packet)
            now = time.monotonic()
            free = max(free, now - _LATE * self._byte_s) + len(packet) * self._byte_s
            if free - now >= _SHORTEST_S:
                time.sleep(free - now)
            send(packet)
