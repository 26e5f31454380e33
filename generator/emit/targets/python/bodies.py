"""The bodies of ``to_ros`` and ``from_ros`` of one conversion, and what they import."""

from __future__ import annotations

import itertools
import keyword
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.targets.python import layout, spelling
from roverlink.generator.emit.targets.python.layout import Comparison, Comprehension, Conditional, Group, Item, headed
from roverlink.generator.ir.model import ConversionKind

_SAYS_WHAT_IS_SET = frozenset({ConversionKind.PRESENCE, ConversionKind.WHICH})
_IN_THE_RUNTIME = frozenset({ConversionKind.WELL_KNOWN, ConversionKind.JSON})
_FILES = {
    "google.protobuf.Empty": "google/protobuf/empty.proto",
    "google.protobuf.FieldMask": "google/protobuf/field_mask.proto",
}
_WRAPPERS = "google/protobuf/wrappers.proto"


@dataclass(frozen=True, slots=True)
class Converter:
    """How code calls the conversion of a nested message."""

    module: str
    name: str
    """What is imported from the module."""


def attribute(holder: str, name: str) -> str:
    """An attribute; by `getattr` where its name is a keyword."""
    return f'getattr({holder}, "{name}")' if keyword.iskeyword(name) else f"{holder}.{name}"


def members_constant(which: str) -> str:
    """The name of the mapping from the members of a oneof to their numbers."""
    name = f"_{which.upper()}"
    return f"{name}_" if name == "_CDR" else name


