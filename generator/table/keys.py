"""The keys of mapping.yaml: one declaration each, as an attribute of the part of the table that holds it.

The reader, the JSON Schema, the reference in docs/mapping.md and the defaults follow from these declarations
(`roverlink.generator.table.parts` says how). A new key is one attribute here.
"""

from __future__ import annotations

import keyword
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from ipaddress import IPv4Network
from typing import Annotated, Literal

from roverlink.generator.diagnostics import Span
from roverlink.generator.ir.model import Qos
from roverlink.generator.table.parts import NAME, NOT_EMPTY, Form, Part
from roverlink.generator.table.value_types import (
    AnyOf,
    Boolean,
    Duration,
    Integer,
    Key,
    ListOf,
    MapOf,
    Meaning,
    Named,
    Number,
    Object,
    Scalar,
    Text,
)

FORMAT_VERSION = 1
LARGEST_NUMBER = 536_870_911  # 2**29 - 1, protobuf's largest field number
IMPLEMENTATION_NUMBERS = range(19_000, 20_000)
"""Field numbers that protobuf keeps for itself; protoc refuses them."""
LARGEST_DATAGRAM = 65_507
"""Bytes; what UDP over IPv4 carries."""
USUAL_TARGETS = ("python", "ros2", "markdown")
_QOS = Qos()

# --- types of value that several keys have ---


def _network_fault(text: str) -> tuple[str, str]:
    """Tell why a text is no IPv4 address or network."""
    try:
        network = IPv4Network(text, strict=False)
    except ValueError:
        help = "an IPv4 address or network, such as 10.0.0.7 or 10.0.0.0/24"
    else:
        help = "" if text in (str(network), str(network.network_address)) else f"the network is {network}"
    return ("which is no address and no network", help) if help else ("", "")


def _import_fault(name: str) -> tuple[str, str]:
    """Tell why a dotted name cannot be that of the generated package."""
    first, *_ = parts = name.split(".")
    if word := next(filter(keyword.iskeyword, parts), ""):
        return f"but {word} is a keyword of Python", "choose another name"
    if first == "roverlink" or first in sys.stdlib_module_names:
        owner = "roverlink itself" if first == "roverlink" else "Python's standard library"
        return f"but {first} is a module of {owner}", "choose another name, such as my_rover.generated"
    return "", ""


_DOTTED = r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*"
_PROTO_FILE = r"([A-Za-z_][A-Za-z0-9_]*/)*[A-Za-z_][A-Za-z0-9_]*\.proto"
_MAINTAINER = r"[^<>&\"]+ <[^<>&\" ]+@[^<>&\" ]+>"

ProtoName = Annotated[str, Text("message name", _DOTTED, "SensorBoardIMUInfo")]
EnumName = Annotated[str, Text("enum name", _DOTTED, "SensorBoardIMUInfo")]
FieldPath = Annotated[str, Text("field path", _DOTTED, "gps_sensor_1")]
FieldName = Annotated[str, Text("field name", r"[A-Za-z_][A-Za-z0-9_]*", "imu_info")]
PeerName = Annotated[str, Text("peer", r"(?!ros$|.*_to_)[a-z][a-z0-9_]*", "hardware")]
"""Neither ``ros`` nor with ``_to_`` in it, so that a direction reads in one way."""
Address = Annotated[
    str, Text("address", r"[0-9]{1,3}(\.[0-9]{1,3}){3}(/[0-9]{1,2})?", "10.0.0.0/24", fault=_network_fault)
]
PythonPackage = Annotated[str, Text("import name", _DOTTED, "my_rover.generated", fault=_import_fault)]
Folder = Annotated[str, Text("folder")]
Topic = Annotated[str, Text("topic")]
RosName = Annotated[str, Text("message name")]
FieldNumber = Annotated[int, Integer(1, LARGEST_NUMBER)]
Depth = Annotated[int, Integer(1, 1_000_000)]
Rate = Annotated[int, Integer(1, 1_000_000)]
Size = Annotated[int, Integer(1, LARGEST_DATAGRAM)]
SilenceMs = Annotated[int, Duration(10, 3_600_000)]

# --- what fills a field of a standard message ---

