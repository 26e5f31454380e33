"""Generated modules with the functions ``to_ros`` and ``from_ros`` for messages inside payloads."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.expressions import Converter, field_expressions
from roverlink.generator.emit.targets.python.imports import Import, import_lines


class Converters:
    """Lookup of the handler class or the generated module that converts a ROS message."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self._generated = bridge.python_package
        self._handlers = {route.conversion.ros: route for route in reversed(bridge.routes) if route.conversion}

    def of(self, ros: str) -> Converter:
        """Return the converter of the ROS message named ``ros``.

        This is a row's handler if the message belongs to a row, otherwise a module in ``generated/conversions``.
        """
        route = self._handlers.get(ros)
        if route is not None:
            return Converter(f"{self._generated}.handlers.{spelling.module(route.name)}", spelling.handler_class(route))
        return Converter(f"{self._generated}.conversions", spelling.conversion_module(ros))


def emit(bridge: ir.Bridge) -> Files:
    """Yield a module for each nested message, and one for each Any."""
    converters = Converters(bridge)
    for conversion in bridge.nested:
        yield (
            f"generated/conversions/{spelling.conversion_module(conversion.ros)}.py",
            _module(bridge, conversion, converters),
        )
    for any in bridge.anys:
        yield f"generated/conversions/{spelling.conversion_module(any.ros)}.py", any_module(bridge, any, converters.of)
    docstring = "Conversions of nested messages: one module for each message."
    yield "generated/conversions/__init__.py", f'{header(bridge.table)}\n"""{docstring}"""\n'


def _module(bridge: ir.Bridge, conversion: ir.Conversion, converters: Converters) -> str:
    fields = field_expressions(conversion, converters.of, bridge.python_package, f"{conversion.ros}.")
    return render(
        "conversion.py.j2",
        header=header(f"{bridge.table} and {conversion.file}"),
        imports=import_lines(fields.imports),
        proto=conversion.local_name,
        ros=f"{bridge.package}/msg/{conversion.ros}",
        payload=spelling.proto_class(conversion),
        message=spelling.message_class(conversion.ros),
        fields=fields,
    )


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
    modules = _local_names({_imported_module(own, held_conversion) for held_conversion in held}, own)
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
        type = f"{modules[_imported_module(own, held_conversion)]}.{held_conversion.local_name}"
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


def _imported_module(generated: str, conversion: ir.Conversion) -> Import:
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
