"""IR of the bridge: routes, messages, conversions, and the wire schema.

Nothing here knows YAML, protobuf's Python classes, Jinja or a target's spelling. All classes are frozen and hold
tuples, so that targets cannot change the input of other targets.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

from roverlink.generator.ir.interfaces import Interface, Recovered, TargetField


@dataclass(frozen=True, slots=True)
class Member:
    """Payload in the envelope's oneof."""

    number: int
    name: str
    proto: str
    file: str
    """.proto file of the payload, relative to the proto root."""


@dataclass(frozen=True, slots=True)
class Retired:
    """Retired payload. The envelope reserves its number and its name."""

    number: int
    name: str
    proto: str


@dataclass(frozen=True, slots=True)
class Burned:
    """Burned number: it had several meanings in the past, and must not be used again."""

    number: int
    uses: tuple[str, ...]
    """Full names of the messages that had the number."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Message that contains every payload."""

    file: str
    message: str
    oneof: str
    ours: bool
    """True if roverlink writes the envelope's file from the table."""
    members: tuple[Member, ...]
    retired: tuple[Retired, ...]
    burned: tuple[Burned, ...] = ()


@dataclass(frozen=True, slots=True)
class Peer:
    """Machine that exchanges datagrams with the bridge."""

    name: str
    parameter: str
    port: int
    strip_trailing_zeros: bool
    prefixes: tuple[str, ...] = ()
    """Prefixes of its messages' names, one for each of its boards; empty if any name is allowed."""
    sources: tuple[str, ...] = ()
    """Addresses and networks of the peer; empty if any address is allowed."""
    source_rate: int | None = None
    """Most datagrams a second from each of its addresses; None for no limit."""


@dataclass(frozen=True, slots=True)
class RosType:
    """Type of a ROS field: a ROS primitive, ``string`` or a message; or a sequence of it."""

    name: str
    is_message: bool = False
    is_sequence: bool = False
    package: str = ""
    """Package of a message of another package; empty for the table's own package."""


@dataclass(frozen=True, slots=True)
class RosField:
    """Field of a ROS message."""

    name: str
    type: RosType
    comment: str
    enum: str = ""
    """Full name of the proto enum or oneof whose constants are the field's values; empty if there is none."""


@dataclass(frozen=True, slots=True)
class RosConstant:
    """Constant of a ROS message."""

    name: str
    type: str
    value: int
    comment: str
    enum: str
    """Full name of the proto enum or oneof."""


@dataclass(frozen=True, slots=True)
class RosMessage:
    """Message of the generated ROS 2 interface package."""

    name: str
    fields: tuple[RosField, ...]
    constants: tuple[RosConstant, ...]
    comment: str
    source: str
    """Full name of the proto message or enum from which it is generated."""


class ConversionKind(Enum):
    """Kind of conversion of a value. A repeated field, or a map's values, are converted one by one."""

    VALUE = "the same value"
    MESSAGE = "a nested message, converted by its own `Conversion`"
    HELD = "a value inside a ROS message that has no other field"
    WELL_KNOWN = "a well-known type of google.protobuf, converted by the runtime"
    JSON = "a google.protobuf.Struct, Value or ListValue, as JSON text; empty if the field is absent"
    PRESENCE = "true if the field is set"
    EMPTY = "true if the google.protobuf.Empty field is set; it has no other content"
    WHICH = "the number of the oneof's member that is set"


@dataclass(frozen=True, slots=True)
class Wrapping:
    """Proto message that wraps a single field."""

    proto: str
    field: str


@dataclass(frozen=True, slots=True)
class Choice:
    """Member of a oneof."""

    proto: str
    """Name of the proto field."""
    constant: str
    """Constant of the ROS message for this member."""


