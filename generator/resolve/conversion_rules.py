"""Rules about the conversion of proto messages to generated ROS messages."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity


class CannotConvert(Rule, id="CNV101"):
    """A proto message cannot become a ROS message.

    The reason is one of these. The message contains itself, which ROS does not allow. A name is a Python keyword, is
    not allowed in ROS, or hides a name that the generated code needs. An optional message has its fields moved into the
    outer message, so subscribers could not see if it was set.

    Bad::

        message Imu {
          Imu previous = 1;
        }

    Good::

        message Imu {
          Sample previous = 1;
        }
        message Sample { float x = 1; }
    """


class UnmappedField(Rule, id="CNV102"):
    """`fields` moves fields of a nested message into the outer message, but does not list all of these fields.

    Give the missing field a ROS field under `fields`, or list it under `ignore`. No field is dropped silently.

    Bad::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {accel.x: accel_x}}
        # proto/imu.proto
        message Imu { Accel accel = 1; }
        message Accel { float x = 1; float y = 2; }

    Good::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros,
           fields: {accel.x: accel_x}, ignore: [accel.y]}
        # proto/imu.proto
        message Imu { Accel accel = 1; }
        message Accel { float x = 1; float y = 2; }
    """


class UnknownField(Rule, id="CNV103"):
    """A path under `fields`, `ignore`, `presence` or `any` names no field of the payload.

    The setting would have no effect, and the intended field would keep its default conversion.

    Bad::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {z: depth}}

    Good::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {x: depth}}
    """


class FieldNameForbidden(Rule, id="CNV104"):
    """A name under `fields` or `enums` cannot be a field of a ROS message.

    The names of ROS fields have lower-case letters, digits and single underscores. Keywords of Python and C++ would
    break the generated classes.

    Bad::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {x: class}}

    Good::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {x: class_of_sample}}
    """


class FieldNameTaken(Rule, id="CNV105"):
    """Two fields would get the same name in the ROS message.

    One of them would replace the other.

    Bad::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {x: y}}
        # proto/imu.proto
        message Imu { float x = 1; float y = 2; }

    Good::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {x: depth}}
        # proto/imu.proto
        message Imu { float x = 1; float y = 2; }
    """


class MessageNameTaken(Rule, id="CNV106"):
    """Two proto messages or enums would become the same ROS message.

    Their `.msg` files would have the same name, and one would overwrite the other.

    Bad::

        - {number: 1, name: imu, proto: Imu, ros: Sample, topic: imu, direction: board_to_ros}
        - {number: 2, name: gps, proto: Gps, ros: Sample, topic: gps, direction: board_to_ros}

    Good::

        - {number: 1, name: imu, proto: Imu, ros: ImuSample, topic: imu, direction: board_to_ros}
        - {number: 2, name: gps, proto: Gps, ros: GpsSample, topic: gps, direction: board_to_ros}
    """


class RowsDisagreeOnAMessage(Rule, id="CNV107"):
    """Two rows have different settings for the conversion of the same proto message.

    A proto message becomes only one ROS message. Rows that share it must agree on `ros`, `fields`, `ignore`, `presence`
    and `any`.

    Bad::

        - {number: 1, name: front, proto: Imu, topic: front, direction: board_to_ros}
        - {number: 2, name: rear, proto: Imu, topic: rear, direction: board_to_ros, fields: {x: depth}}

    Good::

        - {number: 1, name: front, proto: Imu, topic: front, direction: board_to_ros, fields: {x: depth}}
        - {number: 2, name: rear, proto: Imu, topic: rear, direction: board_to_ros, fields: {x: depth}}
    """


class ConstantName(Rule, id="CNV108"):
    """An enum value cannot be a constant of a ROS message, or two values would get the same constant.

    The names of ROS constants have capitals, digits and single underscores. The names of enum values are converted to
    that spelling.

    Bad::

        enum Mode { IDLE = 0; _1 = 1; }
        message Imu { Mode mode = 1; }

    Good::

        enum Mode { IDLE = 0; FIRST = 1; }
        message Imu { Mode mode = 1; }
    """


class UnknownEnum(Rule, id="CNV109"):
    """`enums` names an enum that no payload contains.

    An enum under `enums` becomes a ROS message of its own. This entry has no effect: the name is misspelt or lacks its
    package, or the enum is not used any more.

    Bad::

        # mapping.yaml
        enums: {Mod: {ros: Mode, field: mode}}
        # proto/imu.proto
        enum Mode { IDLE = 0; }
        message Imu { Mode mode = 1; }

    Good::

        # mapping.yaml
        enums: {Mode: {ros: Mode, field: mode}}
        # proto/imu.proto
        enum Mode { IDLE = 0; }
        message Imu { Mode mode = 1; }
    """


class ExtensionsNotCarried(Rule, id="CNV110", severity=Severity.WARNING):
    """A proto2 message can be extended, but its extensions have no ROS fields.

    The bridge drops every extension that a peer sends.

    Bad::

        syntax = "proto2";
        message Imu { optional float x = 1; extensions 100 to 199; }

    Good::

        syntax = "proto2";
        message Imu { optional float x = 1; optional float y = 100; }
    """


class ContradictingPaths(Rule, id="CNV111"):
    """Paths under `fields`, `ignore`, `presence` and `any` contradict each other.

    A field cannot be both renamed and ignored. If a message becomes a field as a whole, a field inside it cannot be
    placed separately.

    Bad::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {x: depth}, ignore: [x]}

    Good::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, fields: {x: depth}}
    """


class SettingWithoutEffect(Rule, id="CNV112"):
    """`presence` or `any` is set for a field to which it does not apply.

    `presence` is for fields that can be absent, such as `optional` fields. `any` is for fields with a
    google.protobuf.Any. Both settings change generated ROS messages; a standard message such as sensor_msgs/Imu cannot
    be changed.

    Bad::

        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, presence: {x: false}}

    Good::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, presence: {x: false}}
        # proto/imu.proto
        message Imu { optional float x = 1; }
    """
