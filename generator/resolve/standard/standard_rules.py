"""Rules about the conversion between payloads and standard messages."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule


class KeyWithoutStandardMessage(Rule, id="STD101"):
    """A row has `frame_id`, `stamp` or `unset`, but its own message is not a standard message.

    These keys fill the header of a standard message, such as sensor_msgs/Imu, or leave fields of it unset. A generated
    ROS message has exactly the fields of the payload, so the keys cannot apply to it.

    Bad::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros, frame_id: imu_link}

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: imu/x, ros: std_msgs/Float32, fields: {data: x}}]
    """


class UnknownStandardMessage(Rule, id="STD102"):
    """`ros` names a message of another package, but not one of the standard messages that roverlink knows.

    roverlink only knows the definitions of ROS 2's common interfaces. It cannot check the fields of other messages.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Flaot32, fields: {data: x}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: x}}]
    """


class DistributionsDisagree(Rule, id="STD103"):
    """A standard message differs between the distributions of ROS 2, and `ros.distro` names none.

    Two machines with different distributions could not exchange the message. If every machine has the same
    distribution, set it with `distro`.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: sensor_msgs/Range, frame_id: sonar,
                   unset: [radiation_type, field_of_view, min_range, max_range], fields: {range: x}}]

    Good::

        # mapping.yaml
        ros: {package: rover, distro: humble}
        messages:
          - number: 1
            name: imu
            proto: Imu
            topic: imu
            direction: board_to_ros
            also: [{topic: out, ros: sensor_msgs/Range, frame_id: sonar,
                     unset: [radiation_type, field_of_view, min_range, max_range], fields: {range: {from: x, unit: m}}}]
    """


class UnknownTargetField(Rule, id="STD104"):
    """A path under `fields` or `unset` names no field of the standard message.

    The value would not be published.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {dat: x}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: x}}]
    """


class UnknownSourceField(Rule, id="STD105"):
    """A path names no field of the payload, or a field that cannot be used, such as a whole message.

    The field of the standard message would have no value.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: z}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: x}}]
    """


class TargetFieldUnset(Rule, id="STD106"):
    """No entry fills a field of a standard message, and subscribers would read its zero as a value.

    A subscriber cannot distinguish an unfilled field from a measured zero. Fill the field, give it a constant, or list
    it under `unset`.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Vector3, fields: {x: x, y: x}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Vector3, fields: {x: x, y: x, z: 0}}]
    """


class SourceFieldUnused(Rule, id="STD107"):
    """A field of the payload is missing in the row's standard messages.

    For a row from a peer, the field reaches no topic. For a row to a peer, no field of the standard message sets the
    field of the payload, so the peer would get zero. Perhaps the direction is wrong.

    Bad::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, ros: std_msgs/Float32, topic: imu, direction: ros_to_board,
           fields: {data: x}}
        # proto/imu.proto
        message Imu { float x = 1; float y = 2; }

    Good::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, ros: std_msgs/Float32, topic: imu, direction: ros_to_board,
           ignore: [y], fields: {data: x}}
        # proto/imu.proto
        message Imu { float x = 1; float y = 2; }
    """


class TargetFieldSetTwice(Rule, id="STD108"):
    """Two entries fill the same field, or an entry fills a field that `unset` names.

    One of the two values would be lost.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Vector3, unset: [z], fields: {x: x, y: x, z: 0}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Vector3, fields: {x: x, y: x, z: 0}}]
    """


class MappingDoesNotFit(Rule, id="STD109"):
    """An entry does not fit the standard message or its field, such as a text for a number, or one value for a list.

    The two types cannot be converted, or an option such as `scale`, `to` or `axes` has no meaning for this field.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: x}}]
        # proto/imu.proto
        message Imu { string x = 1; }

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/String, fields: {data: x}}]
        # proto/imu.proto
        message Imu { string x = 1; }
    """


class UnknownUnit(Rule, id="STD110"):
    """An entry names a unit that roverlink does not know.

    Units are written like `m/s^2`, `deg/s`, `kPa` or `degC`; other spellings are not accepted.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: {from: x, unit: metre, to: m}}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: {from: x, unit: cm, to: m}}}]
    """


class UnitMissing(Rule, id="STD111"):
    """The unit of the proto field or of the ROS field is known, but the unit of the other field is not given.

    The value could be wrong by any factor. Give the unit, even if both fields have the same one.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Point, fields: {x: x, y: x, z: 0}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Point, fields: {x: {from: x, unit: m}, y: {from: x, unit: cm}, z: 0}}]
    """


class DimensionDoesNotFit(Rule, id="STD112"):
    """The unit of the proto field and the unit of the ROS field have different dimensions.

    For example, no factor converts a speed to a length.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Point, fields: {x: {from: x, unit: m/s}, y: 0, z: 0}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: geometry_msgs/Point, fields: {x: {from: x, unit: mm}, y: 0, z: 0}}]
    """


class LossyNarrowing(Rule, id="STD113"):
    """The ROS field's type has less range or precision than the payload's type, and the entry does not allow that.

    Values would lose digits or not fit. With `narrow: true`, a datagram whose value does not fit is dropped.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: x}}]
        # proto/imu.proto
        message Imu { double x = 1; }

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: {from: x, narrow: true}}}]
        # proto/imu.proto
        message Imu { double x = 1; }
    """


class FrameIdMissing(Rule, id="STD114"):
    """A standard message from a peer has a header, but no `frame_id` gives the frame of its values.

    Without a frame, tf2 cannot transform the values.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: sensor_msgs/Temperature, fields: {temperature: {from: x, unit: degC}}}]

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: sensor_msgs/Temperature, frame_id: imu_link,
                   fields: {temperature: {from: x, unit: degC}}}]
    """


class EnumTableIncomplete(Rule, id="STD115"):
    """The key `enum` of an entry leaves out a value of the enum, and the entry has no `default`.

    The bridge could not convert a payload with that value.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Int8, fields: {data: {from: mode, enum: {OFF: 0, ON: 1}}}}]
        # proto/imu.proto
        enum Mode { OFF = 0; ON = 1; AUTO = 2; }
        message Imu { Mode mode = 1; }

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Int8, fields: {data: {from: mode, enum: {OFF: 0, ON: 1}, default: 2}}}]
        # proto/imu.proto
        enum Mode { OFF = 0; ON = 1; AUTO = 2; }
        message Imu { Mode mode = 1; }
    """


class UnknownEnumValue(Rule, id="STD116"):
    """An entry names a value that the enum does not have, or a constant that the standard message does not have.

    The name is probably misspelt, and the entry would never be used.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Int8, fields: {data: {from: mode, enum: {OF: 0}, default: 1}}}]
        # proto/imu.proto
        enum Mode { OFF = 0; ON = 1; AUTO = 2; }
        message Imu { Mode mode = 1; }

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Int8, fields: {data: {from: mode, enum: {OFF: 0}, default: 1}}}]
        # proto/imu.proto
        enum Mode { OFF = 0; ON = 1; AUTO = 2; }
        message Imu { Mode mode = 1; }
    """


class AbsenceUnsaid(Rule, id="STD117"):
    """A field of the payload may be absent, but no `default` gives the value for this case.

    A zero that was never sent looks like a measured zero.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: x}}]
        # proto/imu.proto
        message Imu { optional float x = 1; }

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: out, ros: std_msgs/Float32, fields: {data: {from: x, default: -1}}}]
        # proto/imu.proto
        message Imu { optional float x = 1; }
    """


class NoWayBack(Rule, id="STD118"):
    """The standard message of a row to a peer cannot be converted back to the payload.

    Several payloads would become the same standard message, so the bridge cannot tell which payload to send to the
    peer.

    Bad::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, ros: std_msgs/Int8, topic: imu, direction: ros_to_board,
           fields: {data: {from: mode, enum: {OFF: 0, ON: 1, AUTO: 1}}}}
        # proto/imu.proto
        enum Mode { OFF = 0; ON = 1; AUTO = 2; }
        message Imu { Mode mode = 1; }

    Good::

        # mapping.yaml
        - {number: 1, name: imu, proto: Imu, ros: std_msgs/Int8, topic: imu, direction: ros_to_board,
           fields: {data: {from: mode, enum: {OFF: 0, ON: 1, AUTO: 2}}}}
        # proto/imu.proto
        enum Mode { OFF = 0; ON = 1; AUTO = 2; }
        message Imu { Mode mode = 1; }
    """


class NoBoardClock(Rule, id="STD119"):
    """A stamp with `clock: board` comes from a field that cannot be the clock of a board.

    The clock of a board is a counter: an integer of 32 or 64 bits in ms, us or ns that the board starts with itself.
    The bridge knows from the type of the field when the counter begins at 0 again.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: imu/x, ros: geometry_msgs/PointStamped, frame_id: imu_link,
                  stamp: {from: uptime, unit: s, clock: board},
                  fields: {point: {x: x, y: 0, z: 0, unit: m}}}]
        # proto/imu.proto
        message Imu { float x = 1; float uptime = 2; }

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also: [{topic: imu/x, ros: geometry_msgs/PointStamped, frame_id: imu_link,
                  stamp: {from: uptime, unit: us, clock: board},
                  fields: {point: {x: x, y: 0, z: 0, unit: m}}}]
        # proto/imu.proto
        message Imu { float x = 1; uint32 uptime = 2; }
    """


class ClockOfNoBoard(Rule, id="STD120"):
    """A stamp has `clock: board`, but no single board has measured what is in the message.

    A row to a peer has no measurement of the peer. If a peer has several boards, each has a clock of its own, and the
    row must belong to one of them.

    Bad::

        # mapping.yaml
        peers:
          board: {port: 6001, boards: {Sensor: {host: 10.0.0.2}, Arm: {host: 10.0.0.3}}}
        messages:
          - number: 1
            name: imu
            proto: Imu
            topic: imu
            direction: board_to_ros
            also: [{topic: imu/x, ros: geometry_msgs/PointStamped, frame_id: imu_link,
                    stamp: {from: uptime, unit: us, clock: board},
                    fields: {point: {x: x, y: 0, z: 0, unit: m}}}]
        # proto/imu.proto
        message Imu { float x = 1; uint32 uptime = 2; }

    Good::

        # mapping.yaml
        peers:
          board: {port: 6001, boards: {Sensor: {host: 10.0.0.2}, Arm: {host: 10.0.0.3}}}
        messages:
          - number: 1
            name: imu
            proto: Imu
            board: Sensor
            topic: imu
            direction: board_to_ros
            also: [{topic: imu/x, ros: geometry_msgs/PointStamped, frame_id: imu_link,
                    stamp: {from: uptime, unit: us, clock: board},
                    fields: {point: {x: x, y: 0, z: 0, unit: m}}}]
        # proto/imu.proto
        message Imu { float x = 1; uint32 uptime = 2; }
    """


class OtherBoardClock(Rule, id="STD121"):
    """Two stamps with `clock: board` of one board have other units or other sizes, so they are two counters.

    The bridge compares the clock of a board with its own clock, and all messages of the board help. Two counters that
    have not started together would be taken for one.

    Bad::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also:
            - {topic: imu/x, ros: geometry_msgs/PointStamped, frame_id: imu_link,
               stamp: {from: uptime_us, unit: us, clock: board}, fields: {point: {x: x, y: 0, z: 0, unit: m}}}
            - {topic: imu/y, ros: geometry_msgs/PointStamped, frame_id: imu_link,
               stamp: {from: uptime_ms, unit: ms, clock: board}, fields: {point: {x: 0, y: x, z: 0, unit: m}}}
        # proto/imu.proto
        message Imu { float x = 1; uint32 uptime_us = 2; uint32 uptime_ms = 3; }

    Good::

        # mapping.yaml
        - number: 1
          name: imu
          proto: Imu
          topic: imu
          direction: board_to_ros
          also:
            - {topic: imu/x, ros: geometry_msgs/PointStamped, frame_id: imu_link,
               stamp: {from: uptime_us, unit: us, clock: board}, fields: {point: {x: x, y: 0, z: 0, unit: m}}}
            - {topic: imu/y, ros: geometry_msgs/PointStamped, frame_id: imu_link,
               stamp: {from: uptime_us, unit: us, clock: board}, fields: {point: {x: 0, y: x, z: 0, unit: m}}}
        # proto/imu.proto
        message Imu { float x = 1; uint32 uptime_us = 2; }
    """
