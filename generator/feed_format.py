"""What mapping.yaml may hold of a topic with a message of ROS 2's common interfaces: its part of the format."""

from __future__ import annotations

from generator.value_types import AnyOf, Boolean, Integer, Key, ListOf, MapOf, Named, Number, Object, Text

FIELD_PATH = Text(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*", "gps_sensor_1")
FIELD_NAME = Text(r"[A-Za-z_][A-Za-z0-9_]*", "imu_info")
_QOS = Object(
    {
        "reliability": Key(Text(choices=("reliable", "best_effort")), "Whether lost messages are sent again."),
        "durability": Key(Text(choices=("volatile", "transient_local")), "Whether late subscribers get the last ones."),
        "history": Key(Text(choices=("keep_last", "keep_all")), "What is kept for slow subscribers."),
        "depth": Key(Integer(1, 1_000_000), "How many are kept with keep_last; the same as the row's queue."),
    }
)
_SOURCE = Text(r"-?[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*", "accel_x")
_ANGLE = Named("target")
_OPTIONS = {
    "from": Key(_SOURCE, "The proto field that it takes; with a - before it, negated."),
    "value": Key(AnyOf((Text(), Number(), Boolean())), "A constant, also a text."),
    "unit": Key(AnyOf((Text(), Integer(1, 1))), "The unit of the proto field."),
    "to": Key(AnyOf((Text(), Integer(1, 1))), "The unit of the target, where its definition does not say."),
    "scale": Key(Number(), "What the number is multiplied by before its unit is converted."),
    "fixed_point": Key(Number(), "What it is divided by instead: 100 for a field of hundredths."),
    "offset": Key(Number(), "What is added after that."),
    "narrow": Key(Boolean(), "Whether a type that holds less may take it; what does not fit is refused."),
    "default": Key(AnyOf((Text(), Number(), Boolean())), "What stands for an absent field, or any other enum value."),
    "enum": Key(MapOf(FIELD_NAME, AnyOf((Text(), Number()))), "What each enum value becomes: a constant or a number."),
    "axes": Key(
        AnyOf((Text(choices=("ned_to_enu", "frd_to_flu")), ListOf(Text(r"-?[xyz]", "-z")))),
        "Which axis of the source each of x, y, z is.",
    ),
    "euler": Key(
        Object(
            {
                "roll": Key(_ANGLE, "About x.", True),
                "pitch": Key(_ANGLE, "About y.", True),
                "yaw": Key(_ANGLE, "About z.", True),
                "unit": Key(Text(), "The unit of the angles."),
            }
        ),
        "A quaternion from angles about the fixed axes.",
    ),
}
TARGET = AnyOf(
    (
        Text(),
        Number(),
        Boolean(),
        ListOf(Number(), unique=False),
        Object(_OPTIONS, others=MapOf(FIELD_NAME, Named("target"))),
    )
)
"""What fills a field of a standard message."""
DEFINITIONS: dict[str, AnyOf] = {"target": TARGET}
_STAMP = AnyOf(
    (
        Text(choices=("receive",)),
        Object(
            {
                "from": Key(_SOURCE, "The proto field: a time since 1970 in UTC.", True),
                "unit": Key(Text(), "Its unit.", True),
            }
        ),
    )
)
STANDARD = {
    "frame_id": Key(Text(), "The coordinate frame, where the message has a header."),
    "stamp": Key(_STAMP, "The header's time: receive, when the datagram came (default), or a proto field."),
    "unset": Key(ListOf(FIELD_PATH), "Fields of the standard message that are left as they are in a new one."),
}
TOPIC = {
    "queue": Key(Integer(1, 1_000_000), "Depth of the publisher's or subscription's queue; 10 where absent."),
    "qos": Key(_QOS, "Quality of service, where it is not rclcpp's default."),
}
FEED = Object(
    {
        "topic": Key(Text(), "ROS 2 topic, relative to the node's namespace.", True),
        "ros": Key(Text(), "The standard message: sensor_msgs/Imu.", True),
        **TOPIC,
        "fields": Key(MapOf(FIELD_PATH, TARGET), "What each field of the message takes."),
        "ignore": Key(ListOf(FIELD_PATH), "Paths of proto fields that the message does not tell."),
        **STANDARD,
    }
)
