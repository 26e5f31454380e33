"""The bridge as the generator knows it, between the table and the files.

Nothing here knows YAML, protobuf's Python classes, Jinja or any target's spelling; a target computes those for itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

from roverlink.generator.ir.interfaces import Interface, Recovered, TargetField


@dataclass(frozen=True, slots=True)
class Member:
    """A payload in the envelope's oneof."""

    number: int
    name: str
    proto: str
    file: str
    """The .proto file of the payload, relative to the proto root."""


@dataclass(frozen=True, slots=True)
class Retired:
    """A payload that is gone."""

    number: int
    name: str
    proto: str


@dataclass(frozen=True, slots=True)
class Burned:
    """A number that stood for several payloads in the past, and will for none any more."""

    number: int
    uses: tuple[str, ...]
    """Their protos."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """The message that carries every payload."""

    file: str
    message: str
    oneof: str
    ours: bool
    """Whether its file is written from the table."""
    members: tuple[Member, ...]
    retired: tuple[Retired, ...]
    burned: tuple[Burned, ...] = ()


@dataclass(frozen=True, slots=True)
class Peer:
    """A machine at the other end of the datagrams."""

    name: str
    parameter: str
    port: int
    strip_trailing_zeros: bool
    prefixes: tuple[str, ...] = ()
    """Starts of the names of its messages, one for each of its boards; empty for any."""
    sources: tuple[str, ...] = ()
    """Addresses and networks from which it speaks; empty for any."""
    source_rate: int | None = None
    """Datagrams a second that are taken from each of its addresses; None for any number."""


@dataclass(frozen=True, slots=True)
class RosType:
    """A field's type: a ROS primitive, ``string``, or a message; or a sequence of it."""

    name: str
    is_message: bool = False
    is_sequence: bool = False
    package: str = ""
    """Of a message of another package; empty for one of the table's own."""


@dataclass(frozen=True, slots=True)
class RosField:
    """A field of a ROS message."""

    name: str
    type: RosType
    comment: str
    enum: str = ""
    """Full name of the proto enum, or of the oneof, whose constants it takes; empty for none."""


@dataclass(frozen=True, slots=True)
class RosConstant:
    """A constant of a ROS message."""

    name: str
    type: str
    value: int
    comment: str
    enum: str
    """Full name of the proto enum, or of the oneof."""


@dataclass(frozen=True, slots=True)
class RosMessage:
    """A message of the ROS 2 interface package."""

    name: str
    fields: tuple[RosField, ...]
    constants: tuple[RosConstant, ...]
    comment: str
    source: str
    """Full name of the proto message or enum from which it is made."""


class ConversionKind(Enum):
    """How one value is converted; each applies element by element to a repeated field, and to a map's values."""

    VALUE = "the same value"
    MESSAGE = "a nested message, converted by its own conversion"
    HELD = "a value in a message of its own, which holds nothing else"
    WELL_KNOWN = "a type of google.protobuf, converted by the runtime"
    JSON = "a google.protobuf.Struct, Value or ListValue, as a text that is empty where it is absent"
    PRESENCE = "whether the field is set"
    EMPTY = "whether the field is set, which is all that a google.protobuf.Empty says"
    WHICH = "which member of a oneof is set"


@dataclass(frozen=True, slots=True)
class Wrapping:
    """A proto message that stands for the one field in it."""

    proto: str
    field: str


@dataclass(frozen=True, slots=True)
class Choice:
    """A member of a oneof."""

    proto: str
    """The field's name."""
    constant: str
    """The constant of the ROS message that says that it is set."""