@dataclass(frozen=True, slots=True)
class FieldConversion:
    """Conversion between a proto field and a ROS field."""

    proto_path: tuple[str, ...]
    """Names of the enclosing proto fields, then the field's own name; for `WHICH`, the oneof's name."""
    ros: RosField
    kind: ConversionKind
    repeated: bool = False
    entry: MapEntry | None = None
    """Conversion of a map's entries; None if the field is not a map.

    If set, `kind` describes the entry message and can be ignored.
    """
    presence: str = ""
    """Boolean ROS field that is true if the proto field is set; empty if there is none."""
    which: str = ""
    """For a member of a oneof: ROS field that contains the number of the member that is set."""
    converter: str = ""
    """Name of the ROS message for `MESSAGE`; name of the runtime's module for `WELL_KNOWN` and `JSON`."""
    member: str = ""
    """Field of the ROS message that contains the value, for `HELD`."""
    wrapping: Wrapping | None = None
    """Proto message that wraps the value; None if there is none."""
    choices: tuple[Choice, ...] = ()
    """Members of the oneof, for `WHICH`."""


@dataclass(frozen=True, slots=True)
class MapEntry:
    """Conversion of a map's entries to a ROS message with a key and a value."""

    ros: str
    key: FieldConversion
    value: FieldConversion


@dataclass(frozen=True, slots=True)
class Conversion:
    """Conversion between a proto message and a ROS message, in both directions."""

    proto: str
    proto_package: str
    """Proto package, the start of the full name; empty if there is none."""
    file: str
    ros: str
    fields: tuple[FieldConversion, ...]

    @property
    def local_name(self) -> str:
        """Name of the proto message without its package."""
        return self.proto.removeprefix(f"{self.proto_package}.")


@dataclass(frozen=True, slots=True)
class AnyMember:
    """Message that a google.protobuf.Any may contain."""

    proto: str
    ros: str
    """ROS message to which it is converted."""
    field: str
    constant: str


@dataclass(frozen=True, slots=True)
class AnyConversion:
    """Conversion between a ROS message and a google.protobuf.Any, whose possible messages the table lists."""

    source: str
    """Full name of the proto field."""
    ros: str
    members: tuple[AnyMember, ...]


@dataclass(frozen=True, slots=True)
class Qos:
    """Quality of service (QoS) of a topic; the defaults are rclcpp's."""

    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"
    history: Literal["keep_last", "keep_all"] = "keep_last"
    depth: int = 10


@dataclass(frozen=True, slots=True)
class Deadman:
    """Payload that is sent to a peer when the commanding topic is silent."""

    after_ms: int
    repeat_ms: int
    send: tuple[tuple[str, bool | int | float | str | bytes], ...]
    """Values by the proto field's path, with dots."""


@dataclass(frozen=True, slots=True)
class StandardTopic:
    """Topic with a standard message, and the conversion between it and the payload."""

    topic: str
    qos: Qos
    proto: str
    """Full name of the payload's message."""
    proto_package: str
    """Proto package, the start of the full name; empty if there is none."""
    file: str
    """.proto file of the payload, relative to the proto root."""
    message: str
    """Full name of the standard message, such as ``sensor_msgs/msg/Imu``."""
    fields: tuple[TargetField, ...]
    recovered: tuple[Recovered, ...]
    """Expressions that compute the payload from the message, by the order of its fields; empty if impossible."""
    obstacle: str = ""
    """Reason why the payload cannot be computed from the message; empty if it can."""
    lost: tuple[str, ...] = ()
    """Fields of the payload that the message does not contain."""

    @property
    def local_name(self) -> str:
        """Name of the proto message without its package."""
        return self.proto.removeprefix(f"{self.proto_package}.")

    @property
    def refusal(self) -> str:
        """Error message of the conversion to the payload; empty if it is possible."""
        return self.obstacle and f"{self.message} cannot be converted to {self.local_name}: {self.obstacle}"


@dataclass(frozen=True, slots=True)
class WireSize:
    """Largest encoded sizes of a row in bytes."""

    payload: int | None
    """Size of the payload; None if a field is unbounded."""
    datagram: int | None
    """Size of the envelope with the payload; None if a field is unbounded."""
    unbounded: str = ""
    """Path from the payload to the first unbounded field, with dots; empty if all are bounded."""


