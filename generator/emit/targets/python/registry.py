"""The registry, number to handler, and the checks of what is loaded against what it was generated from."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator

from roverlink.generator import ir, lock
from roverlink.generator.emit.extra_topic_names import named_feeds
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import layout, spelling
from roverlink.generator.ir.msg_types import msg_type


def emit(bridge: ir.Bridge) -> Files:
    """``registry.py`` and ``checks.py``."""
    module, own = spelling.proto_module(bridge.envelope.file), bridge.python_package
    classes = [spelling.handler_class(route) for route in bridge.routes]
    feed_classes = [feed.name for feed in named_feeds(bridge)]
    yield (
        "generated/registry.py",
        render(
            "registry.py.j2",
            header=header(bridge.table),
            imports=layout.in_import_order(
                [
                    layout.import_from(f"{own}.handlers", classes),
                    *([layout.import_from(f"{own}.feeds", feed_classes)] if feed_classes else []),
                    layout.import_from(spelling.proto_package(own, bridge.envelope.file), [module]),
                    layout.import_from("roverlink.runtime.core.registry", ["Peer", "Registry"]),
                ]
            ),
            package=bridge.package,
            envelope=f"{module}.{bridge.envelope.message.rpartition('.')[2]}",
            oneof=bridge.envelope.oneof,
            peers=layout.entry("peers=", "(", [layout.statement(_peer(peer), 8) for peer in bridge.peers], ")", 4),
            handlers=layout.entry("handlers=", "(", [f"{name}()" for name in classes], ")", 4),
            feeds=layout.entry("feeds=", "(", [f"{name}()" for name in feed_classes], ")", 4) if feed_classes else "",
            fingerprint=fingerprint(bridge),
            retired=layout.entry(
                "retired=", "{", [f'{row.number}: "{row.name}"' for row in bridge.envelope.retired], "}", 4
            ),
        ),
    )
    yield (
        "generated/checks.py",
        render(
            "checks.py.j2",
            header=header(bridge.table),
            messages=[_entry(message.name, map(_field, message.fields)) for message in bridge.wire_messages],
            enums=[
                _entry(enum.name, (f"{value.number} {value.name}" for value in enum.values))
                for enum in bridge.wire_enums
            ],
        ),
    )
    yield "generated/__init__.py", header(bridge.table) + '\n"""The code that is compiled from the table."""\n'


def _entry(name: str, parts: Iterable[str]) -> str:
    return layout.entry(f'"{name}": ', "(", [f'"{part}"' for part in parts], ")", 4)


def _field(field: ir.WireField) -> str:
    """A field in the spelling of `roverlink.runtime.core.descriptor_check.check_descriptors`."""
    return f"{field.number} {field.name} {'repeated ' if field.label == 'repeated' else ''}{field.type}"


def _peer(peer: ir.Peer) -> layout.Group:
    arguments: list[layout.Item] = [f'name="{peer.name}"', f'port_parameter="{peer.parameter}"', f"port={peer.port}"]
    arguments += ["strip_trailing_zeros=True"] if peer.strip_trailing_zeros else []
    arguments += [layout.Group("sources=(", _sources(peer), ")")] if peer.sources else []
    arguments += [f"source_rate={peer.source_rate}"] if peer.source_rate is not None else []
    return layout.Group("Peer(", arguments, ")")


def _sources(peer: ir.Peer) -> list[str]:
    quoted = [f'"{source}"' for source in peer.sources]
    return quoted if len(quoted) > 1 else [f"{quoted[0]},"]


def _becomes(route: ir.Route) -> str:
    return route.conversion.ros if route.conversion else route.feeds[0].message


def fingerprint(bridge: ir.Bridge) -> str:
    """SHA-256 over the wire schema, the routes, and what becomes of each field.

    It is equal where two machines mean the same by the same bytes, and publish the same of it.
    """
    routes = [
        f"{route.number} {route.name} {route.topic} {route.direction} {route.proto} {_becomes(route)}"
        for route in bridge.routes
    ]
    routes += [
        f"{route.number} {feed.topic} {feed.message} {feed.fields}" for route in bridge.routes for feed in route.feeds
    ]
    lines = [*lock.schema_lines(bridge.wire_messages, bridge.wire_enums), *routes, *_meanings(bridge)]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _meanings(bridge: ir.Bridge) -> Iterator[str]:
    """The ROS messages, and where each of their fields comes from."""
    for message in bridge.messages:
        yield from (f"{message.name} {msg_type(field.type)} {field.name}" for field in message.fields)
        yield from (f"{message.name} {constant.name}={constant.value}" for constant in message.constants)
    for ros, conversion in sorted(bridge.conversions().items()):
        for field in conversion.fields:
            source = " ".join(filter(None, [".".join(field.proto_path), field.kind.name, field.presence, field.which]))
            yield f"{ros}.{field.ros.name} from {source}"
    for any in bridge.anys:
        yield from (f"{any.ros}.{member.field} from {member.proto}" for member in any.members)
