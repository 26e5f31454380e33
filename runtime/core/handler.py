"""Base class of generated handlers. A handler converts one row's payload to its ROS 2 message and back.

The ROS 2 message is an object or serialized bytes. A handler uses no socket and no ROS node.
"""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, TypeVar

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

UNSTAMPED = Time()
"""Time zero, used as receive time if a payload was not received from a peer."""

MISFITS = (struct.error, ConversionError, ValueError, TypeError, OverflowError)
"""Exceptions that converting or packing a value may raise if the value does not fit its type."""

P = TypeVar("P", bound="ProtoMessage")
M = TypeVar("M", bound=Message)


@dataclass(frozen=True, slots=True)
class Qos:
    """Quality of service of a topic; the defaults are those of rclcpp."""

    reliability: str = "reliable"
    durability: str = "volatile"
    history: str = "keep_last"
    depth: int = 10


@dataclass(frozen=True, slots=True)
class Deadman:
    """Settings of a row's stop: a datagram that makes the row's peer stop (table key ``deadman``).

    The bridge sends the stop when the row's topic is silent, so that the peer does not continue with an old command.
    """

    after_ms: int
    """Silence in milliseconds after which the stop is sent."""
    send: Mapping[str, Any]
    """Payload of the stop: values by the dotted path of the proto field; all other fields are zero."""
    repeat_ms: int = 1000
    """Interval in milliseconds at which the stop is repeated while the topic is silent."""


