"""The bodies of ``to_ros`` and ``from_ros``, for handlers and for the conversions of nested messages."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from generator import ir
from generator.ir import ConversionKind
from generator.rendering import Files, header, render
from generator.targets.python import layout, spelling
from generator.targets.python.layout import Comprehension, Conditional, Group, Item


@dataclass(frozen=True, slots=True)
class Converter:
    """How code calls the conversion of a nested message."""

    module: str
    name: str
    """What is imported from the module."""


class Converters:
    """Where the conversion of each proto message stands: in its row's handler, or in a module of its own."""

    def __init__(self, bridge: ir.Bridge) -> None:
        self._handlers = {route.conversion.proto: route for route in reversed(bridge.routes)}
        self._conversions = bridge.conversions()

    def of(self, proto: str) -> Converter:
        """The converter of a proto message."""
        route = self._handlers.get(proto)
        if route is not None:
            return Converter(f"generated.handlers.{spelling.module(route.name)}", spelling.handler_class(route))
        return Converter("generated.conversions", spelling.conversion_module(self._conversions[proto].ros))


@dataclass(frozen=True, slots=True)
class ConversionView:
    """A conversion as the templates see it: ready pieces of Python."""

    imports: tuple[str, ...]
    payload: str
    message: str
    to_ros: str
    from_ros: str
    to_ros_signature: str
    from_ros_signature: str


def view(
    conversion: ir.Conversion, converters: Converters, indent: int, extra_imports: tuple[str, ...] = ()
) -> ConversionView:
    """The view of a conversion whose functions stand at a depth of indentation."""
    spell = _Spelling(conversion, converters)
    payload, message = spelling.proto_class(conversion), spelling.message_class(conversion.ros)
    unused = "" if conversion.fields else "_"
    return ConversionView(
        imports=tuple(layout.in_import_order([*spell.imports(), *extra_imports])),
        payload=payload,
        message=message,
        to_ros=layout.statement(Group(f"return {message}(", spell.to_ros_arguments(), ")"), indent + 4),
        from_ros=layout.statement(Group(f"return {payload}(", spell.from_ros_arguments(), ")"), indent + 4),
        to_ros_signature=layout.signature("to_ros", [f"{unused}payload: {payload}"], message, indent),
        from_ros_signature=layout.signature("from_ros", [f"{unused}message: {message}"], payload, indent),
    )


class _Spelling:
    """Spells one conversion."""

    def __init__(self, conversion: ir.Conversion, converters: Converters) -> None:
        self._conversion, self._converters = conversion, converters

    def imports(self) -> Iterator[str]:
        package, module = spelling.proto_module(self._conversion.file)
        yield layout.import_from(package, [module])
        fields = self._conversion.fields
        enums = {field.ros.type.name for field in fields if field.kind is ConversionKind.ENUM_MESSAGE}
        messages = sorted({self._conversion.ros, *enums})
        yield layout.import_from("generated.messages", [spelling.message_class(name) for name in messages])
        nested: dict[str, set[str]] = {}
        for field in fields:
            if field.kind is ConversionKind.MESSAGE:
                converter = self._converters.of(field.proto)
                nested.setdefault(converter.module, set()).add(converter.name)
        yield from (layout.import_from(module, sorted(names)) for module, names in nested.items())

    # --- to ROS ---

    def to_ros_arguments(self) -> list[Item]:
        return [self._to_ros_argument(field) for field in self._conversion.fields]

    def _to_ros_argument(self, field: ir.FieldConversion) -> Item:
        source = ".".join(("payload", *field.proto_path))
        name = field.ros.name
        if field.kind is ConversionKind.PRESENCE:
            holder = ".".join(("payload", *field.proto_path[:-1]))
            return Group(f"{name}={holder}.HasField(", [f'"{field.proto_path[-1]}"'], ")")
        if field.kind is ConversionKind.VALUE:
            container = "bytes" if field.ros.type.name == "uint8" else "list"
            return Group(f"{name}={container}(", [source], ")") if field.repeated else f"{name}={source}"
        head, member = self._to_ros_call(field)
        if field.repeated:
            return Comprehension(f"{name}=[", Group(f"{head}(", [f"{member}item"], ")"), f"for item in {source}", "]")
        return Group(f"{name}={head}(", [f"{member}{source}"], ")")

    def _to_ros_call(self, field: ir.FieldConversion) -> tuple[str, str]:
        if field.kind is ConversionKind.ENUM_MESSAGE:
            return spelling.message_class(field.ros.type.name), f"{field.member}="
        return f"{self._converters.of(field.proto).name}.to_ros", ""

    # --- from ROS ---

    def from_ros_arguments(self) -> list[Item]:
        fields = [field for field in self._conversion.fields if field.kind is not ConversionKind.PRESENCE]
        return list(self._from_ros_items(fields, 0))

    def _from_ros_items(self, fields: Iterable[ir.FieldConversion], depth: int) -> Iterator[Item]:
        """Keyword arguments, and below them the entries of the mappings that stand for messages taken apart."""
        for name, group in itertools.groupby(fields, lambda field: field.proto_path[depth]):
            head = f'"{name}": ' if depth else f"{name}="
            first, *others = group
            if len(first.proto_path) == depth + 1:
                yield self._from_ros_item(head, first)
            else:
                yield Group(f"{head}{{", list(self._from_ros_items([first, *others], depth + 1)), "}")

    def _from_ros_item(self, head: str, field: ir.FieldConversion) -> Item:
        if not field.guarded:
            return self._from_ros_value(head, field)
        return Conditional(head, self._from_ros_value("", field), f"message.has_{field.ros.name}")

    def _from_ros_value(self, head: str, field: ir.FieldConversion) -> Item:
        source = f"message.{field.ros.name}"
        if field.kind is ConversionKind.VALUE:
            return f"{head}{source}"
        if field.kind is ConversionKind.ENUM_MESSAGE:
            if field.repeated:
                return Comprehension(f"{head}[", f"item.{field.member}", f"for item in {source}", "]")
            return f"{head}{source}.{field.member}"
        call = f"{self._converters.of(field.proto).name}.from_ros"
        if field.repeated:
            return Comprehension(f"{head}[", Group(f"{call}(", ["item"], ")"), f"for item in {source}", "]")
        return Group(f"{head}{call}(", [source], ")")


def emit(bridge: ir.Bridge) -> Files:
    """A module a nested message."""
    converters = Converters(bridge)
    for conversion in bridge.nested:
        yield (
            f"generated/conversions/{spelling.conversion_module(conversion.ros)}.py",
            render(
                "conversion.py.j2",
                header=header(f"{bridge.table} and {conversion.file}"),
                docstring=layout.docstring(
                    f"{conversion.local_name} to and from {bridge.package}/msg/{conversion.ros}.", 0
                ),
                conversion=view(conversion, converters, 0),
            ),
        )
    yield (
        "generated/conversions/__init__.py",
        header(bridge.table) + '\n"""Conversions of the messages that stand inside payloads, one module each."""\n',
    )
