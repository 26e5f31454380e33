"""Generated modules ``registry.py`` and ``checks.py``.

The registry lists the peers and the handlers. The checks compare the loaded protobuf modules with the generated code.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

from roverlink.generator import ir, lock
from roverlink.generator.emit.extra_topic_names import named_extra_topics
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.imports import Import, import_lines
from roverlink.generator.ir.msg_types import msg_type


def emit(bridge: ir.Bridge) -> Files:
    """Yield ``registry.py``, ``checks.py`` and the ``__init__.py`` that exports the registry and the handlers."""
    module, own = spelling.proto_module(bridge.envelope.file), bridge.python_package
    handlers = {spelling.handler_class(route): f"{own}.handlers" for route in bridge.routes}
    extra_topics = {extra.name: f"{own}.extra_topics" for extra in named_extra_topics(bridge)}
    imports: set[Import] = {
        (spelling.proto_package(own, bridge.envelope.file), module),
        ("roverlink.runtime.core.registry", "Peer"),
        ("roverlink.runtime.core.registry", "Registry"),
    }
    if any(peer.boards for peer in bridge.peers):
        imports.add(("roverlink.runtime.core.registry", "End"))
    if bridge.link is not None:
        imports.add(("roverlink.runtime.core.registry", "Link"))
    imports |= {(package, name) for name, package in (handlers | extra_topics).items()}
    yield (
        "generated/registry.py",
        render(
            "registry.py.j2",
            header=header(bridge.table),
            imports=import_lines(imports),
            bridge=bridge,
            envelope=f"{module}.{bridge.envelope.message.rpartition('.')[2]}",
            handlers=[*handlers],
            extra_topics=[*extra_topics],
            fingerprint=fingerprint(bridge),
        ),
    )
    yield "generated/checks.py", render("checks.py.j2", header=header(bridge.table), bridge=bridge)
    exported = {(package, name) for name, package in (handlers | extra_topics).items()} | {
        (f"{own}.registry", "REGISTRY")
    }
    yield (
        "generated/__init__.py",
        render(
            "package.py.j2",
            header=header(bridge.table),
            docstring=f"The registry and the handlers of rows and extra topics, compiled from {bridge.table}.",
            imports=import_lines(exported),
            names=sorted({*handlers, *extra_topics, "REGISTRY"}),
        ),
    )


def _becomes(route: ir.Route) -> str:
    return route.conversion.ros if route.conversion else route.standard_topics[0].message


def fingerprint(bridge: ir.Bridge) -> str:
    """Return SHA-256 over the wire schema, the routes, and the conversion of each field.

    If the result is equal on two machines, both machines read the same bytes in the same way, and publish the same
    messages.
    """
    routes = [
        f"{route.number} {route.name} {route.topic} {route.direction} {route.proto} {_becomes(route)}"
        for route in bridge.routes
    ]
    routes += [
        f"{route.number} {standard.topic} {standard.message} {standard.fields}"
        for route in bridge.routes
        for standard in route.standard_topics
    ]
    lines = [*lock.schema_lines(bridge.wire_messages, bridge.wire_enums), *routes, *_meanings(bridge)]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _meanings(bridge: ir.Bridge) -> Iterator[str]:
    """Yield the fields of each ROS message and the proto field of each, as lines of text for `fingerprint`."""
    for message in bridge.messages:
        yield from (f"{message.name} {msg_type(field.type)} {field.name}" for field in message.fields)
        yield from (f"{message.name} {constant.name}={constant.value}" for constant in message.constants)
    for ros, conversion in sorted(bridge.conversions().items()):
        for field in conversion.fields:
            source = " ".join(filter(None, [".".join(field.proto_path), field.kind.name, field.presence, field.which]))
            yield f"{ros}.{field.ros.name} from {source}"
    for any in bridge.anys:
        yield from (f"{any.ros}.{member.field} from {member.proto}" for member in any.members)
