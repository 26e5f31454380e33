"""One class a row, and one a further topic of a row."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.extra_topic_names import named_feeds
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.cpp import cpp_names, layout
from roverlink.generator.emit.targets.cpp.bodies import Bodies
from roverlink.generator.emit.targets.cpp.conversion_context import Context
from roverlink.generator.emit.targets.cpp.conversions import named
from roverlink.generator.emit.targets.cpp.cpp_files import Pair, pair
from roverlink.generator.emit.targets.cpp.feed_bodies import FeedBodies
from roverlink.generator.ir import Feed

_RCLCPP_DEFAULT = ir.Qos()


@dataclass(frozen=True, slots=True)
class Handler:
    """A class that is generated for a topic."""

    route: ir.Route
    name: str
    file: str
    """Its files' name, with their folder."""
    feed: Feed | None


def handlers_of(bridge: ir.Bridge) -> list[Handler]:
    """Those of all topics, in the order of the table."""
    further = named_feeds(bridge)
    found: list[Handler] = []
    for route in bridge.routes:
        name, file = cpp_names.handler_class(route), f"handlers/{cpp_names.handler_file(route)}"
        found.append(Handler(route, name, file, route.feed))
        own = [one for one in further if one.route.number == route.number]
        found += [Handler(one.route, one.name, f"feeds/{one.file}", one.feed) for one in own]
    return found


def emit(bridge: ir.Bridge, context: Context) -> Files:
    """Header and source file of each."""
    for handler in handlers_of(bridge):
        if handler.feed:
            yield from _feed(bridge, handler, handler.feed)
        elif handler.route.conversion:
            yield from _row(bridge, handler, handler.route.conversion, context)


def _row(bridge: ir.Bridge, handler: Handler, conversion: ir.Conversion, context: Context) -> Files:
    bodies = Bodies(conversion, context)
    to_ros, from_ros = list(bodies.to_ros()), list(bodies.from_ros())
    yield from _pair(
        bridge,
        handler,
        conversion.file,
        cpp_names.proto_class(conversion.proto),
        f"{bridge.package}/msg/{conversion.ros}",
        bodies.headers,
        about=f"{conversion.local_name} {_arrow(handler.route)} {handler.route.topic}.",
        way_back="Convert a message. Throws roverlink::ConversionError for a value that the payload cannot hold.",
        taken=[f"const Payload &{named('payload', to_ros)}"],
        given=named("message", from_ros),
        to_ros=layout.body(to_ros),
        from_ros=layout.body(from_ros),
        constants=(),
        functions=(),
        stamped=False,
    )


def _feed(bridge: ir.Bridge, handler: Handler, feed: Feed) -> Files:
    bodies = FeedBodies(feed)
    to_ros, from_ros = list(bodies.to_ros()), list(bodies.from_ros())
    functions = list(bodies.functions())
    shown = feed.message.replace("/msg/", "/")
    yield from _pair(
        bridge,
        handler,
        feed.file,
        cpp_names.proto_class(feed.proto),
        feed.message,
        bodies.headers,
        about=f"{feed.local_name} as {shown} {_arrow(handler.route)} {handler.route.topic}.",
        way_back=_way_back(feed),
        taken=[f"const Payload &{named('payload', to_ros)}", f"const roverlink::Stamp &{named('received', to_ros)}"],
        given=named("message", from_ros),
        to_ros=layout.body(to_ros),
        from_ros=layout.body(from_ros),
        constants=list(bodies.constants()),
        functions=functions,
        stamped=True,
    )


def _pair(
    bridge: ir.Bridge,
    handler: Handler,
    file: str,
    payload: str,
    message: str,
    headers: set[str],
    *,
    about: str,
    way_back: str,
    taken: list[str],
    given: str,
    stamped: bool,
    **view: object,
) -> Files:
    route, package, envelope = handler.route, bridge.package, cpp_names.proto_class(bridge.envelope.message)
    files = Pair(package, handler.file, f"{bridge.table} (row {route.name}) and {file}")
    own = [*map(cpp_names.proto_header, (bridge.envelope.file, file)), cpp_names.interface_header(message)]
    own.append(cpp_names.runtime_header("handler"))
    yield from pair(
        files,
        "handler",
        headers="\n\n".join([*(["#include <utility>"] if route.inbound else []), layout.includes(own)]),
        needed=layout.includes(headers - {files.header}),
        name=handler.name,
        about=layout.comment(f"{route.name} ({route.number}): {about}"),
        route=_route(route),
        inbound=route.inbound,
        envelope=envelope,
        field=cpp_names.accessor(route.name),
        payload=payload,
        message=cpp_names.interface_struct(message),
        way_back=layout.comment(way_back, "  "),
        to_ros_head=layout.signature(f"{handler.name}::Message", f"{handler.name}::to_ros", taken),
        from_ros_head=layout.signature(
            f"{handler.name}::Payload", f"{handler.name}::from_ros", [f"const Message &{given}"]
        ),
        publish_head=layout.signature(
            "void",
            f"{handler.name}::publish",
            [f"const {envelope} & envelope", f"const roverlink::Stamp &{' received' if stamped else ''}"],
            " const",
        ),
        stamped=stamped,
        has_required=any(field.label == "required" for one in bridge.wire_messages for field in one.fields),
        **view,
    )


def _arrow(route: ir.Route) -> str:
    return "to the topic" if route.inbound else "from the topic"


def _route(route: ir.Route) -> str:
    """What a `Route` is made from."""
    parts = [str(route.number), *map(layout.text_literal, (route.name, route.topic, route.direction))]
    if route.qos != _RCLCPP_DEFAULT:
        words = (route.qos.reliability, route.qos.durability, route.qos.history)
        parts.append(f"{{{', '.join(map(layout.text_literal, words))}, {route.qos.depth}}}")
    flat = ", ".join(parts)
    return flat if len(flat) < layout.LINE_LENGTH - 44 else f"\n    {flat}"


def _way_back(feed: Feed) -> str:
    """Write the comment of ``from_ros``."""
    if feed.obstacle:
        return f"Always throws roverlink::ConversionError: {feed.obstacle}."
    lost = f" It does not set {', '.join(feed.lost)}." if feed.lost else ""
    return f"Convert a message.{lost} Throws roverlink::ConversionError for a value that the payload cannot hold."
