"""Generated modules that convert a google.protobuf.Any. The table lists the messages that the Any may contain."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.render import header, render
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.expressions import Converter
from roverlink.generator.emit.targets.python.imports import Import, import_lines


@dataclass(frozen=True, slots=True)
class _Member:
    """Message that the Any may contain."""

    type: str
    """Protobuf class of the message."""
    converter: str
    field: str
    constant: str


def any_module(bridge: ir.Bridge, conversion: ir.AnyConversion, converter_of: Callable[[str], Converter]) -> str:
    """Return the text of the module that converts one Any; ``converter_of`` returns the converter of a ROS message."""
    message = spelling.message_class(conversion.ros)
    by_ros = bridge.conversions()
    held = [by_ros[member.ros] for member in conversion.members]
    own = bridge.python_package
    modules = _local_names({_module(own, held_conversion) for held_conversion in held}, own)
    used = ["check_empty", "check_none", *(["holds", "packed", "unpacked"] if held else [])]
    imports: set[Import] = {("google.protobuf", "any_pb2"), (f"{own}.messages", message)}
    imports |= {("roverlink.runtime.convert.any_of", name) for name in used}
    imports |= {
        (package, name if name == local else f"{name} as {local}") for (package, name), local in modules.items()
    }
    members = []
    for member, held_conversion in zip(conversion.members, held):
        converter = converter_of(member.ros)
        imports.add((converter.module, converter.name))
        type = f"{modules[_module(own, held_conversion)]}.{held_conversion.local_name}"
        members.append(_Member(type, converter.name, member.field, member.constant))
    return render(
        "any.py.j2",
        header=header(f"{bridge.table} ({conversion.source})"),
        imports=import_lines(imports),
        source=conversion.source,
        ros=f"{bridge.package}/msg/{conversion.ros}",
        name=conversion.ros,
        message=message,
        members=members,
    )


def _module(generated: str, conversion: ir.Conversion) -> Import:
    """Return package and name of the module with a conversion's proto message: ``generated.pb2.arm``, ``joint_pb2``."""
    return spelling.proto_package(generated, conversion.file), spelling.proto_module(conversion.file)


def _local_names(modules: set[Import], generated: str) -> Mapping[Import, str]:
    """Return the local name for each protobuf module in the generated imports: ``joint_pb2``.

    If several modules have the same name, the local names also contain the folders: ``pb2_arm_joint_pb2``.
    """
    names = ["any_pb2", *(name for _, name in modules)]
    return {
        (package, name): (
            name if names.count(name) == 1 else f"{package}.{name}".removeprefix(f"{generated}.").replace(".", "_")
        )
        for package, name in sorted(modules)
    }
