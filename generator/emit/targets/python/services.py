"""Generated dataclasses of the services' requests and responses: one module with one class for each."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.messages import message_file
from roverlink.generator.emit.targets.python.packages import package_file


def emit(bridge: ir.Bridge) -> Files:
    """Yield a module for each class, and the ``__init__.py`` of their package; nothing for a table without services."""
    parts = [part for service in bridge.services for part in (service.request, service.response)]
    for part in parts:
        text = message_file(bridge, part, f"{bridge.package}/srv/{part.name}", "")
        yield f"generated/services/{spelling.service_module(part)}.py", text
    if parts:
        classes = {part.name: spelling.service_module(part) for part in parts}
        yield package_file(bridge, "services", f"Services of the ROS 2 package {bridge.package}.", classes)
