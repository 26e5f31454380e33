"""What mapping.yaml may hold: its keys, their types and their meaning.

Said once, for the reader (`generator.read`) and for the JSON Schema by which editors complete and check the file.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from ipaddress import IPv4Network
from typing import Any

FORMAT_VERSION = 1
LARGEST_NUMBER = 536_870_911  # 2**29 - 1, protobuf's largest field number
IMPLEMENTATION_NUMBERS = range(19_000, 20_000)
"""Field numbers that protobuf keeps for itself; protoc refuses them."""


@dataclass(frozen=True, slots=True)
class Text:
    """A string; ``pattern`` is a regular expression that the whole of it must match."""

    pattern: str = ""
    example: str = ""
    choices: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Integer:
    """A decimal number."""

    minimum: int
    maximum: int


@dataclass(frozen=True, slots=True)
class Boolean:
    """``true`` or ``false``."""


@dataclass(frozen=True, slots=True)
class Duration:
    """A time with its unit, ``500ms`` or ``2s``; in a table it is a number of milliseconds."""

    minimum: int
    """In milliseconds, as `maximum`."""
    maximum: int

    pattern = r"([1-9][0-9]{0,9})(ms|s)"

    def read(self, text: str) -> int | None:
        """The milliseconds that a text says; None where it says none that may stand here."""
        found = re.fullmatch(self.pattern, text)
        milliseconds = int(found[1]) * (1000 if found[2] == "s" else 1) if found else 0
        return milliseconds if self.minimum <= milliseconds <= self.maximum else None


@dataclass(frozen=True, slots=True)
class Network:
    """An IPv4 address, or a network of them, ``10.0.0.0/24``."""

    pattern = r"[0-9]{1,3}(\.[0-9]{1,3}){3}(/[0-9]{1,2})?"

    def fault(self, text: str) -> str:
        """Why a text is none, and what would be one; empty where it is one."""
        try:
            network = IPv4Network(text, strict=False)
        except ValueError:
            return "an IPv4 address or network, such as 10.0.0.7 or 10.0.0.0/24"
        return "" if text in (str(network), str(network.network_address)) else f"the network is {network}"


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number, a text, ``true`` or ``false``, as it is written; who knows its meaning checks it."""


@dataclass(frozen=True, slots=True)
class ListOf:
    """A list of items of one type; no text stands in it twice."""

    item: Type
    least: int = 0


@dataclass(frozen=True, slots=True)
class MapOf:
    """A mapping from names of the user's choice to values of one type."""

    key: Text
    value: Type


@dataclass(frozen=True, slots=True)
class Key:
    """A key of an object: what may stand there, and what it means."""

    type: Type
    meaning: str
    required: bool = False


@dataclass(frozen=True, slots=True)
class Object:
    """A mapping with known keys."""

    keys: dict[str, Key]


Leaf = Text | Integer | Boolean | Duration | Network | Scalar
Type = Leaf | ListOf | MapOf | Object

