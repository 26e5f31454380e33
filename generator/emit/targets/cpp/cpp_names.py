"""C++ names of protobuf's classes and accessors, of rosidl's structs, and of our generated classes.

protoc writes accessors in lower case, and adds an underscore to names that are keywords. rosidl names a header after
the message in snake_case.
"""

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
    """Return the name of protobuf's C++ accessor that reads a field; other accessors add a prefix such as ``set_``.

    >>> accessor("wheelSpeed"), accessor("class")
    ('wheelspeed', 'class_')
    """
    return _escaped(field.lower())


def getter(path: tuple[str, ...]) -> str:
    """Return the C++ expression for a field inside the payload: ``payload.inner().x()``.

    The expression of an empty path is ``payload``.
    """
    return "".join(["payload", *(f".{accessor(name)}()" for name in path)])


def proto_class(full_name: str) -> str:
    """Return protobuf's C++ class of a proto message: ``::rover::Arm::Joint``."""
    return "".join(f"::{_escaped(part)}" for part in full_name.split("."))


def _escaped(name: str) -> str:
    return f"{name}_" if ros_names.is_cpp_keyword(name) or name == "NULL" else name


def proto_header(file: str) -> str:
    """Return the path of the header that protoc generates for a .proto file."""
    return f"{file.removesuffix('.proto')}.pb.h"


def runtime_header(name: str) -> str:
    """Return the path of a header of our C++ runtime library, as an include directive writes it."""
    return f"roverlink/{name}.hpp"


def struct(package: str, message: str) -> str:
    """Return the C++ struct of a ROS message: ``comms::msg::BoundingBox``."""
    return f"{package}::msg::{message}"


def interface_struct(message: str) -> str:
    """Return the name of a standard message's C++ struct: ``sensor_msgs::msg::Imu`` for ``sensor_msgs/msg/Imu``."""
    return message.replace("/", "::")


def interface_header(message: str) -> str:
    """Return the path of a ROS message's header, by the message's full name: ``sensor_msgs/msg/nav_sat_fix.hpp``."""
    folder, _, name = message.rpartition("/")
    return f"{folder}/{ros_names.snake_case(name)}.hpp"


def primitive(name: str) -> str:
    """Return the C++ type that rosidl generates for a ROS primitive or a string."""
    return _PRIMITIVES.get(name) or f"std::{name}_t"


def handler_class(route: ir.Route) -> str:
    """Return the name of a row's handler class: ``ImuInfoHandler`` for the row ``imu_info``."""
    return f"{ros_names.camel_case(route.name)}Handler"


def handler_file(route: ir.Route) -> str:
    """Return the name of the files of a row's handler class, without a suffix: ``imu_info``."""
    return route.name.lower()


def conversion_class(message: str) -> str:
    """Return the name of the class that converts a nested ROS message."""
    return f"{message}Conversion"


def conversion_file(message: str) -> str:
    """Return the name of the files of the class that converts a nested ROS message, without a suffix."""
    return ros_names.snake_case(message)
