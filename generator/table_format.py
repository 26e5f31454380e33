"""What mapping.yaml may hold: its keys, their types and their meaning.

Said once, for the reader (`generator.read`) and for the JSON Schema by which editors complete and check the file.
"""

from __future__ import annotations

from dataclasses import dataclass
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


Type = Text | Integer | Boolean | ListOf | MapOf | Object

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
        "bounds": Key(MapOf(_FIELD_PATH, _BOUND), "Path of a proto field to what a microcontroller has room for."),
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
    if isinstance(type.item, Text):
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
