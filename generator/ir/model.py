"""IR of the bridge: routes (compiled rows), messages, conversions, and the wire schema (numbers, names and types).

Nothing here depends on YAML, on protobuf's Python classes, on Jinja, or on the language of a target. All classes are
frozen and hold tuples, so that targets cannot change the input of other targets.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

from roverlink.generator.ir.interfaces import BoardTime, Interface, Parts, Recovered, TargetField
from roverlink.numerals import counted


@dataclass(frozen=True, slots=True)
class Member:
    """Member of the envelope's oneof: a payload."""

    number: int
    name: str
    """Field name in the oneof, such as ``imu_info``."""
    proto: str
    """Full name of the payload's message."""
    file: str
    """.proto file of the payload, relative to the proto root."""


@dataclass(frozen=True, slots=True)
class Retired:
    """Removed payload. The envelope reserves its number and name, so that no other payload gets them."""

    number: int
    name: str
    proto: str


@dataclass(frozen=True, slots=True)
class Burned:
    """Field number of the envelope that had several meanings in the past, and must never get another one."""

    number: int
    uses: tuple[str, ...]
    """Full names of the messages that had the number."""
    reason: str = ""
    """Why the user accepted the past of the number."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Protobuf message that is sent in each datagram. Its oneof contains one payload."""

    file: str
    message: str
    oneof: str
    ours: bool
    """True if `roverlink generate` writes the envelope's file; False if the file belongs to another repository."""
    members: tuple[Member, ...]
    retired: tuple[Retired, ...]
    burned: tuple[Burned, ...] = ()
    signature: int | None = None
    """Field number of the signature, which is outside of the oneof; None if datagrams are not signed."""


@dataclass(frozen=True, slots=True)
class Link:
    """Link message: member of the envelope by which two ends compare their schemas and measure the link."""

    number: int
    file: str
    """.proto file of the message, relative to the proto root."""
    on_mismatch: Literal["warn", "refuse"]


@dataclass(frozen=True, slots=True)
class End:
    """End of the link, to which datagrams are sent: a peer, or a board of a peer that has boards with addresses."""

    name: str
    parameter: str = ""
    """The node's parameter that holds the UDP port; empty for a peer with boards, which have parameters of their own.
    """
    port: int = 0
    """Default of that parameter; 0 if the port is learned with the address."""
    host: str = ""
    """Names or IP addresses of the hosts with commas between them, or ``learn``; empty if the table names no host."""
    host_parameter: str = ""
    """The node's parameter that holds the host; empty if that is ``dst_ip``, because the table names no host."""
    interface: str = ""
    """Network interface for a multicast group; empty if the table names none."""
    ttl: int | None = None
    """Largest number of networks that datagrams to a multicast group cross; None if the table does not tell."""


@dataclass(frozen=True, slots=True)
class Peer(End):
    """Machine that exchanges datagrams with the bridge. It may consist of several boards."""

    strip_trailing_zeros: bool = False
    prefixes: tuple[str, ...] = ()
    """Beginnings of the names of this peer's messages, such as ``SensorBoard``; empty if any name is allowed."""
    sources: tuple[str, ...] = ()
    """IP addresses and networks from which the peer may send; empty if any address is allowed."""
    source_rate: int | None = None
    """Largest number of datagrams per second that is accepted from each address of the peer; None for no limit."""
    max_size: int | None = None
    """Largest envelope in bytes that the peer can receive or send; None for no limit."""
    budget: int | None = None
    """Most bytes that are sent to the peer in a second, with the headers of IP and UDP; None for no limit."""
    must_sign: bool = False
    """True if datagrams from and to the peer must be signed."""
    boards: tuple[End, ...] = ()
    """Boards of the peer that have addresses of their own; empty if the peer is one end."""

    @property
    def ends(self) -> tuple[End, ...]:
        """Ends of the link that belong to the peer: its boards, or the peer itself."""
        return self.boards or (self,)


@dataclass(frozen=True, slots=True)
class RosType:
    """Type of a ROS field: a primitive, ``string``, a message, or a sequence of one of these."""

    name: str
    is_message: bool = False
    is_sequence: bool = False
    package: str = ""
    """Package of the message, if it is not the generated package; empty otherwise."""


@dataclass(frozen=True, slots=True)
class RosField:
    """Field of a ROS message."""

    name: str
    type: RosType
    comment: str
    enum: str = ""
    """Full name of the proto enum or oneof whose constants are the field's possible values; empty if there is none."""