class BoardStamp(NamedTuple):
    """Field of a payload that holds the value of the board's clock at the time of measuring."""

    path: tuple[str, ...]
    nanoseconds: int
    """Nanoseconds of one unit of the field."""
    bits: int

    def count(self, payload: ProtoMessage) -> int:
        """Return the value in a payload."""
        value: Any = payload
        for name in self.path:
            value = getattr(value, name)
        return int(value)

    def set(self, payload: ProtoMessage, time: int) -> None:
        """Set the value in a payload to a time since the start of the board, as the board would."""
        *holders, name = self.path
        setattr(reduce(getattr, holders, payload), name, time // self.nanoseconds % 2**self.bits)


@dataclass(frozen=True, slots=True)
class RowService:
    """ROS 2 service for the requests of a row."""

    name: str
    """Name of the service; relative to the node's namespace unless it starts with a slash."""
    request: type[Message]
    """Fields of the row's ROS message without the correlation field."""
    response: type[Message]
    """Text ``error``, then the fields of the response's ROS message without the correlation field."""


@dataclass(frozen=True, slots=True)
class RowRequest:
    """Settings of a row that is a request, which another row answers (table key ``request``)."""

    response: str
    """Name of the row with the response."""
    timeout_ms: int
    """Time in milliseconds to wait for the response before the request is sent again."""
    attempts: int
    """Number of times that the request is sent before it counts as unanswered."""
    field: str = ""
    """Integer field of both payloads by which they belong together; empty if there is one request at a time."""
    service: RowService | None = None

    def number_in(self, payload: Any) -> int:
        """Return the number in the field of a request or response; 0 without a field."""
        return int(getattr(payload, self.field)) if self.field else 0


@dataclass(frozen=True, slots=True)
class SendLimits:
    """Limits of the messages of a row that are sent to a peer; without values, all are sent."""

    max_rate: int | None = None
    """Largest number of messages a second; None for no limit."""
    on_change: bool = False
    """True if a payload is sent only if it is not the last one that was sent."""
    at_least_ms: int | None = None
    """Time in milliseconds without a datagram after which the last one is sent again; None for never."""


@dataclass(frozen=True, slots=True)
class Route:
    """One row of the table: number, payload, topic and direction, with the row's options."""

    number: int
    """Field number in the envelope's oneof. It never changes."""
    name: str
    """Name of the row: the payload's field name in the envelope's oneof, such as ``imu_info``."""
    topic: str
    """ROS 2 topic; relative to the node's namespace unless it starts with a slash."""
    direction: str
    """``<peer>_to_ros`` or ``ros_to_<peer>``, such as ``ros_to_hardware``."""
    qos: Qos = Qos()
    forward: tuple[str, ...] = ()
    """Names of other peers to which the bridge sends a received datagram unchanged."""
    deadman: Deadman | None = None
    max_rate: int | None = None
    """Largest number of messages a second that the bridge passes on; None for no limit.

    A message that comes too early waits, and a newer message replaces it.
    """
    priority: int = 0
    """Priority of a topic whose messages go to a peer; topics with larger numbers are served first.

    It also is the priority within the budget of a peer, for messages to the peer and for forwarded ones.
    """
    send: SendLimits | None = None
    """Limits of what is sent to the row's peer; None if all is sent."""
    forward_limits: tuple[tuple[str, SendLimits], ...] = ()
    """Limits of what is forwarded to other peers, each with the peer's name."""
    expect_rate: int | None = None
    """Expected messages a second; diagnostics warn if the rate is clearly lower. None for no expectation."""
    board: str = ""
    """Board of the peer that sends or receives the payload, such as ``ArmBoard``; empty if the table names none."""
    request: RowRequest | None = None
    """Row that answers the payload, and how often the payload is repeated until then; None if it is no request."""

    @property
    def service_types(self) -> tuple[type[Message], ...]:
        """Request and response of the service for the row's requests; empty without one."""
        service = self.request.service if self.request is not None else None
        return () if service is None else (service.request, service.response)

    @property
    def inbound(self) -> bool:
        """True if the payload comes from a peer and goes to a topic."""
        return self.direction.endswith("_to_ros")

    @property
    def peer(self) -> str:
        """Name of the peer at the other end of the link."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")


class Serialized(NamedTuple):
    """Result of serializing several payloads as ROS 2 messages."""

    messages: list[bytes]
    """Serialized messages of the payloads that fit, in order."""
    misfits: Mapping[int, ConversionError]
    """Errors of the payloads that do not fit, by the payload's index."""


class Handler(ABC, Generic[P, M]):
    """Converter between the protobuf payload of a row and the row's ROS 2 message."""

    route: ClassVar[Route]
    board_stamp: ClassVar[BoardStamp | None] = None
    """Field of the payload from which the stamp of the message follows, by the board's clock; None if none does."""
    payload_type: type[P]
    message_type: type[M]

    @staticmethod
    @abstractmethod
    def to_ros(payload: P) -> M:
        """Convert a payload to its ROS 2 message."""

    @staticmethod
    @abstractmethod
    def from_ros(message: M) -> P:
        """Convert a ROS 2 message to its payload."""

    def to_cdr(self, payload: P, stamp: Time = UNSTAMPED) -> bytes:  # noqa: ARG002  # standard messages need it
        """Convert a payload to its serialized ROS 2 message (CDR).

        ``stamp`` is the receive time; it is used only if the message has a header. Raises `ConversionError` that names
        row and field.
        """
        try:
            return cdr.encode(self.to_ros(payload))
        except MISFITS as error:
            raise self._named(error) from error

    def from_cdr(self, data: bytes) -> P:
        """Parse a serialized ROS 2 message into a payload. Raises `ConversionError` that names row and field."""
        try:
            return self.from_ros(cdr.decode(self.message_type, data))
        except MISFITS as error:
            raise self._named(error) from error

    def _named(self, error: Exception) -> ConversionError:
        """Return a `ConversionError` whose text begins with the row's name and, if known, the field's path."""
        # "imu_info.accel_x: ..." for a field, "imu_info: ..." for an error of the whole message.
        names_field = isinstance(error, ConversionError) and error.field
        return ConversionError(f"{self.route.name}{'.' if names_field else ': '}{error}")


Stamps = Time | Callable[[Handler[Any, Any], Any], Time]
"""Time for the headers of messages: that of reception, or a function that tells it for a handler and a payload."""


# A function, not a method: `help` of a generated handler shows only what programs call.
def all_to_cdr(handler: Handler[P, M], payloads: Sequence[P], stamp: Stamps = UNSTAMPED) -> Serialized:
    """Serialize several payloads of a row as ROS 2 messages; collect the errors instead of raising them."""
    messages: list[bytes] = []
    misfits: dict[int, ConversionError] = {}
    for index, payload in enumerate(payloads):
        try:
            messages.append(handler.to_cdr(payload, stamp if isinstance(stamp, Time) else stamp(handler, payload)))
        except ConversionError as error:
            misfits[index] = error
    return Serialized(messages, misfits)
