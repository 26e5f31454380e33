"""Generated handlers, which convert between payload and ROS message: one module with one class for each row."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.conversions import Converters
from roverlink.generator.emit.targets.python.expressions import field_expressions
from roverlink.generator.emit.targets.python.imports import import_lines
from roverlink.generator.emit.targets.python.packages import package_file


def emit(bridge: ir.Bridge) -> Files:
    """Yield a module for each handler of a row with a generated ROS message, and the ``__init__.py`` of all handlers.

    The module `extra_topics` yields the handlers of rows with a standard message.
    """
    converters = Converters(bridge)
    for route in bridge.routes:
        if route.conversion:
            text = _handler(bridge, route, route.conversion, converters)
            yield f"generated/handlers/{spelling.module(route.name)}.py", text
    classes = {spelling.handler_class(route): spelling.module(route.name) for route in bridge.routes}
    yield package_file(bridge, "handlers", "The handlers: one class for each row of the table.", classes)


def _handler(bridge: ir.Bridge, route: ir.Route, conversion: ir.Conversion, converters: Converters) -> str:
    fields = field_expressions(conversion, converters.of, bridge.python_package, "")
    imports = {*fields.imports, *spelling.route_imports(route), ("roverlink.runtime.core.handler", "Handler")}
    if route.request and (service := route.request.service):
        imports |= {(f"{bridge.python_package}.services", part.name) for part in (service.request, service.response)}
    ros = f"{bridge.package}/msg/{conversion.ros}"
    return render(
        "handler.py.j2",
        header=header(f"{bridge.table} (row {route.name}) and {conversion.file}"),
        imports=import_lines(imports),
        handler=spelling.handler_class(route),
        about=spelling.documented(route.comment, f"{conversion.local_name} as {ros}."),
        route=route,
        default_qos=ir.Qos(),
        proto=conversion.local_name,
        ros=ros,
        payload=spelling.proto_class(conversion),
        message=spelling.message_class(conversion.ros),
        fields=fields,
    )