@dataclass(frozen=True, slots=True)
class RosConstant:
    """Constant that a .msg file declares, such as ``uint8 OK=0``."""

    name: str
    type: str
    value: int
    comment: str
    enum: str
    """Full name of the proto enum or oneof to which the constant belongs."""


@dataclass(frozen=True, slots=True)
class RosMessage:
    """ROS message of the generated interface package: the content of one .msg file."""

    name: str
    fields: tuple[RosField, ...]
    constants: tuple[RosConstant, ...]
    comment: str
    source: str
    """Full name of the proto message, enum or field from which the ROS message is generated."""


class ConversionKind(Enum):
    """Kind of the conversion of one value. In a repeated field or a map, each value is converted on its own."""

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
    """Wrapper message: a proto message that only contains one field, such as google.protobuf.FloatValue."""

    proto: str
    field: str


@dataclass(frozen=True, slots=True)
class Choice:
    """Member of a oneof, with the constant that stands for it in ROS."""

    proto: str
    """Name of the proto field."""
    constant: str
    """Constant of the ROS message that stands for this member."""


@dataclass(frozen=True, slots=True)
class FieldConversion:
    """Conversion between a proto field and a ROS field."""

    proto_path: tuple[str, ...]
    """Path of the proto field: the names of the fields that lead to it, then its own name.

    For `WHICH`, the last name is that of the oneof.
    """
    ros: RosField
    kind: ConversionKind
    repeated: bool = False
    entry: MapEntry | None = None
    """Conversion of a map's entries; None if the field is not a map.

    If it is set, it replaces `kind`.
    """
    presence: str = ""
    """Boolean ROS field that tells if the proto field is set; empty if there is none."""
    which: str = ""
    """ROS field that holds the number of the oneof's member that is set; empty if the field is not in a oneof."""
    converter: str = ""
    """For `MESSAGE`, name of the ROS message of the nested message; for `WELL_KNOWN` and `JSON`, the runtime's module.
    """
    member: str = ""
    """For `HELD`, name of the field inside the ROS message that contains the value."""
    wrapping: Wrapping | None = None
    """Wrapper message that contains the proto value, such as google.protobuf.FloatValue; None if there is none."""
    choices: tuple[Choice, ...] = ()
    """For `WHICH`, the members of the oneof."""


@dataclass(frozen=True, slots=True)
class MapEntry:
    """Conversion of a proto map field: each entry becomes a ROS message with a key and a value."""

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
    """One of the messages that a google.protobuf.Any may contain."""

    proto: str
    ros: str
    """Name of the ROS message to which this message is converted."""
    field: str
    """Field that holds the converted message, in the ROS message for the Any."""
    constant: str
    """Constant that marks this message as the content, in the ROS message for the Any."""


@dataclass(frozen=True, slots=True)
class AnyConversion:
    """Conversion between a google.protobuf.Any and a generated ROS message with a field for each possible content.

    mapping.yaml lists the messages that the Any may contain, under `any`.
    """

    source: str
    """Full name of the proto field with the Any."""
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
    """Payload that the bridge sends to a peer when the topic that commands the peer is silent for too long."""

    after_ms: int
    """Longest silence of the topic in milliseconds, before the payload is sent."""
    repeat_ms: int
    """Interval in milliseconds at which the payload is sent again during the silence."""
    send: tuple[tuple[str, bool | int | float | str | bytes], ...]
    """Path (with dots) and value of each proto field that is set in the payload. All other fields are zero."""


@dataclass(frozen=True, slots=True)
class Service:
    """ROS 2 service for the requests of a row, whose type is generated: the content of one .srv file."""

    name: str
    """Name of the service; relative to the node's namespace unless it starts with a slash."""
    type: str
    """Name of the type, such as ``MeasureRock``."""
    request: RosMessage
    """Fields of the row's ROS message without the correlation field; rosidl names it ``MeasureRock_Request``."""
    response: RosMessage
    """Text of the error, then the fields of the response's ROS message without the correlation field."""


@dataclass(frozen=True, slots=True)
class Request:
    """Settings of a row that is a request, which another row answers."""

    response: str
    """Name of the row with the response."""
    field: str
    """Proto field of both payloads by which they belong together; empty if there is one request at a time."""
    timeout_ms: int
    attempts: int
    service: Service | None


