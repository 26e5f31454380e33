"""Messages of ROS 2 topics with images and camera parameters, synchronized by their stamps.

    topics = ["/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw", "/camera/color/camera_info"]
    with TopicSets(middleware, topics, say=print) as sets:
        for colour, depth, info in sets: ...

Messages wait in serialized form, and only those of the newest set. So whoever is slower than the camera gets the newest
set, and nothing is converted in vain.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

from roverkit.vision.frames.live import STALLED_S, Say
from roverkit.vision.frames.newest import Newest
from roverkit.vision.frames.synchronization import Synchronizer
from roverkit.vision.ros.image_messages import IMAGES, ImageMessage, read_image
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, nearest
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.middleware.following import FollowingSubscription
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock
from roverlink.runtime.ros_time.headers import stamp_of

TopicMessage = ImageMessage | CameraInfo
"""Message of a topic: an image, or a camera's parameters."""

DEPTH = 5
"""Messages that the middleware keeps until they are taken, as in ROS 2's profile for sensor data."""
LOOK_S = 0.1
"""Time in seconds after which a source looks for publishers again while nothing comes."""
_RECOVERED_S = 1.0


class Arrived(NamedTuple):
    """Serialized message that a topic has received."""

    message_type: type[Message]
    data: bytes
    at: int
    """Time of the arrival in nanoseconds, by the clock of the program."""

    def read(self) -> TopicMessage:
        """Return the message. Raises `ConversionError` if it is damaged, or if its encoding is unknown."""
        if self.message_type is CameraInfo:
            return cdr.decode(CameraInfo, self.data)
        return read_image(self.message_type, self.data)


class BadMessages:
    """Account of messages that cannot be used: says the reason once, and how many there were when good ones return."""

    def __init__(self, name: str, say: Say) -> None:
        self._name, self._say = name, say
        self._reason, self._count, self._last = "", 0, 0.0

    def add(self, error: ConversionError) -> None:
        """Count a message that cannot be used."""
        self._count += 1
        self._last = time.monotonic()
        if self._reason != str(error):
            self._reason = str(error)
            self._say(f"{self._name}: ignoring messages: {error}")

    def good(self) -> None:
        """Note a good message."""
        # Not at once: if good and bad messages alternate, the user wants to know it once.
        if self._reason and time.monotonic() - self._last > _RECOVERED_S:
            self._say(f"{self._name}: the messages are good again; {self._count} were ignored")
            self._reason, self._count = "", 0


class _Topic:
    """One topic: its subscription, and the messages to the user about its silence."""

    def __init__(
        self,
        middleware: Middleware,
        name: str,
        types: Sequence[type[Message]],
        arrived: Callable[[list[Arrived]], None],
        say: Say,
        clock: Clock,
    ) -> None:
        self._middleware, self._name, self._types, self._arrived, self._say = middleware, name, types, arrived, say
        self._clock = clock
        self._subscription = FollowingSubscription(middleware, name, types, self._take, DEPTH)
        self._count = self._seen = 0
        self._since = time.monotonic()
        self._silent = False
        self.close = self._subscription.close

    def _take(self, message_type: type[Message], messages: Sequence[bytes]) -> None:
        now = self._clock.now()
        self._count += len(messages)
        self._arrived([Arrived(message_type, data, now) for data in messages])

    def watch(self) -> None:
        """Subscribe if necessary, and tell the user if the topic becomes silent or returns.

        Called by one thread, at least every `LOOK_S` while nothing comes.
        """
        now = time.monotonic()
        if self._count != self._seen:
            if self._silent and self._seen:
                self._say(f"{self._name} is back after {now - self._since:.1f} s")
            self._seen, self._since, self._silent = self._count, now, False
            return
        published = self._subscription.look()
        if now - self._since < STALLED_S or self._silent:
            return
        self._silent = True
        if published:
            what = "has stalled:" if self._seen else "has a publisher, but"
            self._say(f"{self._name} {what} no message came for {STALLED_S:.0f} s; waiting for one")
        elif self._seen:
            self._say(f"{self._name} has ended: it has no publisher any more; waiting for one")
        else:
            self._say(f"waiting: nothing publishes on {self._name} yet{self._similar()}")

    def _similar(self) -> str:
        types = {type_.__msgtype__ for type_ in self._types}
        topics = [topic for topic, type_name in self._middleware.topics().items() if type_name in types]
        return f"; {nearest(self._name, sorted(topics))}" if topics else ""


