"""Names of generated Python modules and classes, and annotations and defaults of fields, for the parts of the IR."""

from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Iterator

from roverlink.generator import ir
from roverlink.generator.emit.targets.python.imports import Import
from roverlink.generator.ir import ros_names
from roverlink.generator.ir.protobuf_facts import module_path

_ANNOTATIONS = {
    "bool": "Bool",
    "int8": "Int8",
    "uint8": "UInt8",
    "int16": "Int16",
    "uint16": "UInt16",
    "int32": "Int32",
    "uint32": "UInt32",
    "int64": "Int64",
    "uint64": "UInt64",
    "float32": "Float32",
    "float64": "Float64",
}
_DEFAULTS = {"bool": "False", "float32": "0.0", "float64": "0.0"}
_TAKEN_CLASSES = frozenset(
    {
        *_ANNOTATIONS.values(),
        "ClassVar",
        "Duration",
        "Handler",
        "Message",
        "Qos",
        "Route",
        "RowRequest",
        "RowService",
        "Time",
    }
)
RUNTIME_MODULES = frozenset(
    {"cdr", "depth", "duration", "json_list", "json_struct", "json_value", "oneof", "timestamp"}
)
"""Names of the runtime's modules that generated code imports. Other names in generated code must differ from them."""
_TAKEN_MODULES = frozenset(
    {
        *dir(builtins),
        *RUNTIME_MODULES,
        *("check_empty", "check_none", "holds", "item", "key", "keywords", "mapping", "message", "packed"),
        *("payload", "unpacked", "value"),
    }
)


def handler_class(route: ir.Route) -> str:
    """Return the name of a row's handler class: ``ImuInfoHandler`` for the row ``imu_info``."""
    return f"{ros_names.camel_case(route.name)}Handler"


def route_imports(route: ir.Route) -> Iterator[Import]:
    """Yield the imports for the attribute ``route`` of a generated handler: `Route`, `Deadman`, `SendLimits`, `Qos`."""
    module = "roverlink.runtime.core.handler"
    yield module, "Route"
    if route.deadman:
        yield module, "Deadman"
    if route.request:
        yield module, "RowRequest"
        if route.request.service:
            yield module, "RowService"
    if route.send or route.forward_limits:
        yield module, "SendLimits"
    if route.qos != ir.Qos():
        yield module, "Qos"


def documented(comment: str, summary: str) -> str:
    """Return the docstring of a generated class, made from a comment in the .proto file.

    If the comment is not a single complete sentence, the docstring starts with ``summary``, and the comment follows.
    """
    is_sentence = re.fullmatch(r"(?!This )[A-Z].*\.(\n\nDeprecated\.)?", comment)
    return comment if is_sentence else f"{summary}\n\n{comment}".rstrip()


def class_suppression(name: str, ros: str) -> str:
    """Return the comment that lets ruff accept a class name with an underscore (N801).

    Return an empty text if ``name`` is the name of the ROS message, ``ros``, and this name has no underscore.
    """
    if "_" in ros:
        return "  # noqa: N801  # as rosidl names it"
    return "" if name == ros else "  # noqa: N801  # the name without underscore is used here"


def module(name: str) -> str:
    """Return a name as that of a Python module, in lower case; ``import_`` for ``import``, which is a keyword."""
    lower = name.lower()
    return f"{lower}_" if keyword.iskeyword(lower) else lower


def message_class(message: str) -> str:
    """Return the class name of a ROS message: ``Arm``; ``Time_`` for ``Time``, which generated code uses itself."""
    taken = message in _TAKEN_CLASSES or message.endswith("Handler") or keyword.iskeyword(message)
    return f"{message}_" if taken else message


def message_module(message: str) -> str:
    """Return the name of the module with a ROS message's class: ``bounding_box`` for ``BoundingBox``."""
    return module(ros_names.snake_case(message))


def service_module(part: ir.RosMessage) -> str:
    """Return the name of the module with the class of a service's request or response: ``measure_rock_request``."""
    return "_".join(map(ros_names.snake_case, part.name.split("_")))


def conversion_module(message: str) -> str:
    """Return the name of the module that converts a nested message: ``bounding_box`` for ``BoundingBox``.

    If generated code uses this name for something else, the module's name ends with an underscore.
    """
    name = message_module(message)
    return f"{name}_" if name in _TAKEN_MODULES or name.endswith("_pb2") else name


def proto_module(file: str) -> str:
    """Return the name of the module with a .proto file's classes: ``imu_pb2`` for ``sensors/imu.proto``."""
    return module_path(file).rpartition("/")[2]


def proto_package(generated: str, file: str) -> str:
    """Return the package of the module with a .proto file's classes.

    For ``sensors/imu.proto``, this is ``generated.pb2.sensors``. The argument ``generated`` is the import name of the
    generated package.
    """
    folder = module_path(file).rpartition("/")[0]
    if folder == "google/protobuf":  # these modules are part of Python's protobuf library
        return "google.protobuf"
    return ".".join([generated, "pb2", *filter(None, folder.split("/"))])


def proto_class(conversion: ir.Conversion) -> str:
    """Return a proto message's class, with its module: ``imu_sensor_pb2.SensorBoardIMUInfo``."""
    return f"{proto_module(conversion.file)}.{conversion.local_name}"


def class_of(type: ir.RosType) -> str:
    """Return the class name of a field's ROS message. Messages of other ROS packages keep their name."""
    return type.name if type.package else message_class(type.name)


def annotation(type: ir.RosType, message: str) -> str:
    """Return a field's annotation in a message class: ``Float32``, ``bytes``, ``list[BoundingBox]``.

    ``message`` is the class name if the field's type is a ROS message, otherwise empty.
    """
    element = message or _ANNOTATIONS.get(type.name, "str")
    if not type.is_sequence:
        return element
    return "bytes" if type.name == "uint8" else f"list[{element}]"


def imported_annotation(type: ir.RosType) -> str | None:
    """Return the name that a field's annotation needs from `roverlink.runtime.core.messages`: ``Float32``.

    Return None if the annotation needs no name from this module.
    """
    if type.is_message or (type.is_sequence and type.name == "uint8"):
        return None
    return _ANNOTATIONS.get(type.name)


def primitive(name: str) -> str:
    """Return the annotation of a primitive ROS type: ``Float64`` for ``float64``."""
    return {"byte": "Byte", "octet": "Byte", "char": "Char"}.get(name) or _ANNOTATIONS[name]


def default(type: ir.RosType) -> str:
    """Return the default of a primitive, string or bytes field in a message class, as source code: ``0.0``."""
    if type.is_sequence:
        return 'b""'
    return '""' if type.name == "string" else _DEFAULTS.get(type.name, "0")