@dataclass(frozen=True, slots=True)
class Route:
    """Resolved row of the table."""

    number: int
    name: str
    topic: str
    direction: str
    inbound: bool
    """True if the payload comes from a peer and goes to the topic."""
    qos: Qos
    forward: tuple[str, ...]
    proto: str
    """Full name of the payload's message."""
    conversion: Conversion | None
    """Conversion to a message of the own package; None if the row's topic has a standard message."""
    comment: str = ""
    """Comment of the payload's message in the .proto file."""
    deadman: Deadman | None = None
    max_rate: int | None = None
    """Most messages a second; None for no limit."""
    size: WireSize | None = None
    priority: int = 0
    expect_rate: int | None = None
    """Least messages a second; diagnostics warn below it."""
    standard: StandardTopic | None = None
    """Row's own topic, if it has a standard message."""
    extra_topics: tuple[StandardTopic, ...] = ()
    """Topics with standard messages from `also`."""

    @property
    def peer(self) -> str:
        """The name of the peer at the other end."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")

    @property
    def source(self) -> str:
        """Origin of the messages, in words: a peer or a topic."""
        return f"the peer {self.peer}" if self.inbound else f"the topic {self.topic}"

    @property
    def target(self) -> str:
        """Destination of the messages, in words: a topic or a peer."""
        return f"the topic {self.topic}" if self.inbound else f"the peer {self.peer}"

    @property
    def standard_topics(self) -> tuple[StandardTopic, ...]:
        """Every topic of the route that has a standard message."""
        return (self.standard, *self.extra_topics) if self.standard else self.extra_topics


@dataclass(frozen=True, slots=True)
class WireField:
    """Field of a proto message."""

    number: int
    name: str
    type: str
    """Name of the scalar type, or full name of the message or enum."""
    label: str
    """``optional`` (the field distinguishes *absent* from *zero*), ``required``, ``repeated``; or empty."""
    oneof: str
    """Oneof that contains the field; empty if there is none."""
    comment: str = field(default="", compare=False)
    """Comment in the .proto file; empty for a field from the ledger, which stores no comments."""


@dataclass(frozen=True, slots=True)
class WireMessage:
    """Proto message."""

    name: str
    fields: tuple[WireField, ...]
    """Fields, sorted by number."""
    reserved: tuple[tuple[int, int], ...]
    """Ranges of reserved numbers, both ends included."""
    reserved_names: tuple[str, ...]
    map_entry: bool = False
    """True for the message that protoc generates for the entries of a map."""
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class WireValue:
    """Declared value of an enum."""

    number: int
    name: str
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class WireEnum:
    """Proto enum."""

    name: str
    values: tuple[WireValue, ...]
    """Values, sorted by number."""
    reserved: tuple[tuple[int, int], ...]
    """Ranges of reserved numbers, both ends included."""
    reserved_names: tuple[str, ...]
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class FieldBound:
    """Size limit of a field on a microcontroller."""

    file: str
    """.proto file, relative to the proto root."""
    message: str
    """Full name of the message."""
    field: str
    is_bytes: bool
    length: int | None
    """Largest number of bytes of a `string` or `bytes` field."""
    count: int | None
    """Largest number of values of a repeated field."""


@dataclass(frozen=True, slots=True)
class Bridge:
    """Complete IR: the input of every target."""

    table: str
    """File name of the table."""
    package: str
    python_package: str
    """Import name of the generated package."""
    maintainer: str
    """Maintainer of the ROS 2 package, as ``Name <address>``."""
    envelope: Envelope
    peers: tuple[Peer, ...]
    routes: tuple[Route, ...]
    messages: tuple[RosMessage, ...]
    nested: tuple[Conversion, ...]
    """Conversions of nested messages that are not themselves the payload of a row."""
    anys: tuple[AnyConversion, ...]
    wire_messages: tuple[WireMessage, ...]
    wire_enums: tuple[WireEnum, ...]
    bounds: tuple[FieldBound, ...]
    """Size limits from the table; options files beside the .proto files may set more."""
    interfaces: tuple[Interface, ...]
    """Standard messages that the rows need, sorted by name."""
    modules: Mapping[str, str]
    """Text of each module that protoc generated, by path."""
    descriptors: bytes
    """Serialized FileDescriptorSet of the envelope and its imports, without comments."""

    @property
    def folder(self) -> str:
        """Folder of all generated files, relative to the table; it follows from the Python package."""
        return self.python_package.replace(".", "/")

    def conversions(self) -> dict[str, Conversion]:
        """Return every conversion, by the name of its ROS message."""
        return {c.ros: c for c in (*self.nested, *(route.conversion for route in self.routes if route.conversion))}