class TopicSets:
    """Live source of sets of messages, one of each topic. A context manager: on exit it ends iterations.

    Subscriptions follow the publishers' types and QoS. Publishers may come later, go and return.
    """

    def __init__(
        self,
        middleware: Middleware,
        topics: Sequence[str],
        say: Say,
        slop_ns: int = 0,
        types: Sequence[type[Message]] = (*IMAGES, CameraInfo),
        clock: Clock = SYSTEM_CLOCK,
    ) -> None:
        """Begin to receive; the topics are fully qualified, and the first one leads (module `synchronization`).

        `say` is called with messages for the user. `slop_ns` is the largest distance of the stamps in a set. One of
        `types` must be the type of each topic. `clock` gives the times of arrival.
        """
        self._newest: Newest[tuple[Arrived, ...]] = Newest()
        self._topics = [
            _Topic(middleware, name, types, partial(self._add, index), say, clock) for index, name in enumerate(topics)
        ]
        self._bad = BadMessages(", ".join(topics), say)
        self._lock = threading.Lock()  # a middleware may call back on several threads
        self._synchronizer = Synchronizer[Arrived](len(topics), slop_ns)
        self._taken = 0  # number of the newest set that was returned
        self._watch()

    def take(self, seconds: float) -> tuple[int, tuple[Arrived, ...]] | None:
        """Return the newest set that is not returned yet, serialized, with its number from 0.

        Waits for it at most this time; then, or if the source is closed, returns None. Raises `MiddlewareError` if a
        topic has messages of another type.
        """
        found = self._newest.get(self._taken, seconds)
        if self._newest.closed:
            return None
        self._watch()
        if found is None:
            return None
        self._taken, arrived = found
        return self._taken - 1, arrived

    def arrivals(self) -> Iterator[tuple[int, tuple[Arrived, ...]]]:
        """Yield the newest set that is not yielded yet, serialized, with its number from 0; wait for it."""
        while not self._newest.closed:
            found = self.take(LOOK_S)
            if found is not None:
                yield found

    def __iter__(self) -> Iterator[tuple[TopicMessage, ...]]:
        """Yield the newest set that is not yielded yet; wait for it. Sets with a message that is damaged are left out.

        Raises `MiddlewareError` if a topic has messages of another type.
        """
        for _, arrived in self.arrivals():
            try:
                messages = tuple(message.read() for message in arrived)
            except ConversionError as error:
                self._bad.add(error)
                continue
            self._bad.good()
            yield messages

    def __enter__(self) -> TopicSets:
        return self

    def __exit__(self, *_: object) -> None:
        self._newest.close()
        for topic in self._topics:
            topic.close()

    def _watch(self) -> None:
        for topic in self._topics:
            topic.watch()

    def _add(self, index: int, arrived: list[Arrived]) -> None:
        """Add the messages of a topic, on a thread of the middleware."""
        with self._lock:
            for message in arrived:
                for complete in self._complete(index, message):
                    self._newest.put(complete)

    def _complete(self, index: int, message: Arrived) -> list[tuple[Arrived, ...]]:
        # A single topic needs no stamps; they may be all zero.
        if len(self._topics) == 1:
            return [(message,)]
        try:
            # Every message that a topic here can have begins with a header, and the decoder ignores the rest.
            stamp = stamp_of(cdr.decode(Header, message.data))
        except ConversionError as error:
            self._bad.add(error)
            return []
        return self._synchronizer.add(index, stamp, message)
