"""The bodies of ``to_ros`` and ``from_ros``, for handlers and for the conversions of nested messages."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from generator import ir
from generator.ir import ConversionKind
from generator.targets import layout, spelling
from generator.targets.layout import Comprehension, Group
from generator.targets.rendering import header, render

Files = Iterator[tuple[str, str]]


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
        return Converter("generated.conversions", spelling.message_module(self._conversions[proto].ros))


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
    payload, message = spelling.proto_class(conversion), conversion.ros
    body = indent + 4
    return ConversionView(
        imports=tuple(sorted({*spell.imports(), *extra_imports}, key=_import_order)),
        payload=payload,
        message=message,
        to_ros=layout.statement(Group(f"return {message}(", spell.to_ros_arguments(), ")"), body),
        from_ros=spell.from_ros_body(payload, body),
        to_ros_signature=layout.statement(Group("def to_ros(", [f"payload: {payload}"], f") -> {message}:"), indent),
        from_ros_signature=layout.statement(
            Group("def from_ros(", [f"message: {message}"], f") -> {payload}:"), indent
        ),
    )


def _import_order(line: str) -> str:
    return line.removeprefix("from ")


class _Spelling:
    """Spells one conversion."""

    def __init__(self, conversion: ir.Conversion, converters: Converters) -> None:
        self._conversion, self._converters = conversion, converters

    def imports(self) -> Iterator[str]:
        package, module = spelling.proto_module(self._conversion.file)
        yield layout.import_from(package, [module])
        fields = self._conversion.fields
        enums = {field.ros.type.name for field in fields if field.kind is ConversionKind.ENUM_MESSAGE}
        yield layout.import_from("generated.messages", [self._conversion.ros, *(enums - {self._conversion.ros})])
        nested: dict[str, set[str]] = {}
        for field in fields:
            if field.kind is ConversionKind.MESSAGE:
                converter = self._converters.of(field.proto)
                nested.setdefault(converter.module, set()).add(converter.name)
        yield from (layout.import_from(module, sorted(names)) for module, names in nested.items())

    # --- to ROS ---

    def to_ros_arguments(self) -> list[str | Group | Comprehension]:
        return [self._to_ros_argument(field) for field in self._conversion.fields]

    def _to_ros_argument(self, field: ir.FieldConversion) -> str | Group | Comprehension:
        source = ".".join(("payload", *field.proto_path))
        name = field.ros.name
        if field.kind is ConversionKind.PRESENCE:
            return f"{name}={presence(field, 'payload')}"
        if field.kind is ConversionKind.VALUE:
            container = "bytes" if field.ros.type.name == "uint8" else "list"
            return f"{name}={container}({source})" if field.repeated else f"{name}={source}"
        head, member = self._to_ros_call(field)
        if field.repeated:
            return Comprehension(f"{name}=[", f"{head}({member}item)", f"for item in {source}", "]")
        return Group(f"{name}={head}(", [f"{member}{source}"], ")")

    def _to_ros_call(self, field: ir.FieldConversion) -> tuple[str, str]:
        if field.kind is ConversionKind.ENUM_MESSAGE:
            return field.ros.type.name, f"{field.member}="
        return f"{self._converters.of(field.proto).name}.to_ros", ""

    # --- from ROS ---

    def from_ros_body(self, payload: str, indent: int) -> str:
        plain = [field for field in self._conversion.fields if len(field.proto_path) == 1 and not field.guarded]
        arguments = [self._from_ros_argument(field) for field in plain if field.kind is not ConversionKind.PRESENCE]
        later = [field for field in self._conversion.fields if len(field.proto_path) > 1 or field.guarded]
        statements = [s for field in later for s in self._assignment(field, indent)]
        if not statements:
            return layout.statement(Group(f"return {payload}(", arguments, ")"), indent)
        margin = "\n" + " " * indent
        first = layout.statement(Group(f"payload = {payload}(", arguments, ")"), indent)
        return margin.join([first, *statements, "return payload"])

    def _from_ros_argument(self, field: ir.FieldConversion) -> str | Group | Comprehension:
        return self._from_ros_value(f"{field.proto_path[-1]}=", field)

    def _from_ros_value(self, head: str, field: ir.FieldConversion, tail: str = "") -> str | Group | Comprehension:
        source = f"message.{field.ros.name}"
        if field.kind is ConversionKind.VALUE:
            return f"{head}{source}{tail}"
        if field.kind is ConversionKind.ENUM_MESSAGE:
            if field.repeated:
                return Comprehension(f"{head}[", f"item.{field.member}", f"for item in {source}", f"]{tail}")
            return f"{head}{source}.{field.member}{tail}"
        call = f"{self._converters.of(field.proto).name}.from_ros"
        if field.repeated:
            return Comprehension(f"{head}[", f"{call}(item)", f"for item in {source}", f"]{tail}")
        return Group(f"{head}{call}(", [source], f"){tail}")

    def _assignment(self, field: ir.FieldConversion, indent: int) -> Iterator[str]:
        """Statements for a field that the payload's constructor cannot take."""
        if field.kind is ConversionKind.PRESENCE:
            return
        margin = 0
        if field.guarded:
            yield f"if message.has_{field.ros.name}:"
            margin = 4
        target = ".".join(("payload", *field.proto_path))
        if field.repeated:
            value = self._from_ros_value(f"{target}.extend(", field, ")")
        elif field.kind is ConversionKind.MESSAGE:
            value = self._from_ros_value(f"{target}.CopyFrom(", field, ")")
        else:
            value = self._from_ros_value(f"{target} = ", field)
        text = value if isinstance(value, str) else layout.statement(value, indent + margin)
        yield " " * margin + text


def presence(field: ir.FieldConversion, payload: str) -> str:
    """The expression that says whether a field is set."""
    *holders, name = field.proto_path
    return f'{".".join([payload, *holders])}.HasField("{name}")'


def emit(bridge: ir.Bridge) -> Files:
    """A module a nested message."""
    converters = Converters(bridge)
    for conversion in bridge.nested:
        yield (
            f"generated/conversions/{spelling.message_module(conversion.ros)}.py",
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
