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
"""ROS fields that ``from_ros`` reads only to decide about other fields."""
_CONVERTED_BY_RUNTIME = frozenset({ConversionKind.WELL_KNOWN, ConversionKind.JSON})
_FILES = {
    "google.protobuf.Empty": "google/protobuf/empty.proto",
    "google.protobuf.FieldMask": "google/protobuf/field_mask.proto",
}
_WRAPPERS = "google/protobuf/wrappers.proto"


@dataclass(frozen=True, slots=True)
class Converter:
    """Module or class that converts a nested message; code calls ``name.to_ros(...)``."""

    module: str
    name: str
    """Class or module to import from ``module``."""


@dataclass(frozen=True, slots=True)
class Argument:
    """Keyword argument of a call."""

    name: str
    value: str
    """Python expression."""


@dataclass(frozen=True, slots=True)
class Oneof:
    """Oneof of the payload. A field of the ROS message has the number of its member."""

    field: str
    """ROS field."""
    constant: str
    """Name of the mapping from the oneof's members to their numbers."""
    local: str
    """Local variable in ``from_ros`` for the name of the chosen member."""
    shown: str
    """ROS field's name in error messages, as a literal."""
    members: tuple[ir.Choice, ...]


@dataclass(frozen=True, slots=True)
class FieldExpressions:
    """Fields of a conversion, in both directions."""

    to_ros: tuple[Argument, ...]
    """Arguments of the ROS message's class."""
    from_ros: tuple[Argument, ...]
    """Arguments of the payload's class."""
    from_ros_keywords: tuple[Argument, ...]
    """Arguments of the payload's class whose names are Python keywords."""
    oneofs: tuple[Oneof, ...]
    imports: tuple[Import, ...]


def attribute(holder: str, name: str) -> str:
    """Spell an attribute; use `getattr` if its name is a keyword."""
    return f'getattr({holder}, "{name}")' if keyword.iskeyword(name) else f"{holder}.{name}"


def oneof_constant(field: str) -> str:
    """Return the name of the mapping from the members of a oneof to their numbers."""
    return f"{field.upper()}_MEMBERS"


def field_expressions(
    conversion: ir.Conversion, converter_of: Callable[[str], Converter], generated: str, place: str
) -> FieldExpressions:
    """Spell a conversion; ``place`` precedes the names of fields in error messages."""
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
    """Speller of one conversion's values. It collects the imports that they need."""

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
        """Yield the oneofs, each with a local variable that does not hide an imported name."""
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
        """Spell the value of a ROS field."""
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
        """Spell one value without its wrapper; ``shown`` is its name in error messages."""
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
        """Spell the arguments of the payload's class; ``locals`` are the variables of the oneofs' ROS fields."""
        fields = [field for field in self._fields if field.kind not in _READ_FOR_OTHER_FIELDS]
        return [Argument(name, value) for name, value in self._from_ros_fields(fields, locals, 0)]

    def by_keyword(self, arguments: Iterable[Argument]) -> tuple[Argument, ...]:
        """Return the arguments whose names are keywords; Python accepts them only as ``**mapping``."""
        found = tuple(argument for argument in arguments if keyword.iskeyword(argument.name))
        if found:
            self._need("roverlink.runtime.convert.keywords", "keywords")
        return found

    def _from_ros_fields(
        self, fields: Iterable[ir.FieldConversion], locals: Mapping[str, str], depth: int
    ) -> Iterator[tuple[str, str]]:
        """Spell fields of the payload.

        Fields of a nested message that the ROS message contains directly become one dict.
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
        """Spell one value with its wrapper; ``shown`` is its name in error messages."""
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
        """Spell the class of a message in protobuf's library."""
        file = _FILES.get(proto, _WRAPPERS)
        package, module = spelling.proto_package(self._generated, file), spelling.proto_module(file)
        local = f"google_{module}" if module == self._own_module else module
        self._need(package, module if local == module else f"{module} as {local}")
        return f"{local}.{proto.rpartition('.')[2]}"


def mapping(entries: Iterable[tuple[str, str]]) -> str:
    """Return the Python source of a dict literal whose keys are the given names, as strings."""
    return "{" + ", ".join(f'"{name}": {value}' for name, value in entries) + "}"
