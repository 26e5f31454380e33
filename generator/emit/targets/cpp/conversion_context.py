"""Messages, fields and conversions of a bridge, looked up by name."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.targets.cpp import cpp_names


@dataclass(frozen=True, slots=True)
class Converter:
    """The class that converts a nested message."""

    header: str
    name: str


class Context:
    """Messages, fields and conversions of a bridge, looked up by name."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self.bridge = bridge
        self._messages = {message.name: message for message in bridge.messages}
        self._handlers = {route.conversion.ros: route for route in reversed(bridge.routes) if route.conversion}

    def ros_field(self, message: str, field: str) -> ir.RosField:
        """A field of a ROS message."""
        return next(one for one in self._messages[message].fields if one.name == field)

    def struct(self, message: str) -> str:
        """The struct of one of the table's own messages."""
        return cpp_names.struct(self.bridge.package, message)

    def comment(self, message: str) -> str:
        """Return the comment of one of the table's own messages."""
        return self._messages[message].comment

    def converter(self, ros: str) -> Converter:
        """The class with the conversion of a ROS message: a row's handler, or a class of its own."""
        package = self.bridge.package
        if route := self._handlers.get(ros):
            return Converter(f"{package}/handlers/{cpp_names.handler_file(route)}.hpp", cpp_names.handler_class(route))
        header = f"{package}/conversions/{cpp_names.conversion_file(ros)}.hpp"
        return Converter(header, cpp_names.conversion_class(ros))