@dataclass(frozen=True, slots=True)
class FieldConversion:
    """What a ROS field takes from a payload."""

    proto_path: tuple[str, ...]
    """The field's name, after those of the messages that hold it; the oneof's for `WHICH`."""
    ros: RosField
    kind: ConversionKind
    repeated: bool = False
    entry: MapEntry | None = None
    """Of a map: what becomes of its entries. The kind is that of their message then, and says nothing."""
    presence: str = ""
    """The ROS field that says whether it is set; empty where it always is."""
    which: str = ""
    """For a member of a oneof: the ROS field that says which is set."""
    converter: str = ""
    """For `MESSAGE` the ROS message, for `WELL_KNOWN` and `JSON` the runtime's module."""
    member: str = ""
    """The field of the message that holds the value, for `HELD`."""
    wrapping: Wrapping | None = None
    """The proto message around the value."""
    choices: tuple[Choice, ...] = ()
    """The members, for `WHICH`."""


@dataclass(frozen=True, slots=True)
class MapEntry:
    """What becomes of a map's entries: a ROS message with a key and a value."""

    ros: str
    key: FieldConversion
    value: FieldConversion


@dataclass(frozen=True, slots=True)
class Conversion:
    """Between a proto message and a ROS message, both ways."""

    proto: str
    proto_package: str
    """What the full name starts with; empty for none."""
    file: str
    ros: str
    fields: tuple[FieldConversion, ...]

    @property
    def local_name(self) -> str:
        """The proto message's name within its file."""
        return self.proto.removeprefix(f"{self.proto_package}.")


@dataclass(frozen=True, slots=True)
class AnyMember:
    """A message that a google.protobuf.Any may hold."""

    proto: str
    ros: str
    """The ROS message that it becomes."""
    field: str
    constant: str


@dataclass(frozen=True, slots=True)
class AnyConversion:
    """Between a google.protobuf.Any of which the table says what it may hold, and a ROS message."""

    source: str
    """Full name of the proto field."""
    ros: str
    members: tuple[AnyMember, ...]


@dataclass(frozen=True, slots=True)
class Qos:
    """The quality of service of a topic; the defaults are rclcpp's."""

    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"
    history: Literal["keep_last", "keep_all"] = "keep_last"
    depth: int = 10


@dataclass(frozen=True, slots=True)
class Deadman:
    """What a peer is told when the topic that commands it falls silent."""

    after_ms: int
    repeat_ms: int
    send: tuple[tuple[str, bool | int | float | str | bytes], ...]
    """Values by the dotted path of the proto field."""


@dataclass(frozen=True, slots=True)
class StandardTopic:
    """What a payload becomes on a topic with a message of the common interfaces."""

    topic: str
    qos: Qos
    proto: str
    """Full name of the payload's message."""
    proto_package: str
    """What the full name starts with; empty for none."""
    file: str
    """The .proto file of the payload, relative to the proto root."""
    message: str
    """``sensor_msgs/msg/Imu``."""
    fields: tuple[TargetField, ...]
    recovered: tuple[Recovered, ...]
    """What the way back takes, in the order of the payload's fields; empty where there is none."""
    obstacle: str = ""
    """Why there is no way back; empty where there is one."""
    lost: tuple[str, ...] = ()
    """Fields of the payload that the message does not tell."""

    @property
    def local_name(self) -> str:
        """The proto message's name within its file."""
        return self.proto.removeprefix(f"{self.proto_package}.")


@dataclass(frozen=True, slots=True)
class WireSize:
    """The largest encodings of a row, in bytes."""

    payload: int | None
    """None where a field has no bound."""
    datagram: int | None
    """The envelope with the payload."""
    unbounded: str = ""
    """The first field without a bound, from the payload on, with dots; empty where there is none."""


