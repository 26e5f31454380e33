"""What the bodies of every conversion of a bridge look up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.targets.cpp import cpp_names


@dataclass(frozen=True, slots=True)
class Converter:
    """How code calls the conversion of a nested message."""

    header: str
    name: str
    """Of its class."""


class Context:
    """What the bodies of every conversion of a bridge look up."""

    def __init__(self, bridge: ir.Bridge, converter_of: Callable[[str], Converter]) -> None:
        self.package, self.converter_of = bridge.package, converter_of
        self._fields = {(message.name, field.name): field for message in bridge.messages for field in message.fields}

    def ros_field(self, message: str, field: str) -> ir.RosField:
        """A field of a ROS message."""
        return self._fields[message, field]

    def struct(self, message: str) -> str:
        """The struct of one of the table's own messages."""
        return cpp_names.struct(self.package, message)
