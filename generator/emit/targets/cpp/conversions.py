"""The classes with ``to_ros`` and ``from_ros`` of what stands inside payloads, and where each conversion is found."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roverlink.generator import ir
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.cpp import cpp_names, layout
from roverlink.generator.emit.targets.cpp.bodies import Bodies
from roverlink.generator.emit.targets.cpp.conversion_context import Context, Converter
from roverlink.generator.emit.targets.cpp.cpp_files import Pair, pair


def context_of(bridge: ir.Bridge) -> Context:
    """What bodies look up; a conversion stands in a row's handler, or in a class of its own."""
    handlers = {route.conversion.ros: route for route in reversed(bridge.routes) if route.conversion}

    def converter_of(ros: str) -> Converter:
        if route := handlers.get(ros):
            header = f"{bridge.package}/handlers/{cpp_names.handler_file(route)}.hpp"
            return Converter(header, cpp_names.handler_class(route))
        return Converter(
            f"{bridge.package}/conversions/{cpp_names.conversion_file(ros)}.hpp", cpp_names.conversion_class(ros)
        )

    return Context(bridge, converter_of)


def emit(bridge: ir.Bridge, context: Context) -> Files:
    """A header and a source file for each message that is in payloads, and for each Any."""
    for conversion in bridge.nested:
        bodies = Bodies(conversion, context)
        yield from _pair(
            bridge,
            conversion.ros,
            f"{bridge.table} and {conversion.file}",
            cpp_names.proto_class(conversion.proto),
            cpp_names.proto_header(conversion.file),
            f"{conversion.local_name} to and from {bridge.package}/msg/{conversion.ros}.",
            list(bodies.to_ros()),
            list(bodies.from_ros()),
            bodies.headers,
        )
    for any in bridge.anys:
        yield from _any_pair(bridge, any, context)


def _pair(
    bridge: ir.Bridge,
    ros: str,
    origin: str,
    payload: str,
    payload_header: str,
    about: str,
    to_ros: list[str],
    from_ros: list[str],
    headers: set[str],
) -> Files:
    name, message = cpp_names.conversion_class(ros), cpp_names.struct(bridge.package, ros)
    header = cpp_names.interface_header(f"{bridge.package}/msg/{ros}")
    files = Pair(bridge.package, f"conversions/{cpp_names.conversion_file(ros)}", origin)
    taken, given = named("payload", to_ros), named("message", from_ros)
    yield from pair(
        files,
        "conversion",
        headers=layout.includes([payload_header, header]),
        needed=layout.includes(headers - {files.header}),
        name=name,
        about=layout.comment(about),
        to_ros_declared=layout.signature(f"static {message}", "to_ros", [f"const {payload} & payload"], ";", "  "),
        from_ros_declared=layout.signature(f"static {payload}", "from_ros", [f"const {message} & message"], ";", "  "),
        to_ros_head=layout.signature(message, f"{name}::to_ros", [f"const {payload} &{taken}"]),
        from_ros_head=layout.signature(payload, f"{name}::from_ros", [f"const {message} &{given}"]),
        to_ros=layout.body(to_ros),
        from_ros=layout.body(from_ros),
    )


def named(parameter: str, statements: list[str]) -> str:
    """A parameter's name with a space before it, where statements use it; else nothing."""
    used = re.compile(rf"(?<![\w\".]){parameter}(?=[.,;)])")
    return f" {parameter}" if any(used.search(line) for line in statements) else ""


# --- google.protobuf.Any ----------------------------------------------------------------------------------------


def _any_pair(bridge: ir.Bridge, any: ir.AnyConversion, context: Context) -> Files:
    by_ros = bridge.conversions()
    headers = {cpp_names.runtime_header("any"), cpp_names.runtime_header("values")}
    headers |= {context.converter_of(member.ros).header for member in any.members}
    headers |= {cpp_names.proto_header(by_ros[member.ros].file) for member in any.members}
    yield from _pair(
        bridge,
        any.ros,
        f"{bridge.table} ({any.source})",
        cpp_names.proto_class("google.protobuf.Any"),
        "google/protobuf/any.pb.h",
        f"{any.source} to and from {bridge.package}/msg/{any.ros}.",
        list(_any_to_ros(any, context)),
        list(_any_from_ros(any, context)),
        headers,
    )


def _any_to_ros(any: ir.AnyConversion, context: Context) -> Iterator[str]:
    message = context.struct(any.ros)
    yield f"{message} message;"
    for index, member in enumerate(any.members):
        held = cpp_names.proto_class(member.proto)
        unpacked = f'roverlink::unpacked<{held}>(payload, "{any.ros}.{member.field}")'
        yield f"{'} else ' if index else ''}if (roverlink::holds<{held}>(payload)) {{"
        yield f"  message.which = {message}::{member.constant};"
        yield f"  message.{member.field} = {context.converter_of(member.ros).name}::to_ros({unpacked});"
    if any.members:
        yield from ("} else {", f'  roverlink::check_empty(payload, "{any.ros}");', "}")
    else:
        yield f'roverlink::check_empty(payload, "{any.ros}");'
    yield "return message;"


def _any_from_ros(any: ir.AnyConversion, context: Context) -> Iterator[str]:
    yield "switch (message.which) {"
    yield from ("  case 0:", f"    return {cpp_names.proto_class('google.protobuf.Any')}();")
    for member in any.members:
        made = f"{context.converter_of(member.ros).name}::from_ros(message.{member.field})"
        yield from (f"  case {context.struct(any.ros)}::{member.constant}:", f"    return roverlink::packed({made});")
    yield from ("  default:", f'    throw roverlink::no_member(message.which, "{any.ros}.which");', "}")
