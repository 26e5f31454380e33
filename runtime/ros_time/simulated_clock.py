"""Time of a simulation, from the topic /clock: the clock of ROS 2 nodes with the parameter `use_sim_time`."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.standard_handler import nanoseconds
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.middleware import Middleware

TOPIC = "/clock"
PATIENCE_S = 3.0
"""Time in seconds without a first message after which the user is told."""
_QOS = Qos(depth=1, reliability="best_effort")  # of rclcpp::TimeSource


class SimulatedClock:
    """Clock that shows the time of the newest message. A context manager: on exit it ends its subscription."""

    def __init__(self, middleware: Middleware, topic: str, say: Callable[[str], None]) -> None:
        """Subscribe to a fully qualified topic.

        `say` is called with a message for the user if nothing comes for `PATIENCE_S`.
        """
        self._news = threading.Condition()
        self._now: int | None = None
        told = f"waiting for the time of the simulation: use_sim_time is set, but nothing comes on {topic}"
        self._silence = threading.Timer(PATIENCE_S, say, (told,))
        self._silence.daemon = True
        self._subscription = middleware.subscribe(topic, Clock, _QOS, self._take)
        self._silence.start()

    def now(self) -> int:
        """Return the time in nanoseconds of the newest message; 0 before the first one, as in every ROS 2 node."""
        return self._now or 0

    def wait(self) -> None:
        """Wait for the first message."""
        with self._news:
            self._news.wait_for(lambda: self._now is not None)

    def sleep_until(self, stamp: int, since: int) -> None:
        """Wait until the simulation has reached a time in nanoseconds, or has jumped back behind the time `since`."""
        with self._news:
            self._news.wait_for(lambda: not since <= self.now() < stamp)

    def __enter__(self) -> SimulatedClock:
        return self

    def __exit__(self, *_: object) -> None:
        self._silence.cancel()
        self._subscription.close()

    def _take(self, messages: Sequence[bytes]) -> None:
        """Set the time, on a thread of the middleware."""
        try:
            newest = cdr.decode(Clock, messages[-1]).clock
        except ConversionError:  # the next one is right
            return
        self._silence.cancel()
        with self._news:
            self._now = nanoseconds(newest)
            self._news.notify_all()
