"""Connection of a program to ROS 2: its node, clock and transforms."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from functools import cached_property
from typing import TYPE_CHECKING

from roverlink.nodes import USE_SIM_TIME
from roverlink.runtime.core.errors import MiddlewareError, SetupError
from roverlink.runtime.middleware import Middleware, NodeParameters, open_middleware
from roverlink.runtime.ros_arguments.ros_args import RosArguments, is_topic
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock
from roverlink.runtime.ros_time.simulated_clock import TOPIC, SimulatedClock

if TYPE_CHECKING:
    from roverkit.vision.poses.transform_tree import TransformTree


def uses_simulated_time(ros: RosArguments) -> bool:
    """Return true if the arguments after ``--ros-args`` set ``use_sim_time``. Raises `SetupError` for no boolean."""
    value = ros.parameters.get(USE_SIM_TIME.name, USE_SIM_TIME.default)
    if not isinstance(value, bool):
        raise SetupError(f"the parameter {USE_SIM_TIME.name!r} is {value!r}; it must be true or false")
    return value


def full_topic(name: str, ros: RosArguments) -> str:
    """Return the fully qualified name of a topic that the user has named. Raises `SetupError` if it cannot be one."""
    if not is_topic(name):
        raise SetupError(f"{name!r} is not the name of a topic, such as /camera/image_raw")
    return ros.topic(name)


class RosConnection:
    """Node of a program, opened when something needs ROS 2 first, and closed with a stack of contexts."""

    def __init__(
        self,
        arguments: RosArguments,
        middleware: str,
        stack: ExitStack,
        say: Callable[[str], None],
        parameters: NodeParameters | None = None,
    ) -> None:
        """Connect with a middleware (see `open_middleware`); ``say`` is called with messages for the user."""
        self.arguments, self.topic = arguments, arguments.topic
        self._name, self._stack, self._say, self._parameters = middleware, stack, say, parameters

    @classmethod
    def over(cls, middleware: Middleware, arguments: RosArguments, say: Callable[[str], None]) -> RosConnection:
        """Return the connection of a node that shares a middleware, which is open already."""
        connection = cls(arguments, "", ExitStack(), say)
        connection.middleware = middleware
        return connection

    @cached_property
    def middleware(self) -> Middleware:
        """Middleware of the node."""
        return self._stack.enter_context(open_middleware(self._name, self.arguments.node, self._parameters))

    @cached_property
    def clock(self) -> Clock:
        """Clock of the node: that of the simulation if the parameter ``use_sim_time`` is true."""
        if not uses_simulated_time(self.arguments):
            return SYSTEM_CLOCK
        clock = self._stack.enter_context(SimulatedClock(self.middleware, self.topic(TOPIC), self._say))
        clock.wait()
        return clock

    @cached_property
    def transforms(self) -> TransformTree:
        """Transforms on /tf and /tf_static; none if ROS 2 lacks their messages, of which the user is told."""
        from roverkit.vision.poses.transform_tree import TransformTree
        from roverkit.vision.ros.transform_listener import TransformListener

        try:
            return TransformListener(self.middleware, self.topic, self._say).tree
        except MiddlewareError as error:
            self._say(f"the mounts of the cameras are not received: {error}")
            return TransformTree()
