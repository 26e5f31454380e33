"""Keys of mapping.yaml, and the classes for its parts, such as a row or a peer.

Each key is declared once, as an attribute of the class for the part that contains the key.

The reader, the JSON Schema, the reference in docs/mapping.md and the defaults all come from these declarations;
`roverlink.generator.table.parts` explains how. To add a key, add one attribute here.
"""

from __future__ import annotations

import keyword
import posixpath
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from ipaddress import IPv6Network, ip_address, ip_network
from typing import Annotated, ClassVar, Literal, TypeAlias

from roverlink.datagram_size import LARGEST_DATAGRAM
from roverlink.generator.diagnostics import Span
from roverlink.generator.ir import LINK_MEMBER, LINK_MESSAGE
from roverlink.generator.ir.model import End, Qos, SendLimits
from roverlink.generator.ir.protobuf_facts import LARGEST_FIELD_NUMBER
from roverlink.generator.ir.ros_names import camel_case, snake_case
from roverlink.generator.table.parts import NAME, NOT_EMPTY, Form, Part, build, object_of
from roverlink.generator.table.value_types import (
    AnyOf,
    Boolean,
    DataRate,
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
from roverlink.transport_addresses import KINDS, names_transport, transport_address

FORMAT_VERSION = 1
USUAL_TARGETS = ("python", "ros2", "markdown")
LEARN = "learn"
"""Host that stands for the source of a peer's last valid datagram."""
_QOS = Qos()

# --- types of value that several keys share ---


def _network_fault(text: str) -> tuple[str, str]:
    """Return the reason why ``text`` is not an IP address or network, and a help text.

    Both are empty if it is an address, or a network without bits set after the prefix, such as ``10.0.0.0/24``.
    """
    try:
        network = ip_network(text, strict=False)
    except ValueError:
        help = "write an IP address or network, such as 10.0.0.7, 10.0.0.0/24 or fd00::/64"
    else:
        # An IPv4 sender is an IPv4 address in the runtime, even if the socket shows it as ::ffff:10.0.0.7.
        mapped = isinstance(network, IPv6Network) and network.network_address.ipv4_mapped is not None
        help = "" if text in (str(network), str(network.network_address)) else f"the network is {network}"
        help = "write it as an IPv4 address or network" if mapped else help
    return ("which is not an address or a network", help) if help else ("", "")


def _host_fault(text: str) -> tuple[str, str]:
    """Return the reason why ``text`` is no IP address, name of a host, or address of a transport, and a help text.

    Both are empty if it is one of them. The runtime checks the node's parameters in the same way.
    """
    if names_transport(text):
        try:
            transport_address(text)
        except ValueError as error:
            return "which is no address of a line", str(error)
        return "", ""
    try:
        ip_address(text)
    except ValueError:
        labels = text.removesuffix(".").split(".")
        is_name = all(map(_HOST_LABEL.fullmatch, labels)) and not labels[-1].isdigit() and len(text) <= 253
    else:
        is_name = True
    help = "write an IP address, the name of a host, or learn (the source of the last valid datagram)"
    return ("", "") if is_name else ("which is neither an IP address nor the name of a host", help)


def _import_fault(name: str) -> tuple[str, str]:
    """Return the reason why ``name`` cannot be the import name of the generated package, and a help text.

    Both are empty if the name can be used.
    """
    first, *_ = parts = name.split(".")
    if word := next(filter(keyword.iskeyword, parts), ""):
        return f"but {word!r} is a Python keyword", "choose another name"
    if first == "roverlink" or first in sys.stdlib_module_names:
        owner = "roverlink itself" if first == "roverlink" else "Python's standard library"
        return f"but {first!r} is a module of {owner}", "choose another name, such as my_rover.generated"
    return "", ""


_HOST_LABEL = re.compile(r"[A-Za-z0-9_]([A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?")
_DOTTED = r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*"
_PROTO_FILE = r"([A-Za-z_][A-Za-z0-9_-]*/)*[A-Za-z_][A-Za-z0-9_-]*\.proto"
_MAINTAINER = r"[^<>&\"]+ <[^<>&\" ]+@[^<>&\" ]+>"

ProtoName = Annotated[str, Text("message name", _DOTTED, "SensorBoardIMUInfo")]
EnumName = Annotated[str, Text("enum name", _DOTTED, "SensorBoardIMUInfo")]
FieldPath = Annotated[str, Text("field path", _DOTTED, "gps_sensor_1")]
FieldName = Annotated[str, Text("field name", r"[A-Za-z_][A-Za-z0-9_]*", "imu_info")]
_PEER = Text("peer name", r"(?!ros$|.*_to_)[a-z][a-z0-9_]*", "hardware (ros and names with _to_ are reserved)")
PeerName = Annotated[str, _PEER]
"""Pattern of a peer's name.

``ros`` and names with ``_to_`` are excluded, so that a direction such as ``a_to_ros`` has only one reading.
"""
Address = Annotated[str, Text("address", r"[0-9A-Fa-f.:]+(/[0-9]{1,3})?", "10.0.0.0/24", fault=_network_fault)]
_HOST = Text("host", rf"[0-9A-Za-z_.:%-]+|({'|'.join(KINDS)}):[^\s,]+", "192.168.0.21", fault=_host_fault)
Hosts = Annotated[Form, AnyOf((_HOST, ListOf(_HOST, least=1)))]
"""One host or several. A host is an IP address, a name, ``learn``, or the address of another transport than UDP."""
BoardName = Annotated[str, Text("board name", r"[A-Za-z][A-Za-z0-9_]*", "ArmBoard")]
Port = Annotated[int, Integer(1, 65_535)]
PythonPackage = Annotated[str, Text("import name", _DOTTED, "my_rover.generated", fault=_import_fault)]
Folder = Annotated[str, Text("folder")]
Topic = Annotated[str, Text("topic")]
RosName = Annotated[str, Text("message name")]
FieldNumber = Annotated[int, Integer(1, LARGEST_FIELD_NUMBER)]
Depth = Annotated[int, Integer(1, 1_000_000)]
Rate = Annotated[int, Integer(1, 1_000_000)]
Size = Annotated[int, Integer(1, LARGEST_DATAGRAM)]
SilenceMs = Annotated[int, Duration(10, 3_600_000)]
Budget = Annotated[int, DataRate(1_000, 1_000_000_000)]

# --- sources of a standard message's fields ---

_SOURCE = Text("field path", rf"-?{_DOTTED}", "accel_x")
_FIELD_NAME = Text("field name", r"[A-Za-z_][A-Za-z0-9_]*", "imu_info")
_TARGET = Named("target", lambda: _target())
OPTIONS = {
    "from": Key(_SOURCE, Meaning("The proto field that gives the value; a - before it negates the value.")),
    "value": Key(AnyOf((Text(), Number(), Boolean())), Meaning("A constant: a number, a text, true or false.")),
    "unit": Key(AnyOf((Text(), Integer(1, 1))), Meaning("The unit of the proto field.")),
    "to": Key(
        AnyOf((Text(), Integer(1, 1))),
        Meaning("The unit of the ROS field, if the definition of the ROS message does not give one."),
    ),
    "scale": Key(Number(), Meaning("A factor for the number, applied before its unit is converted.")),
    "fixed_point": Key(
        Number(), Meaning("A divisor for the number, instead of `scale`: 100 for a field that counts hundredths.")
    ),
    "offset": Key(Number(), Meaning("A number that is added after `scale` or `fixed_point`.")),
    "narrow": Key(
        Boolean(),
        Meaning(
            "If true, the ROS field may have a smaller range than the proto field. A value that does not fit is then "
            "an error at run time."
        ),
    ),
    "default": Key(
        AnyOf((Text(), Number(), Boolean())),
        Meaning(
            "The value if the proto field is absent. With `enum`: the value for every enum value not listed there."
        ),
    ),
    "enum": Key(
        MapOf(_FIELD_NAME, AnyOf((Text(), Number()))),
        Meaning("The constant of the ROS message, or the number, for each value of the proto enum."),
    ),
    "axes": Key(
        AnyOf((Text(choices=("ned_to_enu", "frd_to_flu")), ListOf(Text("axis", r"-?[xyz]", "-z")))),
        Meaning("The proto field's axis for each of x, y and z: `ned_to_enu`, or a list such as `[y, x, -z]`."),
    ),
    "euler": Key(
        Object(
            {
                "roll": Key(_TARGET, Meaning("Angle about x."), True),
                "pitch": Key(_TARGET, Meaning("Angle about y."), True),
                "yaw": Key(_TARGET, Meaning("Angle about z."), True),
                "unit": Key(Text(), Meaning("The unit of the angles.")),
            }
        ),
        Meaning("A quaternion, computed from angles about the fixed axes."),
    ),
}
"""Keys with which an entry under `fields` tells the source of a ROS field.

Any other key of the entry is the name of a field in the nested ROS message.
"""


def _target() -> AnyOf:
    """Return the type of an entry under `fields`: a proto field, a constant, or a mapping of options.

    The type contains itself: the entry for a nested ROS message may have an entry for each field of that message.
    """
    parts = Object(OPTIONS, others=MapOf(_FIELD_NAME, _TARGET))
    return AnyOf((Text(), Number(), Boolean(), ListOf(Number(), unique=False), parts))


_STAMP = AnyOf(
    (
        Text(choices=("receive",)),
        Object(
            {
                "from": Key(
                    _SOURCE,
                    Meaning("The proto field: the time since 1970-01-01 in UTC, or with `clock` that since a start."),
                    True,
                ),
                "unit": Key(Text(), Meaning("The unit of that proto field."), True),
                "clock": Key(
                    Text(choices=("board",)),
                    Meaning("`board`: the field is a counter that the board has started with itself."),
                ),
            }
        ),
    )
)

# --- parts of the table ---


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtoSettings(Part):
    """Settings under `proto`: the place of the .proto files."""

    root: Annotated[Folder, Meaning("Folder from which proto imports are resolved, relative to the table.")]
    exclude: Annotated[
        tuple[Annotated[str, Text(".proto file", r"[^\\]+\.proto", "components/common/message_types.proto")], ...],
        Meaning(
            "Files, relative to the root, that are never compiled. Messages that are declared in them cannot be used."
        ),
    ] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class EnvelopeSettings(Part):
    """Settings under `envelope`: the message that contains every payload."""

    file: Annotated[
        str,
        Text(".proto file", _PROTO_FILE, "components/common/envelope.proto"),
        Meaning("The envelope's file, relative to the proto root."),
    ]
    message: Annotated[ProtoName, Meaning("The envelope's message, by its full name.")]
    oneof: Annotated[FieldName, Meaning("The oneof that holds the payloads.")]
    owner: Annotated[
        Literal["mapping", "proto"],
        Meaning(
            "`mapping`: generate writes the file. `proto`: the file belongs to another repository, and generate "
            "compares it with the rows (ENV105)."
        ),
    ] = "mapping"

    @property
    def link_file(self) -> str:
        """Path of the .proto file that generate writes for the link message: beside the envelope's file."""
        return posixpath.join(posixpath.dirname(self.file), f"{LINK_MEMBER}.proto")


@dataclass(frozen=True, slots=True, kw_only=True)
class RosSettings(Part):
    """Settings under `ros`: the generated ROS 2 package."""

    package: Annotated[str, Text("package name"), Meaning("Name of the ROS 2 interface package.")]
    distro: Annotated[
        Literal["humble", "jazzy", "kilted", "lyrical"] | None,
        Meaning(
            "The ROS 2 distribution whose standard messages are used, if distributions differ.",
            default="only what is the same in all",
        ),
    ] = None
    # package.xml requires a maintainer; example.com is reserved and receives no mail (RFC 2606, section 3)
    maintainer: Annotated[
        str,
        Text("`Name <address>`", _MAINTAINER, "Rover Team <rover@example.com>"),
        Meaning("Maintainer of the ROS 2 package, for its package.xml.", default="a placeholder"),
    ] = "unnamed <unnamed@example.com>"
    version: Annotated[
        str,
        Text("version", r"(0|[1-9][0-9]*)(\.(0|[1-9][0-9]*)){2}", "1.2.0"),
        Meaning("Version of the ROS 2 package, for its package.xml."),
    ] = "0.1.0"
    license: Annotated[
        str,
        Text("license", r"[^<>&\s][^<>&]*", "Apache-2.0"),
        Meaning("License of the ROS 2 package, for its package.xml, as SPDX names it."),
    ] = "Apache-2.0"
    vendor_runtime: Annotated[
        bool,
        Meaning(
            "If true, the ROS 2 package contains roverlink's runtime and the generated Python code, as with "
            "`generate --vendor-runtime`.",
            see="rover.md#the-ros-2-package",
        ),
    ] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class PythonSettings(Part):
    """Settings under `python`: the generated Python package."""

    package: Annotated[
        PythonPackage,
        Meaning(
            "Import name of the generated package. It decides the folder of all generated files, relative to the "
            "table: `my_rover.generated` is in `my_rover/generated/`.",
            see="targets.md#python",
        ),
    ] = "generated"


@dataclass(frozen=True, slots=True, kw_only=True)
class EndSettings(Part):
    """Address of an end of the link: of a peer, or of a board of a peer."""

    host: Annotated[
        Hosts | None,
        Meaning(
            "Default of the node's parameter `<peer>_host`: an IP address, a name, or a list of them, each of which "
            "gets all datagrams. `learn` is the source of the peer's last valid datagram. A multicast group is an "
            "address as well. A serial line, a TCP connection or a CAN bus is one host: "
            "`serial:/dev/ttyACM0?baud=921600`, `tcp:10.0.0.7:7000`, `tcp:0.0.0.0:7000?listen`, "
            "`can:can0?send=0x101&receive=0x102`.",
            default="the host in the parameter `dst_ip`",
            see="operations.md#addresses-of-peers-and-boards",
        ),
    ] = None
    interface: Annotated[
        str,
        Text("network interface", r"[^\s/:]{1,15}", "eth0"),
        Meaning(
            "Network interface through which datagrams to a multicast group leave.",
            default="the one of the computer's default route",
        ),
    ] = ""
    ttl: Annotated[
        Annotated[int, Integer(1, 255)] | None,
        Meaning("Largest number of networks that datagrams to a multicast group cross; 1 crosses no router.", "1"),
    ] = None

    @property
    def hosts(self) -> tuple[str, ...]:
        """Hosts to which datagrams are sent, such as names or IP addresses; empty if the table names none."""
        if self.host is None:
            return ()
        return tuple(str(host.value) for host in (self.host.items if self.host.items is not None else (self.host,)))


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardSettings(EndSettings):
    """Board of a peer, with an address of its own."""

    name: Annotated[BoardName, NAME]
    host: Annotated[
        Hosts,
        Meaning(
            "Default of the node's parameter `<peer>_<board>_host`, as `host` of a peer.",
            see="operations.md#addresses-of-peers-and-boards",
        ),
    ]
    port: Annotated[
        Port,
        Meaning("Default of the node's parameter `<peer>_<board>_port`: a UDP port.", default="`port` of the peer"),
    ] = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class PeerSettings(EndSettings):
    """Peer: a machine that exchanges datagrams with the bridge."""

    name: Annotated[PeerName, NAME]
    prefixes: Annotated[
        tuple[str, ...],
        Meaning(
            "Beginnings of the names of this peer's messages, such as `SensorBoard` (TAB105, NAM102). If there are "
            "several, each is a board of the peer, and the diagnostics and the page show which boards are alive. A "
            "message belongs to the board whose prefix fits its name, the longest one if several fit.",
            see="operations.md#peers-and-boards",
        ),
    ] = ()
    parameter: Annotated[
        str,
        Text("parameter name", r"[a-z][a-z0-9_]*", "dst_b_port"),
        Meaning(
            "The node's parameter that holds this peer's UDP port.",
            default="`dst_a_port`, `dst_b_port`, ... in the alphabetical order of the peers; `<peer>_port` if the peer "
            "has a `host`",
        ),
    ] = ""
    port: Annotated[
        Port,
        Meaning(
            "Default of that parameter: a UDP port. Also the port of the peer's boards that have none.",
            default="6000, 6001, ... in the same order; with `host: learn`, the port from which the peer sends",
        ),
    ] = 0
    boards: Annotated[
        tuple[BoardSettings, ...],
        Meaning(
            "Boards with addresses of their own, by name. A row goes to the board whose name begins the name of its "
            "message, the longest one if several fit, or to the `board` of the row. The node's parameters for a board "
            "`ArmBoard` of the peer `hardware` are `hardware_arm_board_host` and `hardware_arm_board_port`.",
            see="operations.md#addresses-of-peers-and-boards",
        ),
    ] = ()
    max_size: Annotated[
        Size | None,
        Meaning(
            "Largest envelope in bytes that the peer can receive or send, for a microcontroller. Every message to and "
            "from the peer must then have a bounded encoding.",
            see="lint.md#fixed-sizes",
        ),
    ] = None
    strip_trailing_zeros: Annotated[
        bool, Meaning("If true, datagrams to this peer are sent without their trailing zero bytes.")
    ] = False
    sources: Annotated[
        tuple[Address, ...],
        NOT_EMPTY,
        Meaning(
            "IP addresses and networks (`10.0.0.0/24`, `fd00::/64`) of this peer. Datagrams from other addresses, "
            "and payloads that belong to another peer, are dropped and counted.",
            default="any",
            see="security.md",
        ),
    ] = ()
    source_rate: Annotated[
        Annotated[int, Integer(1, 10_000_000)] | None,
        Meaning(
            "Largest number of datagrams per second from each of the peer's `sources`. More are dropped and counted.",
            default="no limit",
        ),
    ] = None

    budget: Annotated[
        Budget | None,
        Meaning(
            "Most data that the bridge sends to this peer in a second: all datagrams with their UDP and IP headers, "
            "which have 28 bytes (IPv4) or 48 bytes (IPv6). If more is to be sent, rows with a larger `priority` go "
            "first, and the oldest datagrams of the lowest priority are dropped and counted.",
            default="no limit",
            see="basestation.md#a-slow-radio",
        ),
    ] = None

    sign: Annotated[
        Literal["required"] | None,
        Meaning(
            "`required`: datagrams from and to this peer must be signed. The bridge drops and counts datagrams "
            "without a valid signature. Needs `signing`.",
            default="datagrams are not signed",
            see="security.md#signed-datagrams",
        ),
    ] = None

    def prefix_of(self, proto: str) -> str:
        """Return the longest of the `prefixes` with which a message's name begins; empty if there is none.

        The prefixes are compared with the name without package, and with the full name.
        """
        return _longest_prefix(self.prefixes, proto)

    @property
    def board_names(self) -> tuple[str, ...]:
        """Names of the boards of the peer: its `boards`, and its `prefixes` if there are several."""
        prefixes = self.prefixes if self.boards or len(self.prefixes) > 1 else ()
        return tuple(dict.fromkeys((*(board.name for board in self.boards), *prefixes)))

    def board_for(self, proto: str) -> str:
        """Return the board whose name begins the name of a message; empty if there is none."""
        return _longest_prefix(self.board_names, proto)

    @property
    def ends(self) -> tuple[tuple[EndSettings, End], ...]:
        """Ends of the link that belong to the peer, each with its settings: its boards, or the peer itself."""
        if not self.boards:
            return ((self, _end(self, self.name, self.name, self.parameter, self.port)),)
        return tuple(
            (board, _end(board, board.name, parameter, f"{parameter}_port", board.port))
            for board in self.boards
            for parameter in [f"{self.name}_{snake_case(board.name)}"]
        )


def _end(settings: EndSettings, name: str, parameter: str, port_parameter: str, port: int) -> End:
    hosts = settings.hosts
    host_parameter = f"{parameter}_host" if hosts else ""
    return End(name, port_parameter, port, ",".join(hosts), host_parameter, settings.interface, settings.ttl)


def _longest_prefix(prefixes: tuple[str, ...], proto: str) -> str:
    """Return the longest of the prefixes with which a message's name, with or without package, begins."""
    names = (proto, proto.rpartition(".")[2])
    fitting = (prefix for prefix in prefixes if any(name.startswith(prefix) for name in names))
    return max(fitting, key=len, default="")


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkSettings(Part):
    """Settings under `link`: the link message, by which both ends of a link compare their schemas and measure the link.

    The link message is a member of the envelope's oneof, like the payload of a row.
    """

    number: Annotated[FieldNumber, Meaning("Field number of the link message in the envelope's oneof.")]
    on_mismatch: Annotated[
        Literal["warn", "refuse"],
        Meaning(
            "What the bridge does with a row whose schema differs at the two ends: `warn` passes its messages on and "
            "logs a warning, `refuse` drops them in both directions. It is the default of the parameter `link_policy`."
        ),
    ] = "warn"

    name: ClassVar[str] = LINK_MEMBER
    proto: ClassVar[str] = LINK_MESSAGE


@dataclass(frozen=True, slots=True, kw_only=True)
class Lowered(Part):
    """Setting under `lint` that gives a rule a lower severity."""

    rule: Annotated[str, Text("rule id", r"[A-Z]{3}[0-9]{3}|[A-Z]+(_[A-Z0-9]+)+", "ENV106"), NAME]
    severity: Annotated[Literal["warning", "hint", "off"], Meaning("The rule's new severity.")]
    reason: Annotated[str, Meaning("The reason for the lower severity, for reviewers.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Bound(Part):
    """Size limit of a field on a microcontroller."""

    length: Annotated[Size | None, Meaning("Largest number of bytes of a `string` or `bytes` field.")] = None
    count: Annotated[Size | None, Meaning("Largest number of values of a repeated field.")] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DeadmanSettings(Part):
    """Settings under `deadman`: the payload that the bridge sends to a peer when the commanding topic is silent."""

    after_ms: Annotated[SilenceMs, Meaning("Longest time that the topic may be silent, such as `500ms`.", key="after")]
    send: Annotated[
        Mapping[FieldPath, Annotated[str, Scalar()]],
        Meaning(
            "The payload that stops the peer: proto fields, with dots into nested messages, and their values. Enum "
            "values are written by name, bytes in hexadecimal. All other fields are zero."
        ),
    ]
    repeat_ms: Annotated[
        SilenceMs, Meaning("Interval at which the payload is sent again while the topic is silent.", key="repeat")
    ] = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class RequestSettings(Part):
    """Settings under `request`: the row that answers the request, and how often the request is repeated."""

    response: Annotated[FieldName, Meaning("Name of the row with the response, which has the other direction.")]
    field: Annotated[
        FieldName | None,
        Meaning(
            "Integer field of both payloads by which a response is found to belong to its request.",
            default="only one request at a time",
        ),
    ] = None
    timeout_ms: Annotated[
        SilenceMs,
        Meaning(
            "Time to wait for the response before the request is sent again. The second wait is twice as long, and "
            "all later ones are four times as long.",
            key="timeout",
        ),
    ] = 500
    attempts: Annotated[
        Annotated[int, Integer(1, 100)], Meaning("How often the request is sent before it counts as unanswered.")
    ] = 5
    service: Annotated[
        str,
        Text("service name"),
        Meaning(
            "ROS 2 service for the request, relative to the node's namespace unless it starts with a slash. A row to a "
            "peer offers it; a row from a peer calls it instead of publishing on the topic.",
            default="none",
        ),
    ] = ""
    srv: Annotated[
        str, Text("service type"), Meaning("Name of the generated service type.", default="the row's name in CamelCase")
    ] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class SendSettings(Part):
    """Settings under `send`: the messages of a topic that are sent to the peer."""

    on_change: Annotated[
        bool, Meaning("If true, a message is sent only if its payload is not the one that was sent last.")
    ] = False
    at_least_ms: Annotated[
        SilenceMs | None,
        Meaning(
            "Longest time in which nothing is sent, such as `1s`. Then the last message is sent again, also if no new "
            "one comes.",
            key="at_least",
        ),
    ] = None

    @property
    def limits(self) -> SendLimits:
        """SendLimits of what is sent."""
        return SendLimits(on_change=self.on_change, at_least_ms=self.at_least_ms)


@dataclass(frozen=True, slots=True, kw_only=True)
class ForwardSettings(SendSettings):
    """Item of `forward` that limits what a peer gets."""

    peer: Annotated[PeerName, Meaning("The peer that also gets the envelope.")]
    max_rate: Annotated[
        Rate | None,
        Meaning(
            "Largest number of messages per second that this peer gets. A message that comes too early waits for its "
            "time, and a newer message replaces it."
        ),
    ] = None

    @property
    def limits(self) -> SendLimits:
        """SendLimits of what is forwarded."""
        return SendLimits(max_rate=self.max_rate, on_change=self.on_change, at_least_ms=self.at_least_ms)


_FORWARD = AnyOf((_PEER, object_of(ForwardSettings)))


@dataclass(frozen=True, slots=True, kw_only=True)
class QosSettings(Part):
    """Quality of service (QoS) of a topic."""

    reliability: Annotated[
        Literal["reliable", "best_effort"],
        Meaning("`reliable` sends lost messages again. A best-effort publisher does not reach a reliable subscriber."),
    ] = _QOS.reliability
    durability: Annotated[
        Literal["volatile", "transient_local"],
        Meaning("With `transient_local`, late subscribers get the last messages."),
    ] = _QOS.durability
    history: Annotated[
        Literal["keep_last", "keep_all"],
        Meaning("Messages that are kept for slow subscribers: the last `depth`, or all."),
    ] = _QOS.history
    depth: Annotated[
        Depth | None,
        Meaning(
            "Number of messages that are kept with `keep_last`; the same as the row's `queue`. With plain DDS, the "
            "bridge's own subscriptions keep at least 256; Cyclone DDS shows this number to `ros2 topic info`.",
            default=str(_QOS.depth),
        ),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StandardTopicSettings(Part):
    """Topic with a standard message: one from a ROS 2 package such as sensor_msgs."""

    topic: Annotated[Topic, Meaning("ROS 2 topic, relative to the node's namespace unless it starts with a slash.")]
    ros: Annotated[RosName, Meaning("The standard message, with its package: `sensor_msgs/Imu`.")]
    queue: Annotated[
        Depth | None,
        Meaning(
            "Depth of the queue of the publisher or subscription; the same as `qos.depth`.", default=str(_QOS.depth)
        ),
    ] = None
    qos: Annotated[
        QosSettings,
        Meaning("Quality of service (QoS), if it differs from rclcpp's default.", default="rclcpp's default"),
    ] = field(default_factory=QosSettings)
    fields: Annotated[
        Mapping[FieldPath, Annotated[Form, _TARGET]],
        Meaning(
            "The source of each field of the ROS message: a proto field, a constant, or a mapping of options.",
            see="conversions.md#standard-messages-and-units",
        ),
    ] = field(default_factory=dict)
    ignore: Annotated[
        tuple[FieldPath, ...],
        Meaning("Only for rows to a peer: paths of proto fields that the ROS message does not set."),
    ] = ()
    frame_id: Annotated[
        str | None,
        Meaning(
            "The coordinate frame, if the standard message has a header.",
            see="conversions.md#standard-messages-and-units",
        ),
    ] = None
    stamp: Annotated[
        Annotated[Form, _STAMP] | None,
        Meaning(
            "The time in the header of a standard message: `receive` (when the datagram arrived), a proto field, or "
            "with `clock: board` the time of measuring by the clock of the board.",
            default="`receive`",
            see="conversions.md#the-time-of-measuring",
        ),
    ] = None
    unset: Annotated[
        tuple[FieldPath, ...], Meaning("Fields of the standard message that keep the value of a new message.")
    ] = ()

    @property
    def profile(self) -> Qos:
        """Quality of service of the topic. Its depth comes from `queue` or `qos.depth`."""
        depth = self.queue or self.qos.depth or _QOS.depth
        return Qos(self.qos.reliability, self.qos.durability, self.qos.history, depth)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row(StandardTopicSettings):
    """Row of the table: one message with its number, direction, peer and topic."""

    number: Annotated[FieldNumber, Meaning("Field number in the envelope's oneof. It must never change.")]
    name: Annotated[
        str,
        Text("field name", r"[A-Za-z][A-Za-z0-9_]*", "imu_info"),  # a class is named after it
        Meaning("Field name in the envelope's oneof; the commands use it as the message's name."),
    ]
    proto: Annotated[ProtoName, Meaning("Full name of the protobuf message, with its proto package if it has one.")]
    ros: Annotated[
        RosName,
        Meaning(
            "Name of the ROS 2 message. With a package (`geometry_msgs/Twist`) it is a standard message.",
            default="the last part of `proto`, in CamelCase",
        ),
    ] = ""
    direction: Annotated[
        str,
        Text("direction", r"[a-z][a-z0-9_]*_to_ros|ros_to_[a-z][a-z0-9_]*", "hardware_to_ros", checked_by_rule=True),
        Meaning("The direction: `<peer>_to_ros` or `ros_to_<peer>`."),
    ]
    board: Annotated[
        BoardName,
        Meaning(
            "The board of the peer that sends or receives the payload.",
            default="the board whose name begins the name of the message",
            see="operations.md#addresses-of-peers-and-boards",
        ),
    ] = ""
    fields: Annotated[
        Mapping[FieldPath, Annotated[Form, _TARGET]],
        Meaning(
            "Renamed fields: the path of a proto field, and the ROS field that gets its value. For a standard message: "
            "the source of each of its fields, as under `also`.",
            see="conversions.md#standard-messages-and-units",
        ),
    ] = field(default_factory=dict)
    ignore: Annotated[tuple[FieldPath, ...], Meaning("Paths of proto fields that have no ROS field.")] = ()
    also: Annotated[tuple[StandardTopicSettings, ...], Meaning("Extra topics with standard messages.")] = ()
    presence: Annotated[
        Mapping[FieldPath, bool],
        Meaning(
            "By the path of a proto field: true if the ROS message has a field `has_<field>`, which is true if the "
            "proto field is set.",
            default="depends on the kind of field",
            see="conversions.md#presence",
        ),
    ] = field(default_factory=dict)
    anys: Annotated[
        Mapping[FieldPath, Annotated[tuple[ProtoName, ...], NOT_EMPTY]],
        Meaning(
            "By the path of a `google.protobuf.Any`: the messages that it may contain.",
            default="any message, as a type URL and bytes",
            see="conversions.md#any",
            key="any",
        ),
    ] = field(default_factory=dict)
    forwards: Annotated[
        tuple[Annotated[Form, _FORWARD], ...],
        Meaning(
            "Other peers that also get the envelope: names, or mappings that limit what a peer gets. Only for rows "
            "from a peer.",
            see="basestation.md#a-slow-radio",
            key="forward",
        ),
    ] = ()
    send: Annotated[
        SendSettings | None,
        Meaning(
            "The messages that are sent, if not all are. Only for rows to a peer.", see="basestation.md#a-slow-radio"
        ),
    ] = None
    bounds: Annotated[
        Mapping[FieldPath, Bound],
        Meaning(
            "Size limits of fields on a microcontroller, by the path of the proto field. The target `nanopb` writes "
            "them for the firmware, and `roverlink lint` computes message sizes with them.",
            see="lint.md#fixed-sizes",
        ),
    ] = field(default_factory=dict)
    expect_rate: Annotated[
        Rate | None,
        Meaning(
            "Smallest number of messages per second that is expected, in either direction. The ROS diagnostics warn "
            "about a lower rate. Without this key, the rate is not checked.",
            see="diagnostics.md",
        ),
    ] = None
    deadman: Annotated[
        DeadmanSettings | None,
        Meaning(
            "The payload that the bridge sends to the peer when the row's topic is silent. Only for rows to a peer.",
            see="operations.md#when-a-command-falls-silent",
        ),
    ] = None
    max_rate: Annotated[
        Rate | None,
        Meaning(
            "Largest number of messages per second that the bridge passes on, in either direction. A message that "
            "comes too early waits for its time, and a newer message replaces it. A `forward` has a rate of its own."
        ),
    ] = None
    request: Annotated[
        RequestSettings | None,
        Meaning(
            "Makes the row a request that another row answers: it is repeated until it is answered, and carried out "
            "once.",
            see="operations.md#requests-that-are-answered",
        ),
    ] = None
    priority: Annotated[
        int,
        Integer(0, 9),
        Meaning(
            "Order in which messages to peers are sent: 9 first. Only for rows to a peer, and for rows with `forward`: "
            "there it is the order within the `budget` of a peer, in which a row with `deadman` counts as 9."
        ),
    ] = 0
    lint: Annotated[
        tuple[Lowered, ...],
        Meaning(
            "Lower severities for diagnostics about this row, its message and nested messages.",
            see="lint.md#lower-the-severity-of-a-rule",
        ),
    ] = ()

    @property
    def service_type(self) -> str:
        """Name of the service type for the row's request; empty if the table names no service for it."""
        if self.request is None or not self.request.service:
            return ""
        return self.request.srv or camel_case(self.name)

    @property
    def standard(self) -> StandardTopicSettings | None:
        """Settings of the row's own topic if its message is a standard message; None otherwise."""
        return self if "/" in self.ros else None

    @property
    def standard_topics(self) -> tuple[StandardTopicSettings, ...]:
        """Settings of each topic of the row with a standard message: its own topic, if it has one, and extra topics."""
        return (self.standard, *self.also) if self.standard else self.also

    @property
    def forward_settings(self) -> tuple[ForwardSettings, ...]:
        """Settings of each peer under `forward`."""
        return tuple(
            (
                build(ForwardSettings, form)
                if form.entries is not None
                else ForwardSettings(span=form.span, spans={"peer": form.span}, peer=str(form.value))
            )
            for form in self.forwards
        )

    @property
    def forward(self) -> tuple[str, ...]:
        """Names of the peers under `forward`."""
        return tuple(settings.peer for settings in self.forward_settings if settings.peer)

    @property
    def renames(self) -> dict[str, str]:
        """Name of the ROS field for each proto field that the row renames. Only for a row with a generated message."""
        return {path: form.value for path, form in self.fields.items() if isinstance(form.value, str)}

    @property
    def inbound(self) -> bool:
        """True if the payload comes from a peer and goes to a topic."""
        return self.direction.endswith("_to_ros")

    @property
    def peer(self) -> str:
        """Name of the peer that sends or receives the payload."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")

    @property
    def ros_span(self) -> Span:
        """Place of the key `ros`. If the row has none, the place of `proto`, from which the name follows."""
        return self.spans.get("ros", self.at("proto"))


@dataclass(frozen=True, slots=True, kw_only=True)
class RetiredRow(Part):
    """Payload that was removed. Its number and its name are never used again."""

    number: Annotated[FieldNumber, Meaning("The field number that the row had; it is never used again.")]
    name: Annotated[FieldName, Meaning("The name that the row had.")]
    proto: Annotated[ProtoName, Meaning("The protobuf message that the row had; its file may be deleted.")]


@dataclass(frozen=True, slots=True, kw_only=True)
class SigningSettings(Part):
    """Settings under `signing`: the envelope's field for signatures, which is outside of the oneof."""

    number: Annotated[FieldNumber, Meaning("Field number of `bytes signature` in the envelope. It must never change.")]

    @property
    def name(self) -> str:
        """Name of the field."""
        return "signature"

    @property
    def proto(self) -> str:
        """Type of the field."""
        return "bytes"


@dataclass(frozen=True, slots=True, kw_only=True)
class EnumSettings(Part):
    """Setting under `enums`: an enum that becomes a ROS message of its own."""

    proto: Annotated[EnumName, NAME]
    ros: Annotated[RosName, Meaning("Name of the ROS 2 message that holds the enum.")]
    field: Annotated[str, Text("field name"), Meaning("The field of that ROS message for the value of the enum.")]


Numbered: TypeAlias = Row | LinkSettings | SigningSettings
"""Part of the table that has a field number in the envelope: a row, the link message, or the signature."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table(Part):
    """Content of mapping.yaml. Rows and other items with mistakes are left out."""

    file: str
    whole: bool
    """False if a row or another item was left out because of a mistake. Rules about missing rows must check this."""
    numbers: frozenset[int]
    """Numbers of the signature and of all rows in the file, also retired ones and rows that were left out."""
    version: Annotated[int, Integer(FORMAT_VERSION, FORMAT_VERSION), Meaning("Version of the table's format.")]
    proto: Annotated[ProtoSettings, Meaning("The place of the `.proto` files.")]
    envelope: Annotated[EnvelopeSettings, Meaning("The message that contains every payload.")]
    ros: Annotated[RosSettings, Meaning("The ROS 2 side.")]
    python: Annotated[PythonSettings, Meaning("The Python side.")] = field(default_factory=PythonSettings)
    peers: Annotated[
        tuple[PeerSettings, ...], Meaning("The machines that exchange datagrams with the bridge, by name.")
    ]
    rows: Annotated[
        tuple[Row, ...], NOT_EMPTY, Meaning("The rows: one for each message, in any order.", key="messages")
    ]
    link: Annotated[
        LinkSettings | None,
        Meaning(
            "The link message, by which the bridge and its peers compare their schemas and measure the link.",
            default="no link message",
            see="operations.md#the-link-message",
        ),
    ] = None
    retired: Annotated[
        tuple[RetiredRow, ...],
        Meaning("Removed payloads. Their numbers and names are reserved in the envelope and never used again."),
    ] = ()
    signing: Annotated[
        SigningSettings | None,
        Meaning(
            "The envelope's field for the signatures of datagrams. `sign` of a peer says that it must sign.",
            default="no signatures",
            see="security.md#signed-datagrams",
        ),
    ] = None
    enums: Annotated[
        tuple[EnumSettings, ...],
        Meaning(
            "Enums, by full name, that become a ROS 2 message of their own. Any other enum becomes an integer field "
            "with constants."
        ),
    ] = ()
    targets: Annotated[
        tuple[Annotated[str, Text("target", r"[a-z][a-z0-9_]*", "nanopb")], ...],
        Meaning("The kinds of files that are generated.", see="targets.md"),
    ] = USUAL_TARGETS
    templates: Annotated[
        tuple[Annotated[str, Text("folder", r"(?!\.\.([/\\]|$)).+", "firmware/templates")], ...],
        Meaning("Folders with your own Jinja templates, relative to the table's folder."),
    ] = ()
    lint: Annotated[tuple[Lowered, ...], Meaning("Lower severities of rules, for the whole table.")] = ()

    @property
    def numbered(self) -> tuple[Numbered, ...]:
        """All fields of the envelope that the table numbers: the `members`, and the signature if there is one."""
        return (*self.members, self.signing) if self.signing else self.members

    @property
    def members(self) -> tuple[Row | LinkSettings, ...]:
        """Members of the envelope's oneof: the rows, and the link message if the table has one."""
        return (*self.rows, self.link) if self.link else self.rows

    def peers_by_name(self) -> dict[str, PeerSettings]:
        """Return the settings of each peer, by the peer's name."""
        return {peer.name: peer for peer in self.peers}

    def board_of(self, row: Row) -> str:
        """Return the board of the row's peer to which the row belongs.

        Return an empty text if the peer is one board, or if neither the row nor its message's name decides.
        """
        peer = self.peers_by_name().get(row.peer)
        return row.board or (peer.board_for(row.proto) if peer is not None else "")

    def and_further(self, targets: tuple[str, ...], templates: tuple[str, ...], vendor_runtime: bool) -> Table:
        """Return a copy of the table with further targets and template folders, without duplicates.

        The place of each is the option of `roverlink generate` that names it. ``vendor_runtime`` is the option of this
        name.
        """
        options = {f"targets.{name}": Span(f"--target {name}") for name in targets}
        options |= {f"templates.{folder}": Span(f"--template {folder}") for folder in templates}
        return replace(
            self,
            spans={**options, **self.spans},
            ros=replace(self.ros, vendor_runtime=self.ros.vendor_runtime or vendor_runtime),
            targets=tuple(dict.fromkeys((*(self.targets or USUAL_TARGETS), *targets))),
            templates=tuple(dict.fromkeys((*self.templates, *templates))),
        )
