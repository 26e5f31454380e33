"""Typed declarations of ROS 2 nodes: topics with type and QoS, parameters, transforms.

A program declares its node once, in a module that imports no optional package, and opens its topics and parameters from
this declaration. Entry points name the declarations by the names of the programs (module `installed`), so that
check-launch, the documentation and completion know what the programs do.

A part of a name in angle brackets, as in ``aruco/<name>/pose``, stands for any name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import TYPE_CHECKING, Any

from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.following import FollowingSubscription, TypedCallback

if TYPE_CHECKING:
    from roverlink.runtime import Registry
    from roverlink.runtime.middleware.protocol import Callback, Middleware, Publisher, Subscription

FullName = Callable[[str], str]
"""Function that returns the fully qualified name of a topic; remapping can change it."""


class Direction(Enum):
    """Direction of a topic, as its node sees it."""

    PUBLISHED = "published"
    RECEIVED = "received"


@dataclass(frozen=True, slots=True)
class Topic:
    """Topic of a node, in one direction."""

    name: str
    """Name relative to the node's namespace, unless it starts with a slash."""
    types: tuple[type[Message] | str, ...]
    """Type of the messages, as a class or by its full name. If there are several, the publishers decide for one."""
    direction: Direction
    meaning: str
    qos: Qos | None = Qos()  # noqa: RUF009  # it is frozen
    """QoS; None if the subscription takes over that of the publishers."""

    @property
    def type_names(self) -> tuple[str, ...]:
        """Full names of the types, such as ``std_msgs/msg/String``."""
        return tuple(type if isinstance(type, str) else type.__msgtype__ for type in self.types)

    @property
    def message_type(self) -> type[Any]:  # the table decides which fields the message of a row has
        """Class of the messages. Raises `TypeError` if there is not exactly one."""
        (only,) = self.types
        if isinstance(only, str):
            raise TypeError(f"the topic {self.name} has no class of messages")
        return only

    def named(self, part: str) -> Topic:
        """Return this topic with a name in place of the part in angle brackets."""
        return replace(self, name=filled(self.name, part))

    def received(self, meaning: str, qos: Qos) -> Topic:
        """Return this topic of another node as one that is received."""
        return replace(self, direction=Direction.RECEIVED, meaning=meaning, qos=qos)

    def publisher(self, middleware: Middleware, full_name: FullName) -> Publisher:
        """Create the publisher of this topic."""
        return middleware.publisher(full_name(self.name), self.message_type, self.qos or Qos())

    def subscribe(
        self, middleware: Middleware, full_name: FullName, callback: Callback, priority: int = 0
    ) -> Subscription:
        """Subscribe to this topic; see `Middleware.subscribe`."""
        return middleware.subscribe(
            full_name(self.name), self.message_type, self.qos or Qos(), callback, priority=priority
        )

    def follow(
        self, middleware: Middleware, full_name: FullName, callback: TypedCallback, depth: int
    ) -> FollowingSubscription:
        """Subscribe to this topic with one of its types and a matching QoS as soon as `look` finds a publisher."""
        types = [type for type in self.types if not isinstance(type, str)]
        return FollowingSubscription(middleware, full_name(self.name), types, callback, depth)


@dataclass(frozen=True, slots=True)
class RowTopic:
    """Topic of a row of the table, which has its name, its type and its QoS."""

    row: str
    direction: Direction
    meaning: str
    inbound: bool
    """True if the row comes from a peer."""
    fields: tuple[str, ...]
    """Fields of the ROS 2 message that the node uses."""

    def of(self, registry: Registry) -> Topic:
        """Return the topic. Raises `SetupError` if the table lacks the row, or its message lacks a field."""
        handler = registry.row(self.row, self.fields, inbound=self.inbound)
        route = handler.route
        return Topic(route.topic, (handler.message_type,), self.direction, self.meaning, route.qos)


@dataclass(frozen=True, slots=True)
class ExtraTopics:
    """Extra topics of a row (table key ``also``), which a node receives; none if the table has none."""

    row: str
    meaning: str
    direction: Direction = field(default=Direction.RECEIVED, init=False)

    def of(self, registry: Registry) -> tuple[Topic, ...]:
        """Return the topics."""
        return tuple(
            Topic(extra.route.topic, (extra.message_type,), self.direction, self.meaning, extra.route.qos)
            for extra in registry.extra_topics
            if extra.route.name == self.row
        )


ParameterType = type[str] | type[float] | type[int] | type[bool]


@dataclass(frozen=True, slots=True)
class Parameter:
    """ROS 2 parameter of a node."""

    name: str
    type: ParameterType
    meaning: str
    default: str | float | bool | None = None
    """None if the command line or the table gives the first value."""
    read_only: bool = False
    minimum: float | None = None
    maximum: float | None = None
    choices: tuple[str, ...] = ()


USE_SIM_TIME = Parameter(
    "use_sim_time", bool, "true if the time is that of a simulation, on /clock", default=False, read_only=True
)
"""Parameter of every ROS 2 node."""


@dataclass(frozen=True, slots=True)
class Transform:
    """Transform that a node publishes on /tf. The frames are names, or parameters that have them."""

    parent: str | Parameter
    child: str | Parameter
    when: Parameter | None = None
    """Parameter that is true if the transform is published; None if it always is."""


@dataclass(frozen=True, slots=True)
class ActionClient:
    """Action that a node uses."""

    name: str
    type: str
    """Full name of the type, such as ``nav2_msgs/action/BackUp``."""


@dataclass(frozen=True, slots=True)
class NodeDeclaration:
    """Node: its default name, and all that other nodes see of it."""

    name: str
    topics: tuple[Topic | RowTopic | ExtraTopics, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    """Parameters apart from `USE_SIM_TIME`."""
    transforms: tuple[Transform, ...] = ()
    actions: tuple[ActionClient, ...] = ()
    takes_images: bool = False
    """True if the first argument may be ``topic:NAME``, a topic with images that the node receives."""
    other_topics: tuple[str, ...] = ()
    """Names of further topics that options, parameters or files select, such as ``<camera>/aruco/detections``.

    ``/<depth>`` stands for any topic."""

    def topics_with(self, rows: Mapping[str, Sequence[Topic]]) -> Iterator[Topic]:
        """Yield the topics.

        ``rows`` has the topic of each row of a table, and behind it the extra topics, by the row's name. Rows that it
        lacks are left out.
        """
        for topic in self.topics:
            if isinstance(topic, Topic):
                yield topic
            else:
                own, extra = slice(1), slice(1, None)
                for found in rows.get(topic.row, ())[own if isinstance(topic, RowTopic) else extra]:
                    yield replace(found, direction=topic.direction, meaning=topic.meaning)


def filled(name: str, part: str) -> str:
    """Return a name with another text in place of its part in angle brackets."""
    before, _, rest = name.partition("<")
    return f"{before}{part}{rest.partition('>')[2]}" if rest else name
