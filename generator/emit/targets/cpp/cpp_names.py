"""What C++ calls the things of the IR: protobuf's classes and accessors, rosidl's structs, and our own classes."""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.ir import ros_names

_PRIMITIVES = {
    "bool": "bool",
    "byte": "unsigned char",
    "octet": "unsigned char",
    "char": "unsigned char",
    "float32": "float",
    "float64": "double",
    "string": "std::string",
}


def accessor(field: str) -> str:
    """How protobuf's C++ names a field, or the part of a function's name that is the field's.

    >>> accessor("wheelSpeed"), accessor("class")
    ('wheelspeed', 'class_')
    """
    return _escaped(field.lower())


def getter(path: tuple[str, ...]) -> str:
    """Spell a field of a payload, or of a message in it: ``payload.inner().x()``; the payload for the empty path."""
    return "".join(["payload", *(f".{accessor(name)}()" for name in path)])


def proto_class(full_name: str) -> str:
    """The class of a proto message: ``::rover::Arm::Joint``."""
    return "".join(f"::{_escaped(part)}" for part in full_name.split("."))


def _escaped(name: str) -> str:
    return f"{name}_" if ros_names.is_cpp_keyword(name) or name == "NULL" else name


def proto_header(file: str) -> str:
    """The header that protoc makes of a .proto file."""
    return f"{file.removesuffix('.proto')}.pb.h"


def runtime_header(name: str) -> str:
    """Return the path of a header of the C++ runtime library, as an include directive names it."""
    return f"roverlink/{name}.hpp"


def struct(package: str, message: str) -> str:
    """The struct of a ROS message: ``comms::msg::BoundingBox``."""
    return f"{package}::msg::{message}"


def interface_struct(message: str) -> str:
    """The struct of a standard message, by its full name."""
    return message.replace("/", "::")


def interface_header(message: str) -> str:
    """The header of a ROS message, by its full name: ``sensor_msgs/msg/nav_sat_fix.hpp``."""
    folder, _, name = message.rpartition("/")
    return f"{folder}/{ros_names.snake_case(name)}.hpp"


def primitive(name: str) -> str:
    """The type that rosidl gives a ROS primitive, or a string."""
    return _PRIMITIVES.get(name) or f"std::{name}_t"


def handler_class(route: ir.Route) -> str:
    """``ImuInfoHandler`` for the row ``imu_info``."""
    return f"{ros_names.camel_case(route.name)}Handler"


def handler_file(route: ir.Route) -> str:
    """The name of the handler's files: ``imu_info``."""
    return route.name.lower()


def conversion_class(message: str) -> str:
    """The class with the conversion of a message that is no row's."""
    return f"{message}Conversion"


def conversion_file(message: str) -> str:
    """The name of its files."""
    return ros_names.snake_case(message)
