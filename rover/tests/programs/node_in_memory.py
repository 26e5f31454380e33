"""A node of a program without its command line: in memory, with its log, in a time that passes only here."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any, TypeVar

from repeating import repeated
from roverkit.node.ros_connection import RosConnection

from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.ros_arguments import ros_args

M = TypeVar("M", bound=Message)

SECOND = 10**9
BEGAN = 100 * SECOND
"""The time at which a simulation begins."""


def hear(node: Middleware, topic: str, kind: type[M], qos: Qos | None = None) -> list[M]:
    """Subscribe to a topic; the messages come into the list."""
    heard: list[M] = []
    node.subscribe(topic, kind, qos or Qos(), lambda many: heard.extend(cdr.decode(kind, data) for data in many))
    return heard


class NodeInMemory:
    """The connection of a node; ``parameters`` makes the node's parameters of its ROS arguments and its logger."""

    def __init__(
        self, held: ExitStack, name: str, given: Sequence[str] = (), parameters: Callable[..., Any] | None = None
    ) -> None:
        """Connect with values of parameters, such as ``use_sim_time:=true``, which begins the time of a simulation."""
        ros = ros_args.parse([word for one in given for word in ("-p", one)], name)
        self.log: list[str] = []
        self.logger = logging.Logger("test")
        self.logger.addHandler(handler := logging.Handler())
        handler.emit = lambda record: self.log.append(record.getMessage())  # type: ignore[method-assign]
        self.parameters = parameters(ros, self.logger) if parameters else None
        self.connection = RosConnection(ros, "memory", held, self.logger.warning, self.parameters)
        self.middleware, self.now = self.connection.middleware, BEGAN
        self._publishers: dict[str, Any] = {}
        if "use_sim_time:=true" in given:
            with repeated(lambda _: self.pass_time(0)):
                assert self.connection.clock.now() == BEGAN

    def publish(self, topic: str, message: Message) -> None:
        """Publish a message."""
        if topic not in self._publishers:
            self._publishers[topic] = self.middleware.publisher(topic, type(message), Qos())
        self._publishers[topic].publish([cdr.encode(message)])

    def pass_time(self, nanoseconds: int) -> None:
        """Let the time of the simulation pass."""
        self.now += nanoseconds
        self.publish("/clock", Clock(Time.since_1970(self.now)))

    def hear(self, topic: str, kind: type[M]) -> list[M]:
        """Subscribe to a topic; the messages come into the list."""
        return hear(self.middleware, topic, kind)
