"""Generated dataclasses of the messages in the generated ROS 2 package: one module with one class for each message."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.imports import Import, import_lines
from roverlink.generator.emit.targets.python.packages import package_file
from roverlink.generator.emit.type_hashes import type_hashes


@dataclass(frozen=True, slots=True)
class _Field:
    """Field of a generated dataclass, as source code."""

    name: str
    annotation: str
    default: str
    comment: str

    @property
    def suppression(self) -> str:
        """Comment that lets ruff accept the name ``l``, which looks like a 1 (E741)."""
        return "  # noqa: E741  # as in the .proto" if self.name == "l" else ""


def emit(bridge: ir.Bridge) -> Files:
    """Yield a module for each message class, and the ``__init__.py`` of their package."""
    hashes = type_hashes(bridge)
    for message in bridge.messages:
        text = message_file(bridge, message, f"{bridge.package}/msg/{message.name}", hashes[message.name])
        yield f"generated/messages/{spelling.message_module(message.name)}.py", text
    classes = {
        spelling.message_class(message.name): spelling.message_module(message.name) for message in bridge.messages
    }
    yield package_file(bridge, "messages", f"Messages of the ROS 2 package {bridge.package}.", classes)


def message_file(bridge: ir.Bridge, message: ir.RosMessage, ros: str, type_hash: str) -> str:
    """Return the module with the class of a message, whose full name in ROS 2 is ``ros``.

    ``type_hash`` is empty for a part of a service, which nothing compares by its hash.
    """
    needed = {spelling.imported_annotation(field.type) for field in message.fields} - {None}
    imports: set[Import] = {("roverlink.runtime.core.messages", name) for name in ("Message", *needed) if name}
    local = _local_classes(bridge, message)
    imports |= {
        (module, name if name == local[name] else f"{name} as {local[name]}")
        for module, name in _classes(bridge, message)
    }
    fields = [_field(field, local) for field in message.fields]
    name = spelling.message_class(message.name)
    return render(
        "message.py.j2",
        header=header(f"{bridge.table} ({message.source})"),
        imports=import_lines(imports),
        uses_dataclasses=any("dataclasses." in field.default for field in fields),
        about=spelling.documented(message.comment, f"Made from {message.source}."),
        suppression=spelling.class_suppression(name, message.name),
        name=name,
        ros=ros,
        type_hash=type_hash,
        constants_by_field=[
            (" and ".join(field.name for field in message.fields if field.enum == enum), list(constants))
            for enum, constants in itertools.groupby(message.constants, lambda constant: constant.enum)
        ],
        fields=fields,
    )


def _classes(bridge: ir.Bridge, message: ir.RosMessage) -> set[Import]:
    """Return module and name of the class of each field that is a message itself."""
    types = [field.type for field in message.fields if field.type.is_message]
    return {
        (
            (
                "roverlink.runtime.interfaces"
                if type.package
                else f"{bridge.python_package}.messages.{spelling.message_module(type.name)}"
            ),
            spelling.class_of(type),
        )
        for type in types
    }


def _local_classes(bridge: ir.Bridge, message: ir.RosMessage) -> Mapping[str, str]:
    """Return the local name under which the module imports the class of each message field: ``Point``.

    The name is ``Point_`` if the message has a constant ``Point``, which hides the class inside the class body.
    """
    constants = {constant.name for constant in message.constants}
    return {name: f"{name}_" if name in constants else name for _, name in _classes(bridge, message)}


def _field(field: ir.RosField, local: Mapping[str, str]) -> _Field:
    type = field.type
    name = local[spelling.class_of(type)] if type.is_message else ""
    is_value = type.name == "uint8" or not (type.is_sequence or type.is_message)
    factory = "list" if type.is_sequence else name
    default = spelling.default(type) if is_value else f"dataclasses.field(default_factory={factory})"
    return _Field(field.name, spelling.annotation(type, name), default, field.comment)
