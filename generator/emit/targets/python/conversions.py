"""Generated modules with the functions ``to_ros`` and ``from_ros`` for messages inside payloads."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.any_modules import any_module
from roverlink.generator.emit.targets.python.expressions import Converter, field_expressions
from roverlink.generator.emit.targets.python.imports import import_lines


class Converters:
    """Lookup of the handler class or the generated module that converts a ROS message."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self._generated = bridge.python_package
        self._handlers = {route.conversion.ros: route for route in reversed(bridge.routes) if route.conversion}

    def of(self, ros: str) -> Converter:
        """Return the converter of the ROS message named ``ros``.

        This is a row's handler if the message belongs to a row, otherwise a module in ``generated/conversions``.
        """
        route = self._handlers.get(ros)
        if route is not None:
            return Converter(f"{self._generated}.handlers.{spelling.module(route.name)}", spelling.handler_class(route))
        return Converter(f"{self._generated}.conversions", spelling.conversion_module(ros))


def emit(bridge: ir.Bridge) -> Files:
    """Yield a module for each nested message, and one for each Any."""
    converters = Converters(bridge)
    for conversion in bridge.nested:
        yield f"generated/conversions/{spelling.conversion_module(conversion.ros)}.py", _module(
            bridge, conversion, converters
        )
    for any in bridge.anys:
        yield f"generated/conversions/{spelling.conversion_module(any.ros)}.py", any_module(bridge, any, converters.of)
    docstring = "Conversions of nested messages: one module for each message."
    yield "generated/conversions/__init__.py", f'{header(bridge.table)}\n"""{docstring}"""\n'


def _module(bridge: ir.Bridge, conversion: ir.Conversion, converters: Converters) -> str:
    fields = field_expressions(conversion, converters.of, bridge.python_package, f"{conversion.ros}.")
    return render(
        "conversion.py.j2",
        header=header(f"{bridge.table} and {conversion.file}"),
        imports=import_lines(fields.imports),
        proto=conversion.local_name,
        ros=f"{bridge.package}/msg/{conversion.ros}",
        payload=spelling.proto_class(conversion),
        message=spelling.message_class(conversion.ros),
        fields=fields,
    )
