"""Rules about names of rows, topics, messages and enum values."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import PurePosixPath

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.ir import ros_names
from roverlink.generator.ir.ros_names import distinct, snake_case
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.schema import ProtoEnum, ProtoMessage
from roverlink.generator.table import Numbered, RetiredRow, Row

_HELP_NAME = "choose another name"


class NameTaken(LintRule, id="TAB101"):
    """Two payloads of the envelope have the same name.

    Members of a oneof need different names, and so do the generated handler classes: names that differ only in capitals
    or underscores would become the same class. A retired name is taken forever, like its number. The oneof's own name
    is taken too, and with `signing` the name `signature`.

    Bad::

        messages:
          - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
          - {number: 22, name: gps, proto: SensorBoardGPSStatus, topic: gps_status, direction: hardware_to_ros}

    Good::

        messages:
          - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
          - {number: 22, name: gps_status, proto: SensorBoardGPSStatus, topic: gps_status, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row or signature whose name an earlier row, a retired row or the oneof has.

        Retired rows are compared with each other, too.
        """
        table = context.table
        retired: dict[str, RetiredRow] = {}

        def at(row: Numbered | RetiredRow, message: str, also: tuple[Span, str], help: str = _HELP_NAME) -> Diagnostic:
            return cls.of_row(table, row, "name", message, help, [also])

        for gone in table.retired:
            first = retired.setdefault(gone.name, gone)
            if first is not gone:
                message = f"the name {gone.name!r} is retired twice"
                yield at(
                    gone,
                    message,
                    (first.at("name"), "first retired here"),
                    "remove one of the two entries, or correct its name",
                )
        seen: dict[str, Numbered] = {}
        # The link message and the signature come first, because nobody can choose another name for them.
        for row in sorted(table.numbered, key=lambda row: isinstance(row, Row)):
            earlier = seen.setdefault(distinct(row.name), row)
            if earlier is not row:
                message = f"the name {row.name!r} is already taken by field {earlier.number} ({earlier.proto})"
                yield at(row, message, (earlier.at("name"), "first used here"))
            elif row.name in retired:
                gone = retired[row.name]
                message = f"the name {row.name!r} belonged to field {gone.number} ({gone.proto}) and is retired"
                yield at(row, message, (gone.at("name"), "retired here"))
            elif row.name == table.envelope.oneof:
                yield at(
                    row, f"{row.name!r} is already the name of the oneof", (table.envelope.at("oneof"), "named here")
                )


class TopicTaken(LintRule, id="TAB102"):
    """Two rows have the same topic, or one row has it twice.

    A topic has one type and one meaning. Two rows with one topic would mix two payloads. If one row receives and the
    other sends, the rows would send each other's messages back in a loop.

    Bad::

        - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: sensors, direction: hardware_to_ros}
        - {number: 13, name: imu, proto: SensorBoardIMUInfo, topic: sensors, direction: hardware_to_ros}

    Good::

        - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: sensors/gps, direction: hardware_to_ros}
        - {number: 13, name: imu, proto: SensorBoardIMUInfo, topic: sensors/imu, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row with a topic that an earlier row, or the row itself, already has."""
        seen: dict[str, tuple[str, Span]] = {}
        for row in context.table.rows:
            for topic, span in _topics(row):
                # usually a node is in the root namespace, where `gps` and `/gps` are the same topic
                first, place = seen.setdefault(topic.removeprefix("/"), (row.name, span))
                if place is not span:
                    message = f"the topic {topic!r} already belongs to the row {first!r}"
                    help = "give each row its own topic"
                    yield cls.of_row(context.table, row, span, message, help, [(place, "first used here")])


def _topics(row: Row) -> Iterator[tuple[str, Span]]:
    """Yield the topics of a row with their places: its own topic and its extra topics.

    Rows that were made from an envelope without a table have none.
    """
    if row.topic:
        yield row.topic, row.at("topic")
    yield from ((standard.topic, standard.at("topic")) for standard in row.also)


class MessageNameNotUnique(LintRule, id="NAM101"):
    """Two .proto files declare messages with the same name.

    The table, the topics and the ROS 2 messages identify a message by its name. Sooner or later, a file imports the
    wrong message. If the two files declare no package, they cannot be compiled together. In a folder without a table,
    messages of different packages may have the same name.

    Bad::

        // components/arm_board/status.proto
        message Status {}
        // components/sensor_board/status.proto
        message Status {}

    Good::

        // components/arm_board/status.proto
        message ArmBoardStatus {}
        // components/sensor_board/status.proto
        message SensorBoardStatus {}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each top-level message whose name is also declared in another file."""
        seen: dict[str, tuple[str, ProtoMessage]] = {}
        of_table = context.table.proto.root != ""
        for files in (context.files, context.excluded_files):
            for path, file in sorted(files.items()):
                for message in file.outermost:
                    name = message.name if of_table else message.full_name
                    first, earlier = seen.setdefault(name, (path, message))
                    if first != path:
                        finding = cls.at(
                            context.place(path, message.span.line, message.span.column),
                            f"the message {message.full_name!r} has the same name as a message in {first}",
                            "start each name with the part of the rover to which it belongs, as in SensorBoardStatus",
                            [(context.place(first, earlier.span.line, earlier.span.column), "first declared here")],
                            type=message.full_name,
                        )
                        excluded = path in context.excluded_files  # never compiled, so it does no harm yet
                        yield dataclasses.replace(finding, severity=Severity.WARNING) if excluded else finding


class MessageMisplaced(LintRule, id="NAM102", severity=Severity.WARNING):
    """The name or the folder of a message does not show to which part of the rover the message belongs.

    The key `prefixes` of a peer lists its parts, such as `SensorBoard` for the sensor board. Names of the board's
    messages must start with this prefix, as in SensorBoardGPSInfo, and their files must be in a folder `sensor_board/`.
    If a message has another name or is in another folder, the developers of the board do not find it when they change
    their firmware. Messages of peers without `prefixes` may have any name.

    Bad::

        // components/arm_board/gps_sensor.proto
        message SensorBoardGPSInfo {}
        // components/sensor_board/wind.proto
        message Wind {}

    Good::

        // components/sensor_board/gps_sensor.proto
        message SensorBoardGPSInfo {}
        // components/sensor_board/wind.proto
        message SensorBoardWind {}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each payload whose name or folder does not match the prefixes of its peer."""
        table = context.table
        if not table.whole:
            return  # the prefix may be in a part that could not be read
        with_prefixes = {peer.name for peer in table.peers if peer.prefixes}
        prefixes = {prefix for peer in table.peers for prefix in peer.prefixes}
        travelling = {row.proto: row for row in reversed(table.rows) if row.peer in with_prefixes}
        for row in travelling.values():
            name = row.proto.rpartition(".")[2]
            own = sorted(prefix for prefix in prefixes if name.startswith(prefix) or row.proto.startswith(prefix))
            yield from _check_folder(row, own, context) if own else _not_prefixed(row, sorted(prefixes), context)


def _not_prefixed(row: Row, prefixes: list[str], context: Context) -> Iterator[Diagnostic]:
    message = f"the name of the message {row.proto!r} does not start with any of the `prefixes` of the peers"
    help = f"start the name with {' or '.join(prefixes)}, or add its prefix to the `prefixes` of a peer"
    span, also = _declaration(row, context)
    yield MessageMisplaced.at(span, message, help, also, type=row.proto)


def _check_folder(row: Row, prefixes: list[str], context: Context) -> Iterator[Diagnostic]:
    declared = context.schema.messages.get(row.proto)
    folders = [snake_case(prefix) for prefix in prefixes]
    if declared is not None and PurePosixPath(declared.file).parent.name not in folders:
        message = (
            f"{row.proto!r} is declared in {declared.file}, but its prefix requires a folder "
            f"{' or '.join(map(repr, folders))}"
        )
        span, also = _declaration(row, context)
        help = "move the message to a file in that folder, or start its name with the prefix of its present folder"
        yield MessageMisplaced.at(span, message, help, also, type=row.proto)


def _declaration(row: Row, context: Context) -> tuple[Span, list[tuple[Span, str]]]:
    """Return the place for a row's diagnostic, and its related places.

    This is the declaration of the message, with the row as related place. If the declaration is unknown, it is the row.
    """
    declared = context.schema.messages.get(row.proto)
    if declared is None:
        return row.at("proto"), []
    return declared.at("name"), [(row.at("proto"), "a row uses the message here")]


_Messages = Mapping[str, tuple[str, ProtoMessage]]  # by full name, each with its file


class EnumValueCollides(LintRule, id="NAM103"):
    """An enum value has the name of a message.

    In protobuf, enum values belong to the scope around the enum: `enum Kind { Motor = 0; }` declares `Kind` and `Motor`
    (language guide, "Enum"). If a file of the same package declares a message `Motor`, the two files cannot be compiled
    together. Often protoc reports this only when a third file imports both.

    Bad::

        enum MessageType {
          SensorBoardIMUInfo = 0;
        }
        message SensorBoardIMUInfo {}

    Good::

        enum MessageType {
          MESSAGE_TYPE_SENSOR_BOARD_IMU_INFO = 0;
        }
        message SensorBoardIMUInfo {}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each enum with a value that has the name of a message in the same scope."""
        files = {**context.excluded_files, **context.files}
        messages = {message.full_name: (path, message) for path, file in files.items() for message in file.messages}
        for path, file in files.items():
            for enum in file.enums:
                yield from _colliding_values(path, enum, messages, context)


def _colliding_values(path: str, enum: ProtoEnum, messages: _Messages, context: Context) -> Iterator[Diagnostic]:
    scope = enum.full_name.removesuffix(enum.name)
    colliding = [value for value in enum.values if f"{scope}{value.name}" in messages]
    if not colliding:
        return
    first = colliding[0]
    file, message = messages[f"{scope}{first.name}"]
    named = [repr(value.name) for value in colliding[:3]] + ["..."] * (len(colliding) > 3)
    prefixed = f"{snake_case(enum.name)}_{snake_case(first.name)}".upper()
    finding = EnumValueCollides.at(
        context.place(path, first.span.line, first.span.column),
        f"values of the enum {enum.name!r} have the names of messages: {', '.join(named)}",
        f"start the values with the enum's name, as in {prefixed}; or delete the enum if nothing uses it",
        [(_message_place(file, message, context), "the message is here")],
        type=enum.full_name,
        number=first.number,
    )
    # An excluded file is never compiled, so the collision does no harm yet.
    excluded = not {path, file}.isdisjoint(context.excluded_files)
    yield dataclasses.replace(finding, severity=Severity.WARNING) if excluded else finding


def _message_place(file: str, message: ProtoMessage, context: Context) -> Span:
    return context.place(file, message.span.line, message.span.column)


class RosNameForbidden(LintRule, id="ROS101"):
    """ROS 2 does not allow a name in the table.

    Package names are lower case with single underscores. Message names are CamelCase without underscores. Topics are
    names separated by slashes. rosidl and rcl reject anything else, but only when the package is built or the node
    starts.

    Bad::

        - {number: 12, name: gps, proto: GPS_Info, topic: gps//data, direction: hardware_to_ros}

    Good::

        - {number: 12, name: gps, proto: GPS_Info, ros: GPSInfo, topic: gps/data, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each name of the package, a row's message or a topic that ROS 2 does not allow."""
        table = context.table
        if table.ros.package and not ros_names.is_package_name(table.ros.package):
            help = "use lower-case letters, digits and single underscores, for example rover_msgs"
            yield cls.at(
                table.ros.at("package"), f"{table.ros.package!r} is not allowed as the name of a ROS package", help
            )
        for row in filter(_reaches_ros, table.rows):
            if row.standard is None and not ros_names.is_message_name(row.ros):
                nearest = ros_names.camel_case(row.ros)
                example = nearest if ros_names.is_message_name(nearest) else "ImuInfo"
                help = f"use letters and digits, and start with a capital, for example {example}"
                message = f"{row.ros!r} is not allowed as the name of a ROS message"
                yield cls.of_row(table, row, row.ros_span, message, help)
            request = row.request
            if (type := row.service_type) and request and not ros_names.is_message_name(type):
                span = request.spans.get("srv", row.at("name"))
                help = "give it another name with `srv`, for example MeasureRock"
                yield cls.of_row(table, row, span, f"{type!r} is not allowed as the name of a service type", help)
            service = [(request.service, request.at("service"), "service")] if request and request.service else []
            for topic, span, kind in (
                (row.topic, row.at("topic"), "topic"),
                *((standard.topic, standard.at("topic"), "topic") for standard in row.also),
                *service,
            ):
                if not ros_names.is_topic_name(topic):
                    parts = "no part may start with a digit"
                    help = f"use letters, digits and underscores, separated by single slashes; {parts}"
                    message = f"{topic!r} is not allowed as the name of a {kind}"
                    yield cls.of_row(table, row, span, message, help)


def _reaches_ros(row: Row) -> bool:
    """Return True if the row has a topic. Rows that were made from an envelope without a table have none."""
    return bool(row.topic)
