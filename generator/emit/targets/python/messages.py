"""One dataclass a ROS message, in a module of its own."""

from __future__ import annotations

import re
from collections.abc import Mapping

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import layout, spelling
from roverlink.generator.emit.type_hashes import type_hashes


def emit(bridge: ir.Bridge) -> Files:
    """The messages, and the package that names them all."""
    hashes = type_hashes(bridge)
    for message in bridge.messages:
        text = _message(bridge, message, hashes[message.name])
        yield f"generated/messages/{spelling.message_module(message.name)}.py", text
    names = sorted(message.name for message in bridge.messages)
    yield (
        "generated/messages/__init__.py",
        render(
            "package.py.j2",
            header=header(bridge.table),
            docstring=layout.docstring(f"The messages of the ROS 2 package {bridge.package}.", 0),
            imports=layout.in_import_order(_import(bridge, name) for name in names),
            names=[spelling.message_class(name) for name in names],
        ),
    )


def _import(bridge: ir.Bridge, name: str) -> str:
    module = f"{bridge.python_package}.messages.{spelling.message_module(name)}"
    return layout.import_from(module, [spelling.message_class(name)])


def _message(bridge: ir.Bridge, message: ir.RosMessage, type_hash: str) -> str:
    needed = {spelling.imported_annotation(field.type) for field in message.fields} - {None}
    imports = [("roverlink.runtime.core.messages", name) for name in ("Message", *needed) if name]
    local = _local_classes(bridge, message)
    imports += [
        (module, name if name == local[name] else f"{name} as {local[name]}")
        for module, name in _classes(bridge, message)
    ]
    type_name = f"{bridge.package}/msg/{message.name}"
    fields = [
        {
            "statement": _field(field, local),
            "docstring": layout.docstring(field.comment, 4) if field.comment else "",
        }
        for field in message.fields
    ]
    return render(
        "message.py.j2",
        header=header(f"{bridge.table} ({message.source})"),
        docstring=layout.docstring(f"{type_name}.", 0),
        class_docstring=layout.docstring(_about(message), 4),
        uses_dataclasses=any("dataclasses." in field["statement"] for field in fields),
        imports=layout.import_block(imports),
        class_line=_class_line(message),
        type_line=layout.line(f'__msgtype__: ClassVar[str] = "{type_name}"', 4),
        type_hash=type_hash,
        constants=[
            layout.line(f"{constant.name}: ClassVar[int] = {constant.value}", 4) for constant in message.constants
        ],
        fields=fields,
    )


def _classes(bridge: ir.Bridge, message: ir.RosMessage) -> set[tuple[str, str]]:
    """The classes of its fields, each after its module."""
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
    """What each class is called in this module: inside a class, a constant hides a class of its name."""
    constants = {constant.name for constant in message.constants}
    return {name: f"{name}_" if name in constants else name for _, name in _classes(bridge, message)}


def _about(message: ir.RosMessage) -> str:
    """The message's comment; where that is no sentence, below one that says where the message is from."""
    source = f"Made from {message.source}."
    if not message.comment or re.fullmatch(r"(?!This )[A-Z].*\.(\n\nDeprecated\.)?", message.comment):
        return message.comment or source
    return f"{source}\n\n{message.comment}"


def _class_line(message: ir.RosMessage) -> str:
    name = spelling.message_class(message.name)
    suppression = "" if name == message.name else "  # noqa: N801  # the code here needs the name itself"
    return f"class {name}(Message):{suppression}"


def _field(field: ir.RosField, local: Mapping[str, str]) -> str:
    name = local[spelling.class_of(field.type)] if field.type.is_message else ""
    head = f"{field.name}: {spelling.annotation(field.type, name)} = "
    factory = "list" if field.type.is_sequence else name
    group = layout.Group(f"{head}dataclasses.field(", [f"default_factory={factory}"], ")")
    is_value = field.type.name == "uint8" or not (field.type.is_sequence or field.type.is_message)
    flat = head + spelling.default(field.type) if is_value else group.flat()
    if field.name == "l":
        return layout.line(f"{flat}  # noqa: E741  # as in the .proto", 4)
    if is_value or len(group.head) + 4 > layout.LINE_LENGTH:
        return layout.line(flat, 4)
    return layout.statement(group, 4)
