"""C++ classes that convert nested messages, and messages inside an Any."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.render import Files
from roverlink.generator.emit.targets.cpp import cpp_names
from roverlink.generator.emit.targets.cpp.conversion_context import Context, Converter
from roverlink.generator.emit.targets.cpp.conversion_fields import fields_of
from roverlink.generator.emit.targets.cpp.cpp_files import CppFile
from roverlink.generator.emit.targets.cpp.literals import comment_lines
from roverlink.generator.resolve import well_known


@dataclass(frozen=True, slots=True)
class Conversion:
    """C++ class that is generated for a nested message, with the functions ``to_ros`` and ``from_ros``."""

    name: str
    payload_name: str
    """Name of the proto message without its package."""
    payload: str
    """C++ class of the proto message."""
    payload_header: str
    ros: str
    """ROS message with its package, as in ``rover/Sample``."""
    message: str
    """C++ struct of the ROS message."""
    message_header: str
    comment: list[str]


@dataclass(frozen=True, slots=True)
class Member:
    """One of the messages that a google.protobuf.Any may contain."""

    payload: str
    """C++ class of the proto message."""
    name: str
    """Field of the ROS message that holds this message."""
    constant: str
    converter: Converter


def emit(bridge: ir.Bridge, context: Context) -> Files:
    """Yield a header and a source file for each nested message, and for each Any."""
    for conversion in bridge.nested:
        file = _file(bridge, conversion.ros, f"{bridge.table} and {conversion.file}")
        fields = fields_of(conversion, context)
        payload_header = cpp_names.proto_header(conversion.file)
        comment = comment_lines(context.comment(conversion.ros))
        view = _conversion(context, conversion.ros, conversion.proto, conversion.local_name, payload_header, comment)
        yield from file.header("conversion", conversion=view)
        yield from file.source("conversion", conversion=view, fields=fields, headers=fields.headers - {file.include})
    for any in bridge.anys:
        file = _file(bridge, any.ros, f"{bridge.table} ({any.source})")
        view = _conversion(context, any.ros, well_known.ANY, any.source, "google/protobuf/any.pb.h", [])
        yield from file.header("conversion", conversion=view)
        yield from file.source("any", conversion=view, ros=any.ros, **_members(bridge, any, context))


def _file(bridge: ir.Bridge, ros: str, origin: str) -> CppFile:
    return CppFile(bridge.package, f"conversions/{cpp_names.conversion_file(ros)}", origin)


def _conversion(
    context: Context, ros: str, proto: str, payload_name: str, payload_header: str, comment: list[str]
) -> Conversion:
    package = context.bridge.package
    return Conversion(
        cpp_names.conversion_class(ros),
        payload_name,
        cpp_names.proto_class(proto),
        payload_header,
        f"{package}/{ros}",
        context.struct(ros),
        cpp_names.interface_header(f"{package}/msg/{ros}"),
        comment,
    )


def _members(bridge: ir.Bridge, any: ir.AnyConversion, context: Context) -> dict[str, object]:
    files = {conversion.ros: conversion.file for conversion in bridge.conversions().values()}
    members = [
        Member(
            cpp_names.proto_class(member.proto),
            member.field,
            f"{context.struct(any.ros)}::{member.constant}",
            context.converter(member.ros),
        )
        for member in any.members
    ]
    headers = {member.converter.header for member in members}
    headers |= {cpp_names.proto_header(files[member.ros]) for member in any.members}
    return {"members": members, "headers": headers}
