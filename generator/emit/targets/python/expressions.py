"""Python expressions that convert the fields of one message, and the imports that they need."""

from __future__ import annotations

import itertools
import keyword
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.targets.python import spelling
from roverlink.generator.emit.targets.python.imports import Import
from roverlink.generator.ir.model import ConversionKind

_READ_FOR_OTHER_FIELDS = frozenset({ConversionKind.PRESENCE, ConversionKind.WHICH})
"""Kinds of ROS fields without a proto field: they only tell ``from_ros`` which of the other fields are set."""
_CONVERTED_BY_RUNTIME = frozenset({ConversionKind.WELL_KNOWN, ConversionKind.JSON})
_FILES = {
    "google.protobuf.Empty": "google/protobuf/empty.proto",
    "google.protobuf.FieldMask": "google/protobuf/field_mask.proto",
}
_WRAPPERS = "google/protobuf/wrappers.proto"


@dataclass(frozen=True, slots=True)
class Converter:
    """Generated module or class that converts a nested message; generated code calls ``name.to_ros(...)``."""

    module: str
    """Module or package from which ``name`` is imported."""
    name: str
    """Name of the converting class or module: ``bounding_box``."""


@dataclass(frozen=True, slots=True)
class Argument:
    """Keyword argument of a call in generated code: ``rpm=payload.rpm``."""

    name: str
    value: str
    """Python expression."""


@dataclass(frozen=True, slots=True)
class Oneof:
    """Oneof of the payload, and the ROS field that holds the number of the oneof's member that is set."""

    field: str
    """Name of the ROS field: ``command``."""
    constant: str
    """Name of the generated dict from the names of the members to their numbers: ``COMMAND_MEMBERS``."""
    local: str
    """Local variable in ``from_ros`` for the name of the member that is set."""
    shown: str
    """Name of the ROS field in error messages, as a Python literal: ``"Arm.command"`` with the quotes."""
    members: tuple[ir.Choice, ...]


@dataclass(frozen=True, slots=True)
class FieldExpressions:
    """Python source for the fields of one conversion, for the functions ``to_ros`` and ``from_ros``."""

    to_ros: tuple[Argument, ...]
    """Arguments with which ``to_ros`` constructs the ROS message."""
    from_ros: tuple[Argument, ...]
    """Arguments with which ``from_ros`` constructs the payload."""
    from_ros_keywords: tuple[Argument, ...]
    """Further arguments of ``from_ros`` whose names are Python keywords, such as ``from``."""
    oneofs: tuple[Oneof, ...]
    imports: tuple[Import, ...]


def attribute(holder: str, name: str) -> str:
    """Return the expression for an attribute: ``payload.x``, or ``getattr(payload, "from")`` for a Python keyword."""
    return f'getattr({holder}, "{name}")' if keyword.iskeyword(name) else f"{holder}.{name}"


def oneof_constant(field: str) -> str:
    """Return the name of the generated dict from a oneof's members to their numbers: ``COMMAND_MEMBERS``.

    ``field`` is the ROS field that holds the number: ``command``.
    """
    return f"{field.upper()}_MEMBERS"


def field_expressions(
    conversion: ir.Conversion, converter_of: Callable[[str], Converter], generated: str, place: str
) -> FieldExpressions:
    """Return the Python source for the fields of a conversion.

    ``converter_of`` returns the converter of a nested ROS message by its name. ``generated`` is the import name of the
    generated package. ``place`` is the text before a field's name in error messages: ``BoundingBox.``.
    """
    speller = _Speller(conversion, converter_of, generated, place)
    to_ros = tuple(Argument(field.ros.name, speller.to_ros(field)) for field in conversion.fields)
    oneofs = tuple(speller.oneofs())
    arguments = speller.from_ros({oneof.field: oneof.local for oneof in oneofs})
    return FieldExpressions(
        to_ros=to_ros,
        from_ros=tuple(argument for argument in arguments if not keyword.iskeyword(argument.name)),
        from_ros_keywords=speller.by_keyword(arguments),
        oneofs=oneofs,
        imports=tuple(speller.imports),
    )