@dataclass(frozen=True, slots=True)
class SendLimits:
    """SendLimits of the messages of a row that are sent to a peer; without values, all are sent."""

    max_rate: int | None = None
    """Largest number of messages per second."""
    on_change: bool = False
    """True if a payload is sent only if it is not the last one that was sent."""
    at_least_ms: int | None = None
    """Time in milliseconds without a datagram after which the last one is sent again."""

    @property
    def text(self) -> str:
        """The limits in words: ``at most 5 messages a second, only changes, again after 1000 ms``."""
        rate = f"at most {counted(self.max_rate, 'message')} a second" if self.max_rate else ""
        again = f"again after {self.at_least_ms} ms" if self.at_least_ms else ""
        return ", ".join(filter(None, (rate, "only changes" if self.on_change else "", again))) or "all messages"


@dataclass(frozen=True, slots=True)
class StandardTopic:
    """Topic with a standard message of ROS 2, and the conversion between this message and the payload."""

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
    """Fields of the standard message from which the payload is computed, in the order of the message's fields.

    Empty if the payload cannot be computed from the message.
    """
    obstacle: str = ""
    """Reason why the payload cannot be computed from the standard message; empty if it can."""
    lost: tuple[str, ...] = ()
    """Paths of the payload's fields that the standard message does not contain, so that their values are lost."""

    @property
    def local_name(self) -> str:
        """Name of the proto message without its package."""
        return self.proto.removeprefix(f"{self.proto_package}.")

    @property
    def board_stamp(self) -> BoardTime | None:
        """Time of measuring by the clock of the board, for the header of the message; None if it is another time."""
        messages = [target.value.fields for target in self.fields if isinstance(target.value, Parts)]
        times = [part.value for parts in messages for part in parts if isinstance(part.value, BoardTime)]
        return times[0] if times else None

    @property
    def refusal(self) -> str:
        """Error message for a conversion of the standard message to the payload; empty if this is possible."""
        return self.obstacle and f"{self.message} cannot be converted to {self.local_name}: {self.obstacle}"


@dataclass(frozen=True, slots=True)
class WireSize:
    """Largest sizes in bytes of a row's encoded payload, and of the datagram that contains it."""

    payload: int | None
    """Size of the payload; None if a field is unbounded."""
    datagram: int | None
    """Size of the envelope with the payload; None if a field is unbounded."""
    unbounded: str = ""
    """Path from the payload to the first unbounded field, with dots; empty if all are bounded."""


