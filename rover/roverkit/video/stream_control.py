"""Topics on which ``roverlink video set`` changes the streams of a sender.

The sender publishes its `Streams` after each change, and receives a `Request`, both as JSON.

ROS 2's parameter services do the same, but not between any two nodes: a node with the middleware ``dds`` cannot answer
clients that use Fast DDS. Topics work between all middlewares.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from queue import Empty, Queue
from typing import TYPE_CHECKING, Any, TypeVar

from roverkit.video.video_declarations import SET, STREAMS
from roverlink.nodes import FullName, Topic
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, SetupError
from roverlink.runtime.interfaces.std_msgs import String
from roverlink.runtime.middleware import Middleware, Publisher
from roverlink.runtime.ros_arguments.ros_args import RosArguments

if TYPE_CHECKING:  # it needs OpenCV, and `roverlink video set` does not
    from roverkit.video.stream_parameters import StreamParameters

T = TypeVar("T", "Streams", "Request")


@dataclass(frozen=True, slots=True)
class Streams:
    """Streams of one sender, and its answer to the last request."""

    node: str
    """Full name of the sender's node."""
    streams: Mapping[str, Mapping[str, Any]]
    """Value of each key of each stream: the parameters of the node, without ``NAME.``."""
    request: str
    """Id of the last request; empty if there was none."""
    problem: str
    """Reason why nothing was changed; empty if all was."""

    def __post_init__(self) -> None:
        """Raise `TypeError` if another program has published something else."""
        if not all(isinstance(mapping, dict) for mapping in (self.streams, *self.streams.values())):
            raise TypeError("the streams are no objects")


@dataclass(frozen=True, slots=True)
class Request:
    """Request to change parameters, all or none."""

    node: str
    """Full name of the sender's node."""
    id: str
    values: Mapping[str, str]
    """Values by the names of the parameters, such as ``front.bitrate``, as the user has written them."""

    def __post_init__(self) -> None:
        """Raise `TypeError` if another program has published something else."""
        if not isinstance(self.values, dict) or not all(isinstance(value, str) for value in self.values.values()):
            raise TypeError("the values are no texts")


def publish_json(publisher: Publisher, message: Streams | Request) -> None:
    """Publish a message as JSON."""
    publisher.publish([cdr.encode(String(json.dumps(asdict(message))))])


def subscribe_json(
    topic: Topic, middleware: Middleware, full_name: FullName, kind: type[T], take: Callable[[T], None]
) -> None:
    """Call ``take`` with each message of a kind; other texts on the topic are ignored."""

    def take_all(messages: Sequence[bytes]) -> None:
        for data in messages:
            with suppress(ConversionError, ValueError, TypeError, AttributeError):
                take(kind(**json.loads(cdr.decode(String, data).data)))

    topic.subscribe(middleware, full_name, take_all)


class StreamControl:
    """Control of the streams of a sender by the topics."""

    def __init__(self, middleware: Middleware, ros: RosArguments, parameters: StreamParameters) -> None:
        """Publish the streams, and listen to requests, which `answer` answers."""
        self._middleware, self._parameters, self._node = middleware, parameters, ros.node.full_name
        self._answer = "", ""
        self._lock = threading.Lock()
        self._publisher = STREAMS.publisher(middleware, ros.topic)
        self._requests: Queue[Request] = Queue()
        subscribe_json(SET, middleware, ros.topic, Request, self._requests.put)
        self.publish()

    def publish(self) -> None:
        """Publish the present streams."""
        with self._lock:  # the newest state must be the last one
            publish_json(self._publisher, Streams(self._node, self._parameters.by_stream(), *self._answer))

    def answer(self) -> None:
        """Answer the requests that have come.

        Must not be called on a thread of the middleware, because a change may close subscriptions.
        """
        with suppress(Empty):
            while True:
                request = self._requests.get_nowait()
                if request.node == self._node:
                    if request.id != self._answer[0]:  # else it has been sent again
                        self._answer = request.id, self._change(request.values)
                    self.publish()

    def _change(self, values: Mapping[str, str]) -> str:
        """Change parameters, and return the reason if that is not possible."""
        try:
            self._middleware.set_parameters(self._parameters.parsed(values))
        except SetupError as error:
            return str(error)
        return ""
