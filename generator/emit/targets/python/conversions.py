"""The modules with ``to_ros`` and ``from_ros`` of what stands inside payloads, and where each conversion is found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import layout, spelling
from roverlink.generator.emit.targets.python.any_modules import any_module
from roverlink.generator.emit.targets.python.bodies import Bodies, Converter


class Converters:
    """Where the conversion to each ROS message stands: in a row's handler, or in a module of its own."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self.generated = bridge.python_package
        self._handlers = {route.conversion.ros: route for route in reversed(bridge.routes) if route.conversion}

    def of(self, ros: str) -> Converter:
        """The converter to a ROS message."""
        route = self._handlers.get(ros)
        if route is not None:
            return Converter(f"{self.generated}.handlers.{spelling.module(route.name)}", spelling.handler_class(route))
        return Converter(f"{self.generated}.conversions", spelling.conversion_module(ros))


@dataclass(frozen=True, slots=True)
class ConversionView:
    """A conversion as the templates see it: ready pieces of Python."""

    imports: tuple[str, ...]
    constants: tuple[str, ...]
    payload: str
    message: str
    to_ros: str
    from_ros: str
    to_ros_signature: str
    from_ros_signature: str


def view(
    conversion: ir.Conversion,
    converters: Converters,
    indent: int,
    place: str = "",
    extra_imports: Iterable[tuple[str, str]] = (),
) -> ConversionView:
    """The view of a conversion whose functions stand at a depth of indentation.

    ``place`` stands before the names of fields in errors, and ``extra_imports`` are modules and what is imported of
    them beside what the functions need.
    """
    bodies = Bodies(conversion, converters.of, converters.generated, place)
    payload, message = spelling.proto_class(conversion), spelling.message_class(conversion.ros)
    to_ros, from_ros = bodies.to_ros(message, indent + 4), bodies.from_ros(payload, indent + 4)
    unused = "" if conversion.fields else "_"
    return ConversionView(
        imports=layout.import_block([*bodies.imports(), *extra_imports]),
        constants=bodies.constants(message),
        payload=payload,
        message=message,
        to_ros=to_ros,
        from_ros=from_ros,
        to_ros_signature=layout.signature("to_ros", [f"{unused}payload: {payload}"], message, indent),
        from_ros_signature=layout.signature("from_ros", [f"{unused}message: {message}"], payload, indent),
    )


def emit(bridge: ir.Bridge) -> Files:
    """A module a nested message."""
    converters = Converters(bridge)
    for conversion in bridge.nested:
        shown = f"{conversion.local_name} to and from {bridge.package}/msg/{conversion.ros}."
        yield (
            f"generated/conversions/{spelling.conversion_module(conversion.ros)}.py",
            render(
                "conversion.py.j2",
                header=header(f"{bridge.table} and {conversion.file}"),
                docstring=layout.docstring(shown, 0),
                conversion=view(conversion, converters, 0, f"{conversion.ros}."),
            ),
        )
    for any in bridge.anys:
        yield f"generated/conversions/{spelling.conversion_module(any.ros)}.py", any_module(bridge, any, converters.of)
    yield (
        "generated/conversions/__init__.py",
        header(bridge.table) + '\n"""Conversions of the messages that stand inside payloads, one module each."""\n',
    )
