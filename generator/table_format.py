"""What mapping.yaml may hold: its keys, their types and their meaning.

Said once, for the reader (`generator.read`) and for the JSON Schema (`generator.json_schema`) by which editors complete
and check the file.
"""

from __future__ import annotations

from generator.feed_format import FEED, FIELD_NAME, FIELD_PATH, STANDARD, TARGET, TOPIC
from generator.value_types import Boolean, Duration, Integer, Key, ListOf, MapOf, Network, Object, Scalar, Text

FORMAT_VERSION = 1
LARGEST_NUMBER = 536_870_911  # 2**29 - 1, protobuf's largest field number
IMPLEMENTATION_NUMBERS = range(19_000, 20_000)
"""Field numbers that protobuf keeps for itself; protoc refuses them."""

_PROTO_NAME = Text(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*", "SensorBoardIMUInfo")
_ROW_NAME = Text(r"[A-Za-z][A-Za-z0-9_]*", "imu_info")  # a class is named after it
_ANY_PROTO_FILE = Text(r"[^\\]+\.proto", "components/common/message_types.proto")
_PROTO_FILE = Text(r"([A-Za-z_][A-Za-z0-9_]*/)*[A-Za-z_][A-Za-z0-9_]*\.proto", "components/common/envelope.proto")
_PEER_NAME = Text(r"(?!ros$|.*_to_)[a-z][a-z0-9_]*", "hardware")  # so that a direction reads in one way
_NUMBER = Integer(1, LARGEST_NUMBER)
_DEADMAN = Object(
    {
        "after": Key(Duration(10, 3_600_000), "How long the topic may be silent, such as 500ms.", True),
        "send": Key(MapOf(FIELD_PATH, Scalar()), "What stops it: proto fields and values; others are zero.", True),
        "repeat": Key(Duration(10, 3_600_000), "How often that is sent again while the topic is silent; 1s if absent."),
    }
)
_LOWERED = MapOf(
    Text(r"[A-Z]{3}[0-9]{3}|[A-Z]+(_[A-Z0-9]+)+", "ENV106"),
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
        "ros": Key(
            Text(), "Name of the ROS 2 message; the proto's name where absent. With a package: a standard message."
        ),
        "topic": Key(Text(), "ROS 2 topic, relative to the node's namespace.", True),
        "direction": Key(
            Text(r"[a-z][a-z0-9_]*_to_ros|ros_to_[a-z][a-z0-9_]*", "hardware_to_ros"),
            "<peer>_to_ros or ros_to_<peer>.",
            True,
        ),
        **TOPIC,
        "fields": Key(
            MapOf(FIELD_PATH, TARGET),
            "Renames: path of a proto field to the ROS field that takes it; of a standard message, as in `also`.",
        ),
        "ignore": Key(ListOf(FIELD_PATH), "Paths of proto fields that no ROS field takes."),
        **STANDARD,
        "also": Key(ListOf(FEED), "Further topics, with messages of ROS 2's common interfaces."),
        "presence": Key(
            MapOf(FIELD_PATH, Boolean()), "Whether a ROS field says that a proto field is set, by its path."
        ),
        "any": Key(MapOf(FIELD_PATH, ListOf(_PROTO_NAME, least=1)), "The messages that an Any may hold, by its path."),
        "forward": Key(ListOf(_PEER_NAME), "Peers that also get the raw datagram."),
        "bounds": Key(MapOf(FIELD_PATH, _BOUND), "Path of a proto field to what a microcontroller has room for."),
        "expect_rate": Key(Integer(1, 1_000_000), "Messages a second below which diagnostics warn."),
        "deadman": Key(_DEADMAN, "What a peer is told when the topic that commands it falls silent."),
        "max_rate": Key(Integer(1, 1_000_000), "Most messages a second; of more, the newest passes on."),
        "priority": Key(Integer(0, 9), "Topics to peers are served by it, 9 first; 0 where absent."),
        "lint": Key(_LOWERED, "Rules that count for less in what is about this row, its message and those in it."),
    }
)
RETIRED = Object(
    {
        "number": Key(_NUMBER, "The number that never comes back.", True),
        "name": Key(FIELD_NAME, "The name it had.", True),
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
                    "oneof": Key(FIELD_NAME, "The oneof that holds the payloads.", True),
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
                    "distro": Key(
                        Text(choices=("humble", "jazzy")),
                        "The distribution whose standard messages are meant, where they are not the same in both.",
                    ),
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
