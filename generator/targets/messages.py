"""One dataclass a ROS message, in a module of its own."""

from __future__ import annotations

from generator import ir
from generator.targets import layout, spelling
from generator.targets.conversions import Files
from generator.targets.rendering import header, render


def emit(bridge: ir.Bridge) -> Files:
    """The messages, and the package that names them all."""
    for message in bridge.messages:
        yield f"generated/messages/{spelling.message_module(message.name)}.py", _message(bridge, message)
    names = sorted(message.name for message in bridge.messages)
    imports = [
        layout.import_from(f"generated.messages.{module}", [name])
        for module, name in sorted((spelling.message_module(name), name) for name in names)
    ]
    yield (
        "generated/messages/__init__.py",
        render(
            "package.py.j2",
            header=header(bridge.table),
            docstring=layout.docstring(f"The messages of the ROS 2 package {bridge.package}.", 0),
            imports=imports,
            names=names,
        ),
    )


def _message(bridge: ir.Bridge, message: ir.RosMessage) -> str:
    needed = {spelling.imported_annotation(field.type) for field in message.fields} - {None}
    nested = sorted({f.type.name for f in message.fields if f.type.is_message})
    imports = [layout.import_from(f"generated.messages.{spelling.message_module(name)}", [name]) for name in nested]
    imports.append(layout.import_from("runtime.messages", ["Message", *(name for name in needed if name)]))
    type_name = f"{bridge.package}/msg/{message.name}"
    fields = [
        {
            "statement": _field(field),
            "docstring": layout.docstring(field.comment, 4) if field.comment else "",
        }
        for field in message.fields
    ]
    return render(
        "message.py.j2",
        header=header(f"{bridge.table} ({message.source})"),
        docstring=layout.docstring(f"{type_name}.", 0),
        class_docstring=layout.docstring(message.comment or f"Made from {message.source}.", 4),
        uses_dataclasses=any("dataclasses." in field["statement"] for field in fields),
        imports=imports,
        name=message.name,
        type_name=type_name,
        constants=message.constants,
        fields=fields,
    )


def _field(field: ir.RosField) -> str:
    head = f"{field.name}: {spelling.annotation(field.type)} = "
    if field.type.name == "uint8" or not (field.type.is_sequence or field.type.is_message):
        return head + spelling.default(field.type)
    factory = "list" if field.type.is_sequence else field.type.name
    return layout.statement(layout.Group(f"{head}dataclasses.field(", [f"default_factory={factory}"], ")"), 4)
