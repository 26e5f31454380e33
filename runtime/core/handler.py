"""What the generated handlers derive from: a route of the table, and the conversion both ways.

A handler owns no socket and no node: it turns a protobuf payload into a ROS 2 message and back, as values or as
serialized bytes.
"""

from __future__ import annotations

import struct
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, TypeVar

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

UNSTAMPED = Time()
"""The time of a payload that came from nowhere."""

MISFITS = (struct.error, ConversionError, ValueError, TypeError, OverflowError)
"""What converting and packing a value that does not fit may raise."""

P = TypeVar("P", bound="ProtoMessage")
M = TypeVar("M", bound=Message)


@dataclass(frozen=True, slots=True)
class Qos:
    """The quality of service of a topic; the defaults are rclcpp's."""

    reliability: str = "reliable"
    durability: str = "volatile"
    history: str = "keep_last"
    depth: int = 10


@dataclass(frozen=True, slots=True)
class Deadman:
    """What a peer is told when the topic that commands it falls silent."""

    after_ms: int
    """How long the topic may be silent."""
    send: Mapping[str, Any]
    """The payload that stops it: values by the dotted path of the proto field; the others are zero."""
    repeat_ms: int = 1000
    """How often that is sent again while the topic is silent."""


@dataclass(frozen=True, slots=True)
class Route:
    """One row of the table: what travels under which number, between which peer and which topic."""

    number: int
    """The field number in the envelope's oneof. Permanent."""
    name: str
    """The field's name in the envelope's oneof."""
    topic: str
    """The ROS 2 topic, relative to the node's namespace unless it starts with a slash."""
    direction: str
    """``<peer>_to_ros`` or ``ros_to_<peer>``."""
    qos: Qos = Qos()
    forward: tuple[str, ...] = ()
    """Peers that also get the raw datagram."""
    deadman: Deadman | None = None
    max_rate: int | None = None
    """Most messages a second, of which the newest pass; None for any number."""
    priority: int = 0
    """Topics to peers are served by it, the largest first."""
    expect_rate: int | None = None
    """Messages a second that diagnostics expect at least; None for any number."""

    @property
    def inbound(self) -> bool:
        """Whether the payload comes from a peer and goes to a topic."""
        return self.direction.endswith("_to_ros")

    @property
    def peer(self) -> str:
        """The peer at the other end."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")


class Serialized(NamedTuple):
    """What became of several payloads."""

    messages: list[bytes]
    """The serialized messages of those that fit, in order."""
    misfits: Mapping[int, ConversionError]
    """The others, by their places among the payloads."""


class Handler(ABC, Generic[P, M]):
    """One row's conversion between its protobuf payload and its ROS 2 message."""

    route: ClassVar[Route]
    payload_type: type[P]
    message_type: type[M]

    @staticmethod
    @abstractmethod
    def to_ros(payload: P) -> M:
        """The ROS 2 message that says what the payload says."""

    @staticmethod
    @abstractmethod
    def from_ros(message: M) -> P:
        """The payload that says what the ROS 2 message says."""

    def pack(self, payload: P) -> bytes:
        """The serialized ROS 2 message of a payload: ``cdr.encode(to_ros(payload))``.

        Generated handlers of messages of fixed size override this with one `struct` call, the bridge's hot path. It
        may raise `struct.error`; use `to_cdr` for an error that names the field.
        """
        return cdr.encode(self.to_ros(payload))

    def to_cdr(self, payload: P, stamp: Time = UNSTAMPED) -> bytes:  # noqa: ARG002  # feeds need it
        """The serialized ROS 2 message of a payload; `ConversionError` names route and field that do not fit.

        ``stamp`` is when the payload was received, for messages that have a header.
        """
        try:
            return self.pack(payload)
        except MISFITS:
            return self._explained(payload)

    def all_to_cdr(self, payloads: Sequence[P], stamp: Time = UNSTAMPED) -> Serialized:
        """As `to_cdr` of each of several payloads, at the price of `pack`; nothing is raised for those that misfit."""
        try:
            return Serialized(self._pack_all(payloads, stamp), {})
        except MISFITS:
            return self._one_by_one(payloads, stamp)

    def _pack_all(self, payloads: Sequence[P], stamp: Time) -> list[bytes]:  # noqa: ARG002  # feeds need it
        return list(map(self.pack, payloads))

    def _one_by_one(self, payloads: Sequence[P], stamp: Time) -> Serialized:
        messages: list[bytes] = []
        misfits: dict[int, ConversionError] = {}
        for index, payload in enumerate(payloads):
            try:
                messages.append(self.to_cdr(payload, stamp))
            except ConversionError as error:
                misfits[index] = error
        return Serialized(messages, misfits)

    def _explained(self, payload: P) -> bytes:
        try:
            return cdr.encode(self.to_ros(payload))
        except MISFITS as error:
            raise self._named(error) from error

    def from_cdr(self, data: bytes) -> P:
        """The payload of a serialized ROS 2 message; `ConversionError` names route and what does not fit."""
        try:
            return self.from_ros(cdr.decode(self.message_type, data))
        except MISFITS as error:
            raise self._named(error) from error

    def _named(self, error: Exception) -> ConversionError:
        """An error with the route before it, and before the field where it names one."""
        names_field = isinstance(error, ConversionError) and error.field
        return ConversionError(f"{self.route.name}{'.' if names_field else ': '}{error}")
