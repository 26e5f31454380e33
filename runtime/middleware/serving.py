"""Order in which one thread serves the subscribed topics of a middleware: by priority, in batches."""

from __future__ import annotations

import logging
import threading
from collections.abc import Collection, Iterable
from itertools import takewhile
from typing import NamedTuple, Protocol

from roverlink.runtime.middleware.protocol import Callback
from roverlink.runtime.native.lending import LentTopic

# All messages of a take go to one callback. Large enough to keep up with a burst, small enough that other topics get
# their turn.
_TAKE = 64  # most messages taken at a time
_TAKE_BEHIND = 8  # the same for a topic of low priority: urgent topics wait until these are handled
_END_S = 2.0  # far longer than a thread needs that does not hang
KEPT_TO_READ = 256
"""Smallest number of messages that a subscription keeps until our thread takes them.

The thread may have to wait some milliseconds for a processor core. In this time more messages can arrive than a history
of the usual depth (10) holds.
"""


class Reader(Protocol):
    """Source of the received messages of one topic."""

    def take(self, most: int) -> list[bytes]:
        """Take at most ``most`` received messages, the oldest first."""


class ServedTopic(NamedTuple):
    """Subscribed topic: its reader, its callback and its priority."""

    reader: Reader
    callback: Callback
    priority: int
    lent: LentTopic | None = None
    """Set if the native core takes the messages; it hands some to ``callback``."""

    def serve(self, most: int) -> None:
        """Take at most ``most`` received messages, oldest first, and call the callback with them."""
        if messages := self.reader.take(most):
            self.callback(messages)


def serve(topics: Collection[ServedTopic], ready: Iterable[ServedTopic]) -> None:
    """Call the callback of each topic in ``ready`` once, with at most one batch of messages.

    ``topics`` are all subscribed topics, and ``ready`` are those that may have messages; both begin with the largest
    priority. A topic with many messages delays neither the other topics nor the end of the thread: before each further
    topic, all topics with a higher priority are served again. So a topic of high priority waits for one small batch at
    most.
    """
    took_time = False
    for topic in ready:
        urgent = [*takewhile(lambda other: other.priority > topic.priority, topics)]  # noqa: B023  # used at once
        if took_time:
            for other in urgent:
                other.serve(_TAKE_BEHIND)
        topic.serve(_TAKE_BEHIND if urgent else _TAKE)
        took_time = True


def has_ended(thread: threading.Thread) -> bool:
    """Wait until a thread of a middleware has ended. If it hangs, log a warning after two seconds and return false.

    The middleware then leaves open what the thread may use, so that the program can send the stops and end.
    """
    thread.join(_END_S)
    if thread.is_alive():
        logging.getLogger("roverlink").warning("the thread %s hangs, so the node does not leave ROS 2", thread.name)
    return not thread.is_alive()