@dataclass(frozen=True, slots=True)
class Route:
    """One row of the table, resolved."""

    number: int
    name: str
    topic: str
    direction: str
    inbound: bool
    """Whether the payload comes from a peer and goes to the topic."""
    qos: Qos
    forward: tuple[str, ...]
    proto: str
    """Full name of the payload's message."""
    conversion: Conversion | None
    """To a message of the package; None where the row becomes a standard message."""
    comment: str = ""
    """The comment of the payload's message."""
    deadman: Deadman | None = None
    max_rate: int | None = None
    """Most messages a second; None for any number."""
    size: WireSize | None = None
    priority: int = 0
    expect_rate: int | None = None
    """Messages a second that diagnostics expect at least."""
    standard: StandardTopic | None = None
    """To a standard message."""
    extra_topics: tuple[StandardTopic, ...] = ()
    """Further topics."""

    @property
    def peer(self) -> str:
        """The name of the peer at the other end."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")

    @property
    def source(self) -> str:
        """Where the messages come from, in words."""
        return f"the peer {self.peer}" if self.inbound else f"the topic {self.topic}"

    @property
    def target(self) -> str:
        """Where the messages go, in words."""
        return f"the topic {self.topic}" if self.inbound else f"the peer {self.peer}"

    @property
    def standard_topics(self) -> tuple[StandardTopic, ...]:
        """Everything that it becomes of standard messages."""
        return (self.standard, *self.extra_topics) if self.standard else self.extra_topics


@dataclass(frozen=True, slots=True)
class WireField:
    """A field as it is on the wire."""

    number: int
    name: str
    type: str
    """The scalar's name, or the full name of the message or enum."""
    label: str
    """``optional`` (it tells *absent* from *zero*), ``required``, ``repeated``; or empty."""
    oneof: str
    """The oneof it stands in; empty for none."""
    comment: str = field(default="", compare=False)
    """The .proto file's; the ledger has none."""


@dataclass(frozen=True, slots=True)
class WireMessage:
    """A message as it is on the wire."""

    name: str
    fields: tuple[WireField, ...]
    """In the order of the numbers."""
    reserved: tuple[tuple[int, int], ...]
    """Ranges of numbers, both ends included."""
    reserved_names: tuple[str, ...]
    map_entry: bool = False
    """Whether it is key and value of a map, and not declared by itself."""
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class WireValue:
    """A declared value of an enum."""

    number: int
    name: str
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class WireEnum:
    """An enum as it is on the wire."""

    name: str
    values: tuple[WireValue, ...]
    """In the order of the numbers."""
    reserved: tuple[tuple[int, int], ...]
    """Ranges of numbers, both ends included."""
    reserved_names: tuple[str, ...]
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class FieldBound:
    """How much a microcontroller has room for in a field."""

    file: str
    """The .proto file, relative to the proto root."""
    message: str
    """Full name of the message."""
    field: str
    is_bytes: bool
    length: int | None
    """Largest number of bytes of a text or of `bytes`."""
    count: int | None
    """Largest number of values."""


@dataclass(frozen=True, slots=True)
class Bridge:
    """Everything that a target needs."""

    table: str
    """The table's file name."""
    package: str
    python_package: str
    """Import name of the generated package."""
    maintainer: str
    """``Name <address>``, of the package."""
    envelope: Envelope
    peers: tuple[Peer, ...]
    routes: tuple[Route, ...]
    messages: tuple[RosMessage, ...]
    nested: tuple[Conversion, ...]
    """Conversions of messages that are in payloads, but are no payload of a row."""
    anys: tuple[AnyConversion, ...]
    wire_messages: tuple[WireMessage, ...]
    wire_enums: tuple[WireEnum, ...]
    bounds: tuple[FieldBound, ...]
    """What the table bounds; options files beside the .proto files may bound more."""
    interfaces: tuple[Interface, ...]
    """The standard messages that the rows need, by name."""
    modules: Mapping[str, str]
    """Text of each module that protoc generated, by path."""
    descriptors: bytes
    """The serialized FileDescriptorSet of the envelope and of all that it imports, without comments."""

    @property
    def folder(self) -> str:
        """The folder of everything that is generated, relative to the table: that of the Python package."""
        return self.python_package.replace(".", "/")

    def conversions(self) -> dict[str, Conversion]:
        """Every conversion, by its ROS message."""
        return {c.ros: c for c in (*self.nested, *(route.conversion for route in self.routes if route.conversion))}