_SOURCE = Text("field path", rf"-?{_DOTTED}", "accel_x")
_FIELD_NAME = Text("field name", r"[A-Za-z_][A-Za-z0-9_]*", "imu_info")
_TARGET = Named("target", lambda: _target())
OPTIONS = {
    "from": Key(_SOURCE, Meaning("The proto field that it takes; with a - before it, negated.")),
    "value": Key(AnyOf((Text(), Number(), Boolean())), Meaning("A constant, also a text.")),
    "unit": Key(AnyOf((Text(), Integer(1, 1))), Meaning("The unit of the proto field.")),
    "to": Key(AnyOf((Text(), Integer(1, 1))), Meaning("The unit of the target, where its definition does not say.")),
    "scale": Key(Number(), Meaning("What the number is multiplied by before its unit is converted.")),
    "fixed_point": Key(Number(), Meaning("What it is divided by instead: 100 for a field of hundredths.")),
    "offset": Key(Number(), Meaning("What is added after that.")),
    "narrow": Key(Boolean(), Meaning("Whether a type that holds less may take it; what does not fit is refused.")),
    "default": Key(
        AnyOf((Text(), Number(), Boolean())), Meaning("What stands for an absent field, or any other enum value.")
    ),
    "enum": Key(
        MapOf(_FIELD_NAME, AnyOf((Text(), Number()))), Meaning("What each enum value becomes: a constant or a number.")
    ),
    "axes": Key(
        AnyOf((Text(choices=("ned_to_enu", "frd_to_flu")), ListOf(Text("axis", r"-?[xyz]", "-z")))),
        Meaning("Which axis of the source each of x, y, z is."),
    ),
    "euler": Key(
        Object(
            {
                "roll": Key(_TARGET, Meaning("About x."), True),
                "pitch": Key(_TARGET, Meaning("About y."), True),
                "yaw": Key(_TARGET, Meaning("About z."), True),
                "unit": Key(Text(), Meaning("The unit of the angles.")),
            }
        ),
        Meaning("A quaternion from angles about the fixed axes."),
    ),
}
"""The options of a field; any other key of its mapping is a part of the field."""


def _target() -> AnyOf:
    """Return what may fill a field of a standard message; the fields of a message in it are filled likewise."""
    parts = Object(OPTIONS, others=MapOf(_FIELD_NAME, _TARGET))
    return AnyOf((Text(), Number(), Boolean(), ListOf(Number(), unique=False), parts))


_STAMP = AnyOf(
    (
        Text(choices=("receive",)),
        Object(
            {
                "from": Key(_SOURCE, Meaning("The proto field: a time since 1970 in UTC."), True),
                "unit": Key(Text(), Meaning("Its unit."), True),
            }
        ),
    )
)

# --- the parts of the table ---


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoSettings(Part):
    """The place of the .proto files."""

    root: Annotated[Folder, Meaning("Folder from which proto imports are resolved, relative to the table.")]
    exclude: Annotated[
        tuple[Annotated[str, Text("file", r"[^\\]+\.proto", "components/common/message_types.proto")], ...],
        Meaning(
            "Files, relative to the root, that never take part in a build. A message that is declared in them cannot "
            "be used."
        ),
    ] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class EnvelopeSettings(Part):
    """The message that carries every payload."""

    file: Annotated[
        str,
        Text("file", _PROTO_FILE, "components/common/envelope.proto"),
        Meaning("The envelope's file, relative to the proto root."),
    ]
    message: Annotated[ProtoName, Meaning("The envelope's message, by its full name.")]
    oneof: Annotated[FieldName, Meaning("The oneof that holds the payloads.")]
    owner: Annotated[
        Literal["mapping", "proto"],
        Meaning(
            "`mapping`: generate writes the file; `proto`: it belongs to another repository, and generate compares it "
            "with the rows (ENV105)."
        ),
    ] = "mapping"


@dataclass(frozen=True, slots=True, kw_only=True)
class RosSettings(Part):
    """The ROS 2 side."""

    package: Annotated[str, Text("package name"), Meaning("Name of the ROS 2 interface package.")]
    distro: Annotated[
        Literal["humble", "jazzy"] | None,
        Meaning(
            "The distribution whose standard messages are meant, where they are not the same in both.",
            default="what both have",
        ),
    ] = None
    # package.xml wants somebody; example.com receives nothing (RFC 2606)
    maintainer: Annotated[
        str,
        Text("`Name <address>`", _MAINTAINER, "Rover Team <rover@example.com>"),
        Meaning("Who is asked about the package; stands in its package.xml.", default="nobody in particular"),
    ] = "unnamed <unnamed@example.com>"


@dataclass(frozen=True, slots=True, kw_only=True)
class PythonSettings(Part):
    """The Python side."""

    package: Annotated[
        PythonPackage,
        Meaning(
            "Import name of the generated package. Its folder follows from it: `my_rover.generated` stands in "
            "`my_rover/generated/`, relative to the table, with everything else that is generated.",
            see="targets.md#python",
        ),
    ] = "generated"