_PROTO_NAME = Text(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*", "SensorBoardIMUInfo")
_FIELD_PATH = Text(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*", "gps_sensor_1")
_FIELD_NAME = Text(r"[A-Za-z_][A-Za-z0-9_]*", "imu_info")
_ROW_NAME = Text(r"[A-Za-z][A-Za-z0-9_]*", "imu_info")  # a class is named after it
_ANY_PROTO_FILE = Text(r"[^\\]+\.proto", "components/common/message_types.proto")
_PROTO_FILE = Text(r"([A-Za-z_][A-Za-z0-9_]*/)*[A-Za-z_][A-Za-z0-9_]*\.proto", "components/common/envelope.proto")
_PEER_NAME = Text(r"(?!ros$|.*_to_)[a-z][a-z0-9_]*", "hardware")  # so that a direction reads in one way
_NUMBER = Integer(1, LARGEST_NUMBER)
_QOS = Object(
    {
        "reliability": Key(Text(choices=("reliable", "best_effort")), "Whether lost messages are sent again."),
        "durability": Key(Text(choices=("volatile", "transient_local")), "Whether late subscribers get the last ones."),
        "history": Key(Text(choices=("keep_last", "keep_all")), "What is kept for slow subscribers."),
        "depth": Key(Integer(1, 1_000_000), "How many are kept with keep_last; the same as the row's queue."),
    }
)
_DEADMAN = Object(
    {
        "after": Key(Duration(10, 3_600_000), "How long the topic may be silent, such as 500ms.", True),
        "send": Key(MapOf(_FIELD_PATH, Scalar()), "What stops it: proto fields and values; others are zero.", True),
        "repeat": Key(Duration(10, 3_600_000), "How often that is sent again while the topic is silent; 1s if absent."),
    }
)
_LOWERED = MapOf(
    Text(r"[A-Z]{3}[0-9]{3}", "ENV106"),
    Object(
        {
            "severity": Key(Text(choices=("warning", "hint", "off")), "What its findings count as.", True),
            "reason": Key(Text(), "Why: for whoever reviews it.", True),
        }
    ),
)
_BOUND = Object(
    {
        "length": Key(Integer(1, 65_507), "Largest number of bytes of a text, or of `bytes`."),
        "count": Key(Integer(1, 65_507), "Largest number of values of a repeated field."),
    }
)
ROW = Object(
    {
        "number": Key(_NUMBER, "Field number in the envelope's oneof. Permanent.", True),
        "name": Key(_ROW_NAME, "Field name in the envelope's oneof.", True),
        "proto": Key(_PROTO_NAME, "The protobuf message.", True),
        "ros": Key(Text(), "Name of the ROS 2 message; the proto's name where absent."),
        "topic": Key(Text(), "ROS 2 topic, relative to the node's namespace.", True),
        "direction": Key(
            Text(r"[a-z][a-z0-9_]*_to_ros|ros_to_[a-z][a-z0-9_]*", "hardware_to_ros"),
            "<peer>_to_ros or ros_to_<peer>.",
            True,
        ),
        "queue": Key(Integer(1, 1_000_000), "Depth of the publisher's or subscription's queue; 10 where absent."),
        "qos": Key(_QOS, "Quality of service, where it is not rclcpp's default."),
        "fields": Key(MapOf(_FIELD_PATH, Text()), "Renames: path of a proto field to the ROS field that takes it."),
        "ignore": Key(ListOf(_FIELD_PATH), "Paths of proto fields that no ROS field takes."),
        "presence": Key(
            MapOf(_FIELD_PATH, Boolean()), "Whether a ROS field says that a proto field is set, by its path."
        ),
        "any": Key(MapOf(_FIELD_PATH, ListOf(_PROTO_NAME, least=1)), "The messages that an Any may hold, by its path."),
        "recursion": Key(Integer(1, 16), "How many levels of a message that holds itself are carried."),
        "forward": Key(ListOf(_PEER_NAME), "Peers that also get the raw datagram."),
        "expect_rate": Key(Integer(1, 1_000_000), "Messages a second below which diagnostics warn."),
        "bounds": Key(MapOf(_FIELD_PATH, _BOUND), "Path of a proto field to what a microcontroller has room for."),
        "deadman": Key(_DEADMAN, "What a peer is told when the topic that commands it falls silent."),
        "max_rate": Key(Integer(1, 1_000_000), "Most messages a second; of more, the newest passes on."),
        "priority": Key(Integer(0, 9), "Topics to peers are served by it, 9 first; 0 where absent."),
        "lint": Key(_LOWERED, "Rules that count for less in what is about this row, its message and those in it."),
    }
)
RETIRED = Object(
    {
        "number": Key(_NUMBER, "The number that never comes back.", True),
        "name": Key(_FIELD_NAME, "The name it had.", True),
        "proto": Key(_PROTO_NAME, "The protobuf message it carried.", True),
    }
)
ENUM = Object(
    {
        "ros": Key(Text(), "Name of the ROS 2 message that holds the enum.", True),
        "field": Key(Text(), "The field of that message that holds the value.", True),
    }
)
TABLE = Object(
    {
        "version": Key(Integer(FORMAT_VERSION, FORMAT_VERSION), "Version of this format.", True),
        "proto": Key(
            Object(
                {
                    "root": Key(Text(), "Folder from which proto imports are resolved.", True),
                    "exclude": Key(ListOf(_ANY_PROTO_FILE), "Files that never take part in a build."),
                }
            ),
            "Where the .proto files are.",
            True,
        ),
        "envelope": Key(
            Object(
                {
                    "file": Key(_PROTO_FILE, "The envelope's file, relative to the proto root.", True),
                    "message": Key(_PROTO_NAME, "The envelope's message.", True),
                    "oneof": Key(_FIELD_NAME, "The oneof that holds the payloads.", True),
                    "owner": Key(
                        Text(choices=("mapping", "proto")),
                        "mapping: generate writes the file (default); proto: it is another's, and is checked.",
                    ),
                }
            ),
            "The message that carries every payload.",
            True,
        ),
        "ros": Key(
            Object(
                {
                    "package": Key(Text(), "Name of the ROS 2 interface package.", True),
                    "maintainer": Key(
                        Text(r"[^<>&\"]+ <[^<>&\" ]+@[^<>&\" ]+>", "Rover Team <rover@example.com>"),
                        "Who is asked about the package; stands in its package.xml.",
                    ),
                }
            ),
            "The ROS 2 side.",
            True,
        ),
        "peers": Key(
            MapOf(
                _PEER_NAME,
                Object(
                    {
                        "prefixes": Key(ListOf(Text()), "What the names of this peer's messages start with."),
                        "parameter": Key(
                            Text(r"[a-z][a-z0-9_]*", "dst_b_port"),
                            "The node's parameter with this peer's UDP port; by default dst_a_port, dst_b_port, "
                            "... in the alphabetical order of the peers.",
                        ),
                        "port": Key(Integer(1, 65_535), "Default of that parameter; 6000, 6001, ... where absent."),
                        "max_size": Key(
                            Integer(1, 65_507),
                            "Largest envelope in bytes that the peer can take or send, for a microcontroller: what "
                            "travels there and back must then have a bounded encoding.",
                        ),
                        "strip_trailing_zeros": Key(
                            Boolean(), "Whether datagrams to this peer are sent without their trailing zero bytes."
                        ),
                        "sources": Key(
                            ListOf(Network(), least=1),
                            "Addresses and networks from which this peer speaks; any where absent.",
                        ),
                        "source_rate": Key(
                            Integer(1, 10_000_000),
                            "Datagrams a second that are taken from each of its addresses; any number where absent.",
                        ),
                    }
                ),
            ),
            "The machines at the other end of the datagrams.",
            True,
        ),
        "messages": Key(ListOf(ROW, least=1), "The rows: one a message.", True),
        "retired": Key(
            ListOf(RETIRED),
            "Payloads that are gone; their numbers never come back.",
        ),
        "enums": Key(
            MapOf(
                _PROTO_NAME,
                ENUM,
            ),
            "Enums that are a ROS 2 message of their own; any other is an integer with its constants beside it.",
        ),
        "targets": Key(ListOf(Text(r"[a-z][a-z0-9_]*", "nanopb")), "What the table is compiled to."),
        "templates": Key(ListOf(Text()), "Folders of Jinja templates of your own, relative to the table."),
        "lint": Key(_LOWERED, "Rules that count for less everywhere."),
    }
)


def json_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of mapping.yaml."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "roverlink mapping.yaml",
        **_schema_of(TABLE),
    }


def _schema_of(type: Type) -> dict[str, Any]:
    if isinstance(type, Integer):
        return {"type": "integer", "minimum": type.minimum, "maximum": type.maximum}
    if isinstance(type, Boolean):
        return {"type": "boolean"}
    if isinstance(type, Scalar):
        return {"type": ["string", "number", "boolean"]}
    if isinstance(type, (Duration, Network)):
        return {"type": "string", "pattern": f"^({type.pattern})$"}
    if isinstance(type, ListOf):
        return _list_schema(type)
    if isinstance(type, MapOf):
        names = {"pattern": f"^({type.key.pattern})$"} if type.key.pattern else {}
        return {"type": "object", "propertyNames": names, "additionalProperties": _schema_of(type.value)}
    if isinstance(type, Object):
        return _object_schema(type)
    return _text_schema(type)


def _list_schema(type: ListOf) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": "array", "items": _schema_of(type.item)}
    if type.least:
        schema["minItems"] = type.least
    if isinstance(type.item, (Text, Network)):
        schema["uniqueItems"] = True
    return schema


def _text_schema(type: Text) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": "string"} if type.choices or type.pattern else {"type": "string", "minLength": 1}
    if type.choices:
        schema["enum"] = list(type.choices)
    if type.pattern:
        schema["pattern"] = f"^({type.pattern})$"
    return schema


def _object_schema(type: Object) -> dict[str, Any]:
    return {
        "type": "object",
        "additionalProperties": False,
        "required": [name for name, key in type.keys.items() if key.required],
        "properties": {name: {"description": key.meaning, **_schema_of(key.type)} for name, key in type.keys.items()},
    }