@dataclass(frozen=True, slots=True)
class Route:
    """Compiled row of mapping.yaml, with its messages and conversions. Targets generate one handler for each route.

    A row has three forms, because three readers need different things of it. `generator.table.Row` is what the user
    wrote, with the place of each key, for diagnostics. This class adds what the .proto files say, for targets and
    templates. `runtime.core.handler.Route` is what a generated handler tells the bridge, which has no generator.
    """

    number: int
    name: str
    topic: str
    direction: str
    qos: Qos
    forward: tuple[str, ...]
    proto: str
    """Full name of the payload's message."""
    conversion: Conversion | None
    """Conversion to a generated ROS message; None if the row's topic has a standard message."""
    comment: str = ""
    """Comment of the payload's message in the .proto file."""
    deadman: Deadman | None = None
    max_rate: int | None = None
    """Largest number of messages per second that the bridge passes on; None for no limit."""
    size: WireSize | None = None
    priority: int = 0
    send: SendLimits | None = None
    """SendLimits of what is sent to the row's peer; None if the table has none."""
    forward_limits: tuple[tuple[str, SendLimits], ...] = ()
    """SendLimits of what is forwarded to other peers, each with the peer's name."""
    expect_rate: int | None = None
    """Smallest number of messages per second that is expected; below it, diagnostics warn. None for no check."""
    standard: StandardTopic | None = None
    """The row's own topic if it has a standard message; None if it has a generated ROS message."""
    extra_topics: tuple[StandardTopic, ...] = ()
    """Extra topics of the row, which the table lists under `also`."""
    board: str = ""
    """Board of the peer that sends or receives the payload: a prefix of a peer that has several; else empty."""
    schema_hash: int = 0
    """Hash of the payload's wire schema, 32 bits."""
    request: Request | None = None
    """Row that answers the payload, and how often it is repeated until then; None if it is no request."""

    @property
    def inbound(self) -> bool:
        """True if the payload comes from a peer and goes to the topic."""
        return self.direction.endswith("_to_ros")

    @property
    def peer(self) -> str:
        """Name of the peer that sends or receives the payload."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")

    @property
    def source(self) -> str:
        """Sender of the messages, in words for texts: ``the peer hardware`` or ``the topic arm_ctrl``."""
        return f"the peer {self.peer}" if self.inbound else f"the topic {self.topic}"

    @property
    def target(self) -> str:
        """Receiver of the messages, in words for texts: ``the topic imu_data`` or ``the peer hardware``."""
        return f"the topic {self.topic}" if self.inbound else f"the peer {self.peer}"

    @property
    def standard_topics(self) -> tuple[StandardTopic, ...]:
        """Every topic of the row that has a standard message: its own topic, if it has one, and the extra topics."""
        return (self.standard, *self.extra_topics) if self.standard else self.extra_topics


@dataclass(frozen=True, slots=True)
class WireField:
    """Field of a proto message, with the properties that mapping.lock records."""

    number: int
    name: str
    type: str
    """Name of the scalar type, or full name of the message or enum."""
    label: str
    """``optional`` (the field distinguishes *absent* from *zero*), ``required``, ``repeated``; or empty."""
    oneof: str
    """Oneof that contains the field; empty if there is none."""
    comment: str = field(default="", compare=False)
    """Comment in the .proto file. It is empty for a field that was read from the ledger, which stores no comments."""


@dataclass(frozen=True, slots=True)
class WireMessage:
    """Proto message."""

    name: str
    fields: tuple[WireField, ...]
    """Fields of the message, sorted by number."""
    reserved: tuple[tuple[int, int], ...]
    """Ranges of reserved numbers, both ends included."""
    reserved_names: tuple[str, ...]
    map_entry: bool = False
    """True for the message that protoc generates for the entries of a map."""
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class WireValue:
    """Value that an enum declares."""

    number: int
    name: str
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class WireEnum:
    """Proto enum."""

    name: str
    values: tuple[WireValue, ...]
    """Values of the enum, sorted by number."""
    reserved: tuple[tuple[int, int], ...]
    """Ranges of reserved numbers, both ends included."""
    reserved_names: tuple[str, ...]
    comment: str = field(default="", compare=False)


@dataclass(frozen=True, slots=True)
class FieldBound:
    """Size limit of a string, `bytes` or repeated field for microcontrollers, from `bounds` in mapping.yaml."""

    file: str
    """Path of the .proto file that declares the field, relative to the proto root."""
    message: str
    """Full name of the message that contains the field."""
    field: str
    is_bytes: bool
    length: int | None
    """Largest number of bytes of a `string` or `bytes` field."""
    count: int | None
    """Largest number of values of a repeated field."""


@dataclass(frozen=True, slots=True)
class Bridge:
    """Complete intermediate representation of mapping.yaml: the input of every target, which generates files."""

    table: str
    """File name of the table: ``mapping.yaml``."""
    package: str
    python_package: str
    """Import name of the generated package."""
    maintainer: str
    """Maintainer of the ROS 2 package, as ``Name <address>``."""
    version: str
    """Version of the ROS 2 package: three numbers with dots."""
    license: str
    """License of the ROS 2 package."""
    envelope: Envelope
    peers: tuple[Peer, ...]
    routes: tuple[Route, ...]
    messages: tuple[RosMessage, ...]
    nested: tuple[Conversion, ...]
    """Conversions of the messages inside payloads, except of messages that are themselves the payload of a row."""
    anys: tuple[AnyConversion, ...]
    wire_messages: tuple[WireMessage, ...]
    wire_enums: tuple[WireEnum, ...]
    bounds: tuple[FieldBound, ...]
    """Size limits from the table; .options files beside the .proto files may contain more limits."""
    interfaces: tuple[Interface, ...]
    """Standard messages that the rows need, sorted by name."""
    modules: Mapping[str, Mapping[str, str]]
    """Python module and stub that protoc generated of each .proto file: the file, then path and text of both."""
    descriptors: bytes
    """Serialized FileDescriptorSet of the envelope and its imports, without comments."""
    link: Link | None = None
    """Link message; None if the table has none."""
    sources: Mapping[str, str] = field(default_factory=dict)
    """Digest of the table and of each .proto file that it needs, by the path relative to the table."""

    @property
    def folder(self) -> str:
        """Folder of all generated files, relative to the table's folder: ``a/b`` for the Python package ``a.b``."""
        return self.python_package.replace(".", "/")

    @property
    def services(self) -> tuple[Service, ...]:
        """Services with generated types, sorted by type."""
        found = [route.request.service for route in self.routes if route.request and route.request.service]
        return tuple(sorted(found, key=lambda service: service.type))

    def conversions(self) -> dict[str, Conversion]:
        """Return every conversion, by the name of its ROS message."""
        of_routes = [route.conversion for route in self.routes if route.conversion]
        return {conversion.ros: conversion for conversion in (*self.nested, *of_routes)}