class _Speller:
    """Writer of the Python expressions of one conversion. It collects the imports that the expressions need."""

    def __init__(
        self, conversion: ir.Conversion, converter_of: Callable[[str], Converter], generated: str, place: str
    ) -> None:
        self._fields, self._converter_of, self._place = conversion.fields, converter_of, place
        self._generated = generated
        self._own_module = spelling.proto_module(conversion.file)
        self.imports: dict[Import, None] = {}  # a set in the order of insertion
        self._need(spelling.proto_package(generated, conversion.file), self._own_module)
        self._need(f"{generated}.messages", spelling.message_class(conversion.ros))

    def _need(self, module: str, name: str) -> str:
        self.imports[module, name] = None
        return name

    def oneofs(self) -> Iterator[Oneof]:
        """Yield the oneofs of the payload, each with a local variable whose name hides no imported name."""
        found = [field for field in self._fields if field.kind is ConversionKind.WHICH]
        if found:
            self._need("roverlink.runtime.convert", "oneof")
        self.from_ros({field.ros.name: field.ros.name for field in found})  # collects the imports
        taken = {name for _, name in self.imports} | {"message", "oneof"}
        for field in found:
            name = field.ros.name
            local = f"{name}_" if name in taken else name
            yield Oneof(name, oneof_constant(name), local, self._shown(name), field.choices)

    # --- to ROS ---

    def to_ros(self, field: ir.FieldConversion) -> str:
        """Return the expression in ``to_ros`` for the value of a ROS field: ``payload.rpm``."""
        *holders, name = field.proto_path
        holder = "payload"
        for part in holders:
            holder = attribute(holder, part)
        if field.kind in (ConversionKind.PRESENCE, ConversionKind.EMPTY):
            return f'{holder}.HasField("{name}")'
        if field.kind is ConversionKind.WHICH:
            return f'oneof.number({holder}, "{name}", {oneof_constant(field.ros.name)})'
        source = attribute(holder, name)
        if field.entry is not None:
            return self._entries(field.entry, source, field.ros.name)
        if field.repeated:
            return self._to_ros_list(field, source)
        value = self._to_ros_value(field, source, field.ros.name)
        return f'{value} if {holder}.HasField("{name}") else ""' if field.kind is ConversionKind.JSON else value

    def _to_ros_list(self, field: ir.FieldConversion, source: str) -> str:
        if field.kind is ConversionKind.VALUE and field.wrapping is None:
            return f"{'bytes' if field.ros.type.name == 'uint8' else 'list'}({source})"
        return f"[{self._to_ros_value(field, 'item', field.ros.name)} for item in {source}]"

    def _entries(self, entry: ir.MapEntry, source: str, shown: str) -> str:
        name = self._need(f"{self._generated}.messages", spelling.message_class(entry.ros))
        key, value = (self._to_ros_value(part, part.ros.name, shown) for part in (entry.key, entry.value))
        return f"[{name}(key={key}, value={value}) for key, value in sorted({source}.items())]"

    def _to_ros_value(self, field: ir.FieldConversion, source: str, shown: str) -> str:
        """Return the expression for one ROS value: a field's value, or one value of a list or map.

        ``source`` is the expression for the proto value. If a message such as google.protobuf.FloatValue wraps the
        value, the result takes it out of the wrapper. ``shown`` is the field's name in error messages.
        """
        source = f"{source}.{field.wrapping.field}" if field.wrapping else source
        if field.kind is ConversionKind.HELD:
            name = self._need(f"{self._generated}.messages", spelling.message_class(field.ros.type.name))
            return f"{name}({field.member}={source})"
        if field.kind is ConversionKind.MESSAGE:
            return f"{self._converter(field)}.to_ros({source})"
        if field.kind in _CONVERTED_BY_RUNTIME:
            return f"{self._runtime(field)}.to_ros({source}, {self._shown(shown)})"
        is_list = field.wrapping is not None and field.ros.type.is_sequence and not field.repeated
        return f"list({source})" if is_list and field.ros.type.name != "uint8" else source

    def _converter(self, field: ir.FieldConversion) -> str:
        converter = self._converter_of(field.converter)
        return self._need(converter.module, converter.name)

    def _runtime(self, field: ir.FieldConversion) -> str:
        return self._need("roverlink.runtime.convert.well_known", field.converter)

    def _shown(self, name: str) -> str:
        return f'"{self._place}{name}"'

    # --- from ROS ---

    def from_ros(self, locals: Mapping[str, str]) -> list[Argument]:
        """Return the arguments with which ``from_ros`` constructs the payload.

        ``locals`` maps the ROS field of each oneof to the local variable with the name of the member that is set.
        """
        fields = [field for field in self._fields if field.kind not in _READ_FOR_OTHER_FIELDS]
        return [Argument(name, value) for name, value in self._from_ros_fields(fields, locals, 0)]

    def by_keyword(self, arguments: Iterable[Argument]) -> tuple[Argument, ...]:
        """Return the arguments whose names are Python keywords; Python accepts such names only in ``**mapping``."""
        found = tuple(argument for argument in arguments if keyword.iskeyword(argument.name))
        if found:
            self._need("roverlink.runtime.convert.keywords", "keywords")
        return found

    def _from_ros_fields(
        self, fields: Iterable[ir.FieldConversion], locals: Mapping[str, str], depth: int
    ) -> Iterator[tuple[str, str]]:
        """Yield the name and the expression of each payload field at ``depth`` of the proto paths.

        A nested proto message whose fields stand directly in the ROS message becomes a dict: ``{"x": message.x}``.
        """
        for name, group in itertools.groupby(fields, lambda field: field.proto_path[depth]):
            first, *others = group
            if len(first.proto_path) == depth + 1:
                yield name, self._from_ros_field(first, locals)
            else:
                yield name, mapping(self._from_ros_fields([first, *others], locals, depth + 1))

    def _from_ros_field(self, field: ir.FieldConversion, locals: Mapping[str, str]) -> str:
        source = f"message.{field.ros.name}"
        if field.kind is ConversionKind.EMPTY:
            return f"{self._google('google.protobuf.Empty')}() if {source} else None"
        value = self._from_ros_whole(field, source)
        if field.which:
            return f'{value} if {locals[field.which]} == "{field.proto_path[-1]}" else None'
        if field.presence:
            return f"{value} if message.{field.presence} else None"
        if field.kind is ConversionKind.JSON and not field.repeated and field.entry is None:
            return f"{value} if {source} else None"
        return value

    def _from_ros_whole(self, field: ir.FieldConversion, source: str) -> str:
        if field.entry is not None:
            key, value = (
                self._from_ros_value(part, f"item.{part.ros.name}", field.ros.name)
                for part in (field.entry.key, field.entry.value)
            )
            function = self._need("roverlink.runtime.convert.maps", "mapping")
            return f"{function}((({key}, {value}) for item in {source}), {self._shown(field.ros.name)})"
        if not field.repeated:
            return self._from_ros_value(field, source, field.ros.name)
        if field.kind is ConversionKind.VALUE and field.wrapping is None:
            return source
        return f"[{self._from_ros_value(field, 'item', field.ros.name)} for item in {source}]"

    def _from_ros_value(self, field: ir.FieldConversion, source: str, shown: str) -> str:
        """Return the expression for one proto value: a field's value, or one value of a list or map.

        ``source`` is the expression for the ROS value. If the proto field is a wrapper message such as
        google.protobuf.FloatValue, the result is that message. ``shown`` is the field's name in error messages.
        """
        value = source
        if field.kind is ConversionKind.HELD:
            value = f"{source}.{field.member}"
        elif field.kind is ConversionKind.MESSAGE:
            value = f"{self._converter(field)}.from_ros({source})"
        elif field.kind in _CONVERTED_BY_RUNTIME:
            value = f"{self._runtime(field)}.from_ros({source}, {self._shown(shown)})"
        wrapping = field.wrapping
        return value if wrapping is None else f"{self._google(wrapping.proto)}({wrapping.field}={value})"

    def _google(self, proto: str) -> str:
        """Return the expression for the class of a message in protobuf's library: ``wrappers_pb2.FloatValue``."""
        file = _FILES.get(proto, _WRAPPERS)
        package, module = spelling.proto_package(self._generated, file), spelling.proto_module(file)
        local = f"google_{module}" if module == self._own_module else module
        self._need(package, module if local == module else f"{module} as {local}")
        return f"{local}.{proto.rpartition('.')[2]}"


def mapping(entries: Iterable[tuple[str, str]]) -> str:
    """Return the Python source of a dict from names and expressions: ``{"x": message.x}``."""
    return "{" + ", ".join(f'"{name}": {value}' for name, value in entries) + "}"
