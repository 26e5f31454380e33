"""Lookup of a bridge's messages, fields and conversions by name."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.targets.cpp import cpp_names


@dataclass(frozen=True, slots=True)
class Converter:
    """Class that converts a nested message."""

    header: str
    name: str


class Context:
    """Lookup of a bridge's messages, fields and conversions by name."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self.bridge = bridge
        self._messages = {message.name: message for message in bridge.messages}
        self._handlers = {route.conversion.ros: route for route in reversed(bridge.routes) if route.conversion}

    def ros_field(self, message: str, field: str) -> ir.RosField:
        """Return a field of a ROS message."""
        return next(one for one in self._messages[message].fields if one.name == field)

    def struct(self, message: str) -> str:
        """Return the struct of an own message."""
        return cpp_names.struct(self.bridge.package, message)

    def comment(self, message: str) -> str:
        """Return the comment of an own message."""
        return self._messages[message].comment

    def converter(self, ros: str) -> Converter:
        """Return the class that converts a ROS message: a row's handler, or a conversion class."""
        package = self.bridge.package
        if route := self._handlers.get(ros):
            return Converter(f"{package}/handlers/{cpp_names.handler_file(route)}.hpp", cpp_names.handler_class(route))
        header = f"{package}/conversions/{cpp_names.conversion_file(ros)}.hpp"
        return Converter(header, cpp_names.conversion_class(ros))
