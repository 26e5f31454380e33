"""Lookup of ROS messages, their fields, and the C++ classes that convert them, by name."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.targets.cpp import cpp_names


@dataclass(frozen=True, slots=True)
class Converter:
    """C++ class that converts a nested message, and the header that declares the class."""

    header: str
    name: str


class Context:
    """Lookup of ROS messages, their fields, and the C++ classes that convert them, by name."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self.bridge = bridge
        self._messages = {message.name: message for message in bridge.messages}
        self._handlers = {route.conversion.ros: route for route in reversed(bridge.routes) if route.conversion}

    def ros_field(self, message: str, field: str) -> ir.RosField:
        """Return a field of a generated ROS message, by the names of the message and the field."""
        return next(declared for declared in self._messages[message].fields if declared.name == field)

    def struct(self, message: str) -> str:
        """Return the C++ struct of a message in the generated ROS 2 package."""
        return cpp_names.struct(self.bridge.package, message)

    def comment(self, message: str) -> str:
        """Return the comment of a message in the generated ROS 2 package."""
        return self._messages[message].comment

    def converter(self, ros: str) -> Converter:
        """Return the C++ class that converts a ROS message.

        This is a row's handler if the message belongs to a row, otherwise a conversion class.
        """
        package = self.bridge.package
        if route := self._handlers.get(ros):
            return Converter(f"{package}/handlers/{cpp_names.handler_file(route)}.hpp", cpp_names.handler_class(route))
        header = f"{package}/conversions/{cpp_names.conversion_file(ros)}.hpp"
        return Converter(header, cpp_names.conversion_class(ros))
