"""Check for names in the .proto files that cannot be used in C++, or whose accessors differ between protobuf versions.

The check is part of the generator, so that the user gets a diagnostic and not an error of the C++ compiler.
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Rule, Span
from roverlink.generator.emit.targets.cpp import cpp_names
from roverlink.generator.ir import ros_names


class CppName(Rule, id="CPP101"):
    """A name in the protos cannot be used in C++, or gets different accessors from different versions of protobuf.

    The generated C++ would compile on one machine and fail on another. The encoding contains no names, except in a
    google.protobuf.Any, which contains the name of its message. So the name can usually be changed.

    Bad::

        # mapping.yaml
        targets: [python, cpp]
        # proto/imu.proto
        message Imu { float requires = 1; }

    Good::

        # mapping.yaml
        targets: [python, cpp]
        # proto/imu.proto
        message Imu { float required_force = 1; }
    """


_RUNTIME = "roverlink"
_KNOWN_SINCE_22 = frozenset(
    {
        *("char8_t", "char16_t", "char32_t", "co_await", "co_return", "co_yield"),
        *("concept", "consteval", "constinit", "requires"),
    }
)
"""C++20 keywords. If a field has such a name, protobuf 22 and later add an underscore to the accessor's name.

Earlier versions do not.
"""
_METHODS_OF_EVERY_CLASS = frozenset(
    {"default_instance", "descriptor", "internal_default_instance", "mutable_unknown_fields", "unknown_fields"}
)
"""Functions without parameters that every class of protobuf has.

If a field has such a name, newer versions of protobuf rename the field's accessor, and older versions do not.
"""


def check(bridge: ir.Bridge) -> None:
    """Raise `DiagnosticsError` with one diagnostic for each name that cannot be used in C++."""
    files = {conversion.proto: conversion.file for conversion in bridge.conversions().values()}
    files |= {standard.proto: standard.file for route in bridge.routes for standard in route.standard_topics}
    findings: list[Diagnostic] = []
    if bridge.package == _RUNTIME:
        fault = f"the package {_RUNTIME!r} would have the same C++ namespace and headers as the C++ runtime library"
        findings.append(CppName.at(Span(bridge.table), fault, "give the ROS 2 package another name"))
    for message in bridge.wire_messages:
        if message.map_entry or message.name.startswith("google.protobuf."):
            continue
        span = Span(files.get(message.name, bridge.table))
        why = [_of_message(bridge, message.name), *_of_fields(message)]
        findings += [
            CppName.at(
                span,
                fault,
                "rename the message or field; names are not sent, so the encoding does not change",
                type=message.name,
            )
            for fault in why
            if fault
        ]
    if findings:
        raise DiagnosticsError(findings)


def _of_message(bridge: ir.Bridge, name: str) -> str:
    """Return the reason why a message's name cannot be used in C++; empty if it can."""
    *outer, _ = name.split(".")
    if name.split(".")[0] == _RUNTIME and name != ir.LINK_MESSAGE:  # the library has no such name
        return f"the class of the message {name!r} would be in {_RUNTIME!r}, the namespace of the C++ runtime library"
    if keywords := [part for part in outer if ros_names.is_cpp_keyword(part)]:
        return f"the class of the message {name!r} would be in the namespace {keywords[0]!r}, which is a C++ keyword"
    packages = {bridge.package, *(interface.package for interface in bridge.interfaces)}
    namespaces = {*packages, *(f"{package}.msg" for package in packages), f"{bridge.package}.handlers"}
    structs = {f"{bridge.package}.msg.{message.name}" for message in bridge.messages}
    structs |= {interface.name.replace("/", ".") for interface in bridge.interfaces}
    if name in namespaces | structs:
        kind = "namespace" if name in namespaces else "struct"
        name_in_cpp = cpp_names.proto_class(name)
        return f"the class of the message {name!r} would have the same name as a {kind} of ROS 2, {name_in_cpp}"
    return ""


def _of_fields(message: ir.WireMessage) -> Iterator[str]:
    """Yield the reasons why names of a message's fields cannot be used in C++."""
    taken: dict[str, str] = {}
    for field in message.fields:
        name = cpp_names.accessor(field.name)
        taken |= {f"{name}_size" if field.label == "repeated" else f"has_{name}": field.name}
    for field in message.fields:
        place, name = f"{message.name}.{field.name}", field.name.lower()
        if name in _KNOWN_SINCE_22:
            yield f"the field {place!r} has the name of a C++20 keyword; protobuf 22 and later give it another accessor"
        elif name in _METHODS_OF_EVERY_CLASS:
            yield f"the field {place!r} would have the accessor {name}(), which every protobuf class already has"
        elif name in taken and _is_there(message, taken[name]):
            yield f"the field {place!r} would have the accessor {name}(), which the field {taken[name]!r} already has"


def _is_there(message: ir.WireMessage, name: str) -> bool:
    """Return True if protobuf's class has a function for the field's presence (``has_``) or its size (``_size``)."""
    field = next(field for field in message.fields if field.name == name)
    return bool(field.label or field.oneof) or "." in field.type or field.type[:1].isupper()