class Bodies:
    """Spells one conversion."""

    def __init__(
        self, conversion: ir.Conversion, converter_of: Callable[[str], Converter], generated: str, place: str
    ) -> None:
        self._conversion, self._converter_of, self._place = conversion, converter_of, place
        self._generated = generated
        self._fields = conversion.fields
        self._imports: dict[str, set[str]] = {}
        self._own_module = spelling.proto_module(conversion.file)
        self._need(spelling.proto_package(generated, conversion.file), self._own_module)
        self._need(f"{self._generated}.messages", spelling.message_class(conversion.ros))

    def imports(self) -> Iterator[tuple[str, str]]:
        """The modules, and what is imported of each, as far as the bodies were spelled."""
        for module, names in self._imports.items():
            yield from ((module, name) for name in names)

    def _need(self, module: str, name: str) -> str:
        self._imports.setdefault(module, set()).add(name)
        return name

    def constants(self, message: str) -> tuple[str, ...]:
        """The members of each oneof."""
        return tuple(
            layout.statement(
                Group(
                    f"{members_constant(field.ros.name)} = {{",
                    [f'"{choice.proto}": {message}.{choice.constant}' for choice in field.choices],
                    "}",
                )
            )
            for field in self._fields
            if field.kind is ConversionKind.WHICH
        )

    # --- to ROS ---

    def to_ros(self, message: str, indent: int) -> str:
        """The statements of ``to_ros``, without the indentation of the first."""
        arguments = [self._to_ros_argument(field) for field in self._fields]
        return layout.statement(Group(f"return {message}(", arguments, ")"), indent)

    def _to_ros_argument(self, field: ir.FieldConversion) -> Item:
        *holders, name = field.proto_path
        holder = "payload"
        for part in holders:
            holder = attribute(holder, part)
        if field.kind in (ConversionKind.PRESENCE, ConversionKind.EMPTY):
            return Group(f"{field.ros.name}={holder}.HasField(", [f'"{name}"'], ")")
        if field.kind is ConversionKind.WHICH:
            arguments = [holder, f'"{name}"', members_constant(field.ros.name)]
            return Group(f"{field.ros.name}={self._need('roverlink.runtime.convert', 'oneof')}.number(", arguments, ")")
        head, source = f"{field.ros.name}=", attribute(holder, name)
        if field.entry is not None:
            return headed(head, self._entries(field.entry, source, field.ros.name))
        if field.repeated:
            return headed(head, self._to_ros_list(field, source))
        value = self._to_ros_value(field, source, field.ros.name)
        if field.kind is not ConversionKind.JSON:
            return headed(head, value)
        return Conditional(head, value, Group(f"{holder}.HasField(", [f'"{name}"'], ")"), '""')

    def _to_ros_list(self, field: ir.FieldConversion, source: str) -> Item:
        if field.kind is ConversionKind.VALUE and field.wrapping is None:
            return Group("bytes(" if field.ros.type.name == "uint8" else "list(", [source], ")")
        return Comprehension("[", self._to_ros_value(field, "item", field.ros.name), f"for item in {source}", "]")

    def _entries(self, entry: ir.MapEntry, source: str, shown: str) -> Item:
        name = self._need(f"{self._generated}.messages", spelling.message_class(entry.ros))
        key, value = (self._to_ros_value(part, part.ros.name, shown) for part in (entry.key, entry.value))
        made = Group(f"{name}(", [headed("key=", key), headed("value=", value)], ")")
        return Comprehension("[", made, Group("for key, value in sorted(", [f"{source}.items()"], ")"), "]")

    def _to_ros_value(self, field: ir.FieldConversion, source: str, shown: str) -> Item:
        """One value, out of its wrapping; ``shown`` is how an error calls it."""
        source = f"{source}.{field.wrapping.field}" if field.wrapping else source
        if field.kind is ConversionKind.HELD:
            name = self._need(f"{self._generated}.messages", spelling.message_class(field.ros.type.name))
            return Group(f"{name}(", [f"{field.member}={source}"], ")")
        if field.kind is ConversionKind.MESSAGE:
            return Group(f"{self._converter(field)}.to_ros(", [source], ")")
        if field.kind in _IN_THE_RUNTIME:
            return Group(f"{self._runtime(field)}.to_ros(", [source, self._shown(shown)], ")")
        is_list = field.wrapping is not None and field.ros.type.is_sequence and not field.repeated
        return Group("list(", [source], ")") if is_list and field.ros.type.name != "uint8" else source

    def _converter(self, field: ir.FieldConversion) -> str:
        converter = self._converter_of(field.converter)
        return self._need(converter.module, converter.name)

    def _runtime(self, field: ir.FieldConversion) -> str:
        return self._need("roverlink.runtime.convert.well_known", field.converter)

    def _shown(self, name: str) -> str:
        """A field's name for an error, as a literal."""
        return f'"{self._place}{name}"'

    # --- from ROS ---

    def from_ros(self, payload: str, indent: int) -> str:
        """The statements of ``from_ros``, without the indentation of the first."""
        fields = [field for field in self._fields if field.kind not in _SAYS_WHAT_IS_SET]
        which = {field.ros.name: field.ros.name for field in self._fields if field.kind is ConversionKind.WHICH}
        arguments = list(self._arguments(fields, which, 0))
        taken = {name for names in self._imports.values() for name in names} | {"message", "oneof"}
        if clashing := {name for name in which if name in taken}:
            which |= {name: f"{name}_" for name in clashing}
            arguments = list(self._arguments(fields, which, 0))
        statements: list[Group] = []
        for name, local in which.items():
            inputs = [f"message.{name}", members_constant(name), self._shown(name)]
            statements.append(
                Group(f"{local} = {self._need('roverlink.runtime.convert', 'oneof')}.member(", inputs, ")")
            )
        statements.append(Group(f"return {payload}(", arguments, ")"))
        return f"\n{' ' * indent}".join(layout.statement(statement, indent) for statement in statements)

    def _arguments(self, fields: Iterable[ir.FieldConversion], which: Mapping[str, str], depth: int) -> Iterator[Item]:
        """Keyword arguments, and below them the entries of the mappings that stand for messages taken apart."""
        by_keyword: list[Item] = []
        for name, group in itertools.groupby(fields, lambda field: field.proto_path[depth]):
            is_entry = depth > 0 or keyword.iskeyword(name)
            head = f'"{name}": ' if is_entry else f"{name}="
            first, *others = group
            if len(first.proto_path) == depth + 1:
                item = headed(head, self._from_ros_argument(first, which))
            else:
                item = Group(f"{head}{{", list(self._arguments([first, *others], which, depth + 1)), "}")
            if is_entry and not depth:
                by_keyword.append(item)
            else:
                yield item
        if by_keyword:
            named = self._need("roverlink.runtime.convert.keywords", "keywords")
            yield Group(f"**{named}(", [Group("{", by_keyword, "}")], ")")

    def _from_ros_argument(self, field: ir.FieldConversion, which: Mapping[str, str]) -> Item:
        source = f"message.{field.ros.name}"
        if field.kind is ConversionKind.EMPTY:
            return Conditional("", f"{self._google('google.protobuf.Empty')}()", source)
        value = self._from_ros_whole(field, source)
        if field.which:
            chosen = Comparison("", which[field.which], f'"{field.proto_path[-1]}"')
            return Conditional("", value, chosen)
        if field.presence:
            return Conditional("", value, f"message.{field.presence}")
        if field.kind is ConversionKind.JSON and not field.repeated and field.entry is None:
            return Conditional("", value, source)
        return value

    def _from_ros_whole(self, field: ir.FieldConversion, source: str) -> Item:
        if field.entry is not None:
            entry = field.entry
            parts = (entry.key, entry.value)
            pair = [self._from_ros_value(part, f"item.{part.ros.name}", field.ros.name) for part in parts]
            pairs = Comprehension("(", Group("(", pair, ")"), f"for item in {source}", ")")
            return Group(
                f"{self._need('roverlink.runtime.convert.maps', 'mapping')}(", [pairs, self._shown(field.ros.name)], ")"
            )
        if not field.repeated:
            return self._from_ros_value(field, source, field.ros.name)
        if field.kind is ConversionKind.VALUE and field.wrapping is None:
            return source
        return Comprehension("[", self._from_ros_value(field, "item", field.ros.name), f"for item in {source}", "]")

    def _from_ros_value(self, field: ir.FieldConversion, source: str, shown: str) -> Item:
        """One value, in its wrapping; ``shown`` is how an error calls it."""
        value: Item = source
        if field.kind is ConversionKind.HELD:
            value = f"{source}.{field.member}"
        elif field.kind is ConversionKind.MESSAGE:
            value = Group(f"{self._converter(field)}.from_ros(", [source], ")")
        elif field.kind in _IN_THE_RUNTIME:
            value = Group(f"{self._runtime(field)}.from_ros(", [source, self._shown(shown)], ")")
        if field.wrapping is None:
            return value
        return Group(f"{self._google(field.wrapping.proto)}(", [headed(f"{field.wrapping.field}=", value)], ")")

    def _google(self, proto: str) -> str:
        """The class of a message of protobuf's library."""
        file = _FILES.get(proto, _WRAPPERS)
        package, module = spelling.proto_package(self._generated, file), spelling.proto_module(file)
        local = f"google_{module}" if module == self._own_module else module
        self._need(package, module if local == module else f"{module} as {local}")
        return f"{local}.{proto.rpartition('.')[2]}"
