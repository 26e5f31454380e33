"""The conversion of a google.protobuf.Any that holds one of the messages that the table lists."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from roverlink.generator import ir
from roverlink.generator.emit.render import header, render
from roverlink.generator.emit.targets.python import layout, spelling
from roverlink.generator.emit.targets.python.bodies import Converter
from roverlink.generator.emit.targets.python.layout import Group, Item


def any_module(bridge: ir.Bridge, conversion: ir.AnyConversion, converter_of: Callable[[str], Converter]) -> str:
    """The text of the module."""
    message = spelling.message_class(conversion.ros)
    by_ros = bridge.conversions()
    held = [by_ros[member.ros] for member in conversion.members]
    own = bridge.python_package
    modules = _local_names({_module(own, one) for one in held}, own)
    used = ["check_empty", "check_none", *(["holds", "packed", "unpacked"] if held else [])]
    imports = [("google.protobuf", "any_pb2"), (f"{own}.messages", message)]
    imports += [("roverlink.runtime.convert.any_of", name) for name in used]
    imports += [
        (package, name if name == local else f"{name} as {local}") for (package, name), local in modules.items()
    ]
    members = []
    for member, one in zip(conversion.members, held):
        converter = converter_of(member.ros)
        imports.append((converter.module, converter.name))
        type = f"{modules[_module(own, one)]}.{one.local_name}"
        members.append(_member(conversion.ros, member, type, converter.name))
    return render(
        "any.py.j2",
        header=header(f"{bridge.table} ({conversion.source})"),
        docstring=layout.docstring(f"{conversion.source} to and from {bridge.package}/msg/{conversion.ros}.", 0),
        imports=layout.import_block(imports),
        members=members,
        message=message,
        check_empty=layout.statement(Group("check_empty(", ["payload", f'"{conversion.ros}"'], ")"), 4),
        check_none=layout.statement(Group("check_none(", ["message.which", f'"{conversion.ros}"'], ")"), 4),
        to_ros_signature=layout.signature("to_ros", ["payload: any_pb2.Any"], message, 0),
        from_ros_signature=layout.signature("from_ros", [f"message: {message}"], "any_pb2.Any", 0),
    )


def _module(generated: str, conversion: ir.Conversion) -> tuple[str, str]:
    """Return the package and the name of the module with a conversion's proto message."""
    return spelling.proto_package(generated, conversion.file), spelling.proto_module(conversion.file)


def _local_names(modules: set[tuple[str, str]], generated: str) -> Mapping[tuple[str, str], str]:
    """What each module is called, by its package and its name: with its folders where another has the same name."""
    names = ["any_pb2", *(name for _, name in modules)]
    return {
        (package, name): (
            name if names.count(name) == 1 else f"{package}.{name}".removeprefix(f"{generated}.").replace(".", "_")
        )
        for package, name in sorted(modules)
    }


def _member(ros: str, member: ir.AnyMember, type: str, converter: str) -> dict[str, str]:
    """The pieces of Python for one of the messages."""
    message = spelling.message_class(ros)
    constant = f"{message}.{member.constant}"
    unpacked = Group("unpacked(", ["payload", type, f'"{ros}.{member.field}"'], ")")
    made: list[Item] = [f"which={constant}", Group(f"{member.field}={converter}.to_ros(", [unpacked], ")")]
    packed = Group(f"{converter}.from_ros(", [f"message.{member.field}"], ")")
    return {
        "is_held": layout.statement(Group("if holds(", ["payload", type], "):"), 4),
        "to_ros": layout.statement(Group(f"return {message}(", made, ")"), 8),
        "is_said": layout.line(f"if message.which == {constant}:", 4),
        "from_ros": layout.statement(Group("return packed(", [packed], ")"), 8),
    }