@dataclass(frozen=True, slots=True, kw_only=True)
class PeerSettings(Part):
    """A machine at the other end of the datagrams."""

    name: Annotated[PeerName, NAME]
    prefixes: Annotated[
        tuple[str, ...], Meaning("What the names of this peer's messages start with (TAB105, NAM102).")
    ] = ()
    parameter: Annotated[
        str,
        Text("parameter name", r"[a-z][a-z0-9_]*", "dst_b_port"),
        Meaning(
            "The node's parameter that holds this peer's UDP port.",
            default="`dst_a_port`, `dst_b_port`, ... in the alphabetical order of the peers",
        ),
    ] = ""
    port: Annotated[
        int, Integer(1, 65_535), Meaning("Default of that parameter.", default="6000, 6001, ... in the same order")
    ] = 0
    max_size: Annotated[
        Size | None,
        Meaning(
            "Largest envelope in bytes that the peer can take or send, for a microcontroller. What travels there and "
            "back must then have a bounded encoding.",
            see="lint.md#fixed-sizes",
        ),
    ] = None
    strip_trailing_zeros: Annotated[
        bool, Meaning("Whether datagrams to this peer are sent without their trailing zero bytes.")
    ] = False
    sources: Annotated[
        tuple[Address, ...],
        NOT_EMPTY,
        Meaning(
            "IPv4 addresses and networks (`10.0.0.0/24`) from which this peer speaks. What comes from elsewhere, or "
            "has another peer's payload, is dropped and counted.",
            default="any",
            see="security.md",
        ),
    ] = ()
    source_rate: Annotated[
        Annotated[int, Integer(1, 10_000_000)] | None,
        Meaning(
            "Datagrams a second that are taken from each of the peer's `sources`; more are dropped and counted.",
            default="any number",
        ),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Lowered(Part):
    """A rule whose findings count for less."""

    rule: Annotated[str, Text("rule id", r"[A-Z]{3}[0-9]{3}|[A-Z]+(_[A-Z0-9]+)+", "ENV106"), NAME]
    severity: Annotated[Literal["warning", "hint", "off"], Meaning("What its findings count as.")]
    reason: Annotated[str, Meaning("Why: for whoever reviews it.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound(Part):
    """The room that a microcontroller has for a field."""

    length: Annotated[Size | None, Meaning("Largest number of bytes of a text, or of `bytes`.")] = None
    count: Annotated[Size | None, Meaning("Largest number of values of a repeated field.")] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DeadmanSettings(Part):
    """The payload that a peer is sent when the topic that commands it falls silent."""

    after_ms: Annotated[SilenceMs, Meaning("How long the topic may be silent, such as `500ms`.", key="after")]
    send: Annotated[
        Mapping[FieldPath, Annotated[str, Scalar()]],
        Meaning(
            "What stops it: proto fields, with dots into nested messages, and their values, enum values by name and "
            "bytes in hexadecimal. All other fields are zero."
        ),
    ]
    repeat_ms: Annotated[
        SilenceMs, Meaning("How often that is sent again while the topic is silent.", key="repeat")
    ] = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class QosSettings(Part):
    """The quality of service of a topic."""

    reliability: Annotated[
        Literal["reliable", "best_effort"],
        Meaning("Whether lost messages are sent again. A best-effort publisher does not reach a reliable subscriber."),
    ] = _QOS.reliability
    durability: Annotated[
        Literal["volatile", "transient_local"], Meaning("Whether late subscribers get the last messages.")
    ] = _QOS.durability
    history: Annotated[Literal["keep_last", "keep_all"], Meaning("What is kept for slow subscribers.")] = _QOS.history
    depth: Annotated[
        Depth | None,
        Meaning(
            "How many are kept with `keep_last`; the same as the row's `queue`. Over plain DDS the bridge's own "
            "subscriptions keep 256 where that is more.",
            default=str(_QOS.depth),
        ),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StandardTopicSettings(Part):
    """A topic with a message of ROS 2's common interfaces."""

    topic: Annotated[Topic, Meaning("ROS 2 topic, relative to the node's namespace unless it starts with a slash.")]
    ros: Annotated[RosName, Meaning("The standard message, with its package: `sensor_msgs/Imu`.")]
    queue: Annotated[
        Depth | None,
        Meaning("Depth of the publisher's or subscription's queue; the same as `qos.depth`.", default=str(_QOS.depth)),
    ] = None
    qos: Annotated[
        QosSettings, Meaning("Quality of service, where it is not rclcpp's default.", default="that of rclcpp")
    ] = field(default_factory=QosSettings)
    fields: Annotated[
        Mapping[FieldPath, Annotated[Form, _TARGET]],
        Meaning("What each field of the message takes.", see="conversions.md#standard-messages-and-units"),
    ] = field(default_factory=dict)
    ignore: Annotated[
        tuple[FieldPath, ...], Meaning("Paths of proto fields that the message does not tell, of a row to a peer.")
    ] = ()
    frame_id: Annotated[
        str | None,
        Meaning(
            "The coordinate frame, where the standard message has a header.",
            see="conversions.md#standard-messages-and-units",
        ),
    ] = None
    stamp: Annotated[
        Annotated[Form, _STAMP] | None,
        Meaning(
            "The time of a standard message's header: `receive`, when the datagram came, or a proto field.",
            default="`receive`",
        ),
    ] = None
    unset: Annotated[
        tuple[FieldPath, ...], Meaning("Fields of the standard message that are left as they are in a new one.")
    ] = ()

    @property
    def profile(self) -> Qos:
        """The quality of service with its depth, wherever that is said."""
        depth = self.queue or self.qos.depth or _QOS.depth
        return Qos(self.qos.reliability, self.qos.durability, self.qos.history, depth)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row(StandardTopicSettings):
    """One message: what travels under which number, between which peer and which topic."""

    number: Annotated[FieldNumber, Meaning("Field number in the envelope's oneof. Permanent.")]
    name: Annotated[
        str,
        Text("field name", r"[A-Za-z][A-Za-z0-9_]*", "imu_info"),  # a class is named after it
        Meaning("Field name in the envelope's oneof; the commands know the message by it."),
    ]
    proto: Annotated[
        ProtoName, Meaning("The protobuf message, by its full name (with the proto package, where there is one).")
    ]
    ros: Annotated[
        RosName,
        Meaning(
            "Name of the ROS 2 message; with another package before it (`geometry_msgs/Twist`) a standard one.",
            default="the last part of `proto`, in CamelCase",
        ),
    ] = ""
    direction: Annotated[
        str,
        Text("direction", r"[a-z][a-z0-9_]*_to_ros|ros_to_[a-z][a-z0-9_]*", "hardware_to_ros", checked_by_rule=True),
        Meaning("Who sends: `<peer>_to_ros` or `ros_to_<peer>`."),
    ]
    fields: Annotated[
        Mapping[FieldPath, Annotated[Form, _TARGET]],
        Meaning(
            "Renames: path of a proto field to the ROS field that takes it. Of a standard message: what each of its "
            "fields takes, as in `also`.",
            see="conversions.md#standard-messages-and-units",
        ),
    ] = field(default_factory=dict)
    ignore: Annotated[tuple[FieldPath, ...], Meaning("Paths of proto fields that no ROS field takes.")] = ()
    also: Annotated[
        tuple[StandardTopicSettings, ...], Meaning("Further topics, with messages of ROS 2's common interfaces.")
    ] = ()
    presence: Annotated[
        Mapping[FieldPath, bool],
        Meaning(
            "Whether a field `has_<field>` of the ROS message says that a proto field is set, by its path.",
            default="that of the construct",
            see="conversions.md#presence",
        ),
    ] = field(default_factory=dict)
    anys: Annotated[
        Mapping[FieldPath, Annotated[tuple[ProtoName, ...], NOT_EMPTY]],
        Meaning(
            "The messages that a `google.protobuf.Any` may hold, by its path.",
            default="a type URL and bytes",
            see="conversions.md#any",
            key="any",
        ),
    ] = field(default_factory=dict)
    forward: Annotated[
        tuple[PeerName, ...],
        Meaning(
            "Peers that also get the raw datagram. Only for rows that come from a peer, and not back to the same one."
        ),
    ] = ()
    bounds: Annotated[
        Mapping[FieldPath, Bound],
        Meaning(
            "What a microcontroller has room for, by the path of the proto field. The target `nanopb` writes it for "
            "the firmware, and `roverlink lint` reckons with it.",
            see="lint.md#fixed-sizes",
        ),
    ] = field(default_factory=dict)
    expect_rate: Annotated[
        Rate | None,
        Meaning(
            "Messages a second below which diagnostics warn, in either direction. A row without it may be silent.",
            see="diagnostics.md",
        ),
    ] = None
    deadman: Annotated[
        DeadmanSettings | None,
        Meaning(
            "What the peer is told when the topic that commands it falls silent. Only for rows that go to a peer.",
            see="operations.md#when-a-command-falls-silent",
        ),
    ] = None
    max_rate: Annotated[
        Rate | None,
        Meaning(
            "Most messages a second that pass on, in either direction. What comes too early waits until its time, and "
            "only the newest waits."
        ),
    ] = None
    priority: Annotated[
        int,
        Integer(0, 9),
        Meaning("Topics that are sent to peers are served by it, 9 first. Only for rows that go to a peer."),
    ] = 0
    lint: Annotated[
        tuple[Lowered, ...],
        Meaning(
            "Rules that count for less in what is about this row, its message and those in it.",
            see="lint.md#lower-the-severity-of-a-rule",
        ),
    ] = ()

    @property
    def standard(self) -> StandardTopicSettings | None:
        """The row's own topic, if its message is a standard one."""
        return self if "/" in self.ros else None

    @property
    def standard_topics(self) -> tuple[StandardTopicSettings, ...]:
        """Every topic of the row that has a standard message."""
        return (self.standard, *self.also) if self.standard else self.also

    @property
    def renames(self) -> dict[str, str]:
        """The ROS field that takes each proto field, of a row whose message is of the table's own package."""
        return {path: form.value for path, form in self.fields.items() if isinstance(form.value, str)}

    @property
    def inbound(self) -> bool:
        """Whether the payload comes from a peer and goes to a topic."""
        return self.direction.endswith("_to_ros")

    @property
    def peer(self) -> str:
        """The peer at the other end."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")

    @property
    def ros_span(self) -> Span:
        """The place of the ROS message's name, or of the proto's, from which it is taken."""
        return self.spans.get("ros", self.at("proto"))


@dataclass(frozen=True, slots=True, kw_only=True)
class RetiredRow(Part):
    """A payload that is gone; its number and its name never come back."""

    number: Annotated[FieldNumber, Meaning("The number that never comes back.")]
    name: Annotated[FieldName, Meaning("The name it had.")]
    proto: Annotated[ProtoName, Meaning("The protobuf message it carried; its file need not exist any more.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class EnumSettings(Part):
    """An enum that is a ROS message of its own."""

    proto: Annotated[EnumName, NAME]
    ros: Annotated[RosName, Meaning("Name of the ROS 2 message that holds the enum.")]
    field: Annotated[str, Text("field name"), Meaning("The field of that message that holds the value.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Table(Part):
    """mapping.yaml: all of it, or what of it is whole."""

    file: str
    whole: bool
    """False if something was left out; what concludes from an absence must check this."""
    numbers: frozenset[int]
    """Every number that stands in the file, also in a row that is not whole."""
    version: Annotated[int, Integer(FORMAT_VERSION, FORMAT_VERSION), Meaning("Version of this format.")]
    proto: Annotated[ProtoSettings, Meaning("Where the `.proto` files are.")]
    envelope: Annotated[EnvelopeSettings, Meaning("The message that carries every payload.")]
    ros: Annotated[RosSettings, Meaning("The ROS 2 side.")]
    python: Annotated[PythonSettings, Meaning("The Python side.")] = field(default_factory=PythonSettings)
    peers: Annotated[tuple[PeerSettings, ...], Meaning("The machines at the other end of the datagrams, by name.")]
    rows: Annotated[tuple[Row, ...], NOT_EMPTY, Meaning("The rows: one a message, in any order.", key="messages")]
    retired: Annotated[
        tuple[RetiredRow, ...],
        Meaning("Payloads that are gone; their numbers and names are reserved in the envelope and never come back."),
    ] = ()
    enums: Annotated[
        tuple[EnumSettings, ...],
        Meaning(
            "Enums, by full name, that are a ROS 2 message of their own; any other is an integer with its constants "
            "beside it."
        ),
    ] = ()
    targets: Annotated[
        tuple[Annotated[str, Text("target", r"[a-z][a-z0-9_]*", "nanopb")], ...],
        Meaning("What the table is compiled to.", see="targets.md"),
    ] = USUAL_TARGETS
    templates: Annotated[
        tuple[Annotated[str, Text("folder", r"(?!\.\.([/\\]|$)).+", "firmware/templates")], ...],
        Meaning("Folders of Jinja templates of your own, below that of the table."),
    ] = ()
    lint: Annotated[tuple[Lowered, ...], Meaning("Rules that count for less everywhere.")] = ()

    def peers_by_name(self) -> dict[str, PeerSettings]:
        """The peers by name."""
        return {peer.name: peer for peer in self.peers}

    def and_further(self, targets: tuple[str, ...], templates: tuple[str, ...]) -> Table:
        """Return the same table with more targets and folders of templates, each once."""
        return replace(
            self,
            targets=tuple(dict.fromkeys((*(self.targets or USUAL_TARGETS), *targets))),
            templates=tuple(dict.fromkeys((*self.templates, *templates))),
        )
