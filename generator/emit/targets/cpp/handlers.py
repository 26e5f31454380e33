"""C++ handler classes. One is generated for each row, and one for each extra topic."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.extra_topic_names import named_extra_topics
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.cpp import cpp_names
from roverlink.generator.emit.targets.cpp.conversion_context import Context
from roverlink.generator.emit.targets.cpp.conversion_fields import Fields, fields_of
from roverlink.generator.emit.targets.cpp.cpp_files import CppFile
from roverlink.generator.emit.targets.cpp.literals import comment_lines
from roverlink.generator.emit.targets.cpp.standard_fields import StandardFields


@dataclass(frozen=True, slots=True)
class Handler:
    """C++ handler class of a topic."""

    route: ir.Route
    source: ir.Conversion | ir.StandardTopic
    """Conversion between the payload and the ROS message; a `StandardTopic` if the topic has a standard message."""
    file: CppFile
    name: str
    envelope: str
    """C++ class of the envelope."""
    envelope_header: str

    @property
    def qos(self) -> ir.Qos | None:
        """Quality of service of the topic; None if it is rclcpp's default. The C++ library has the same default."""
        return None if self.route.qos == ir.Qos() else self.route.qos

    @property
    def accessor(self) -> str:
        """Name of the C++ accessor for the payload in the envelope."""
        return cpp_names.accessor(self.route.name)

    @property
    def payload(self) -> str:
        """C++ class of the payload."""
        return cpp_names.proto_class(self.source.proto)

    @property
    def payload_header(self) -> str:
        """Path of the header that declares the payload's class."""
        return cpp_names.proto_header(self.source.file)

    @property
    def standard(self) -> ir.StandardTopic | None:
        """Standard topic for which the handler is generated; None if the row has a generated ROS message."""
        return self.source if isinstance(self.source, ir.StandardTopic) else None

    @property
    def ros(self) -> str:
        """Full name of the topic's ROS message: ``sensor_msgs/msg/Imu``."""
        if isinstance(self.source, ir.StandardTopic):
            return self.source.message
        return f"{self.file.package}/msg/{self.source.ros}"

    @property
    def message(self) -> str:
        """C++ struct of the topic's ROS message."""
        return cpp_names.interface_struct(self.ros)

    @property
    def message_header(self) -> str:
        """Path of the header that declares the ROS message's struct."""
        return cpp_names.interface_header(self.ros)


def handlers_of(bridge: ir.Bridge) -> list[Handler]:
    """Return the handlers of all topics: in the order of the table, a row's extra topics after its own topic."""
    extra = named_extra_topics(bridge)
    found: list[Handler] = []
    for route in bridge.routes:
        if source := route.standard or route.conversion:
            file = f"handlers/{cpp_names.handler_file(route)}"
            found.append(_handler(bridge, route, source, file, cpp_names.handler_class(route)))
        found += [
            _handler(
                bridge, extra_topic.route, extra_topic.standard, f"extra_topics/{extra_topic.file}", extra_topic.name
            )
            for extra_topic in extra
            if extra_topic.route.number == route.number
        ]
    return found


def _handler(
    bridge: ir.Bridge, route: ir.Route, source: ir.Conversion | ir.StandardTopic, path: str, name: str
) -> Handler:
    file = CppFile(bridge.package, path, f"{bridge.table} (row {route.name}) and {source.file}")
    envelope = bridge.envelope
    return Handler(
        route, source, file, name, cpp_names.proto_class(envelope.message), cpp_names.proto_header(envelope.file)
    )


def emit(bridge: ir.Bridge, context: Context) -> Files:
    """Yield the header and the source file of each handler."""
    has_required = any(field.label == "required" for message in bridge.wire_messages for field in message.fields)
    for handler in handlers_of(bridge):
        comment = comment_lines(handler.route.comment)
        yield from handler.file.header("handler", handler=handler, comment=comment)
        fields: Fields | StandardFields
        if isinstance(handler.source, ir.StandardTopic):
            fields, template = StandardFields(handler.source), "standard_message"
        else:
            fields, template = fields_of(handler.source, context), "handler"
        headers = fields.headers - {handler.file.include}
        yield from handler.file.source(
            template, handler=handler, fields=fields, headers=headers, has_required=has_required
        )
