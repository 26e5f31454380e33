"""The bodies of ``to_ros`` and ``from_ros`` of one conversion, and the headers that they need."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roverlink.generator import ir
from roverlink.generator.emit.targets.cpp import cpp_names, layout
from roverlink.generator.emit.targets.cpp.conversion_context import Context
from roverlink.generator.ir.model import ConversionKind
from roverlink.generator.resolve.well_known import FIELD_MASK

_SAYS_WHAT_IS_SET = frozenset({ConversionKind.PRESENCE, ConversionKind.WHICH})
_BY_THE_RUNTIME = {ConversionKind.WELL_KNOWN: "well_known", ConversionKind.JSON: "json"}


class Bodies:
    """Spells one conversion."""

    def __init__(self, conversion: ir.Conversion, context: Context) -> None:
        self._conversion, self._context = conversion, context
        self._message = context.struct(conversion.ros)
        self._holders: Mapping[tuple[str, ...], str] = {}
        self.headers = {cpp_names.runtime_header("values")}
        """What the bodies need, as far as they were spelled."""

    def _shown(self, name: str) -> str:
        """A field's name for an error, as a literal."""
        return f'"{self._conversion.ros}.{name}"'

    def _converter(self, ros: str) -> str:
        converter = self._context.converter_of(ros)
        self.headers.add(converter.header)
        return converter.name

    def _by_the_runtime(self, field: ir.FieldConversion, direction: str, source: str, shown: str) -> str:
        self.headers.add(cpp_names.runtime_header(_BY_THE_RUNTIME[field.kind]))
        return f"roverlink::{field.converter}_{direction}({source}, {self._shown(shown)})"

    def _is_field_mask(self, field: ir.FieldConversion) -> bool:
        if field.wrapping is None or field.wrapping.proto != FIELD_MASK:
            return False
        self.headers.add(cpp_names.runtime_header("well_known"))
        return True

    # --- to ROS ---

    def to_ros(self) -> Iterator[str]:
        """The statements of ``to_ros``, which make ``message`` from ``payload``."""
        yield f"{self._message} message;"
        for one in self._conversion.fields:
            yield from self._field_to_ros(one)
        yield "return message;"

    def _field_to_ros(self, field: ir.FieldConversion) -> Iterator[str]:
        *holders, name = field.proto_path
        holder, target = cpp_names.getter(tuple(holders)), f"message.{field.ros.name}"
        source = f"{holder}.{cpp_names.accessor(name)}()"
        if field.kind in (ConversionKind.PRESENCE, ConversionKind.EMPTY):
            yield f"{target} = {holder}.has_{cpp_names.accessor(name)}();"
        elif field.kind is ConversionKind.WHICH:
            yield from self._which_to_ros(field, holder)
        elif field.entry is not None:
            yield from self._entries_to_ros(field, field.entry, source)
        elif field.repeated:
            yield from self._list_to_ros(field, source)
        elif field.kind is ConversionKind.JSON:
            stored = self._stored(target, field, source, field.ros.name)
            yield from layout.block(f"if ({holder}.has_{cpp_names.accessor(name)}())", [stored])
        else:
            yield self._stored(target, field, source, field.ros.name)

    def _which_to_ros(self, field: ir.FieldConversion, holder: str) -> Iterator[str]:
        for index, choice in enumerate(field.choices):
            yield f"{'} else ' if index else ''}if ({holder}.has_{cpp_names.accessor(choice.proto)}()) {{"
            yield f"  message.{field.ros.name} = {self._message}::{choice.constant};"
        yield "}"

    def _list_to_ros(self, field: ir.FieldConversion, source: str) -> Iterator[str]:
        target = f"message.{field.ros.name}"
        if _is_copied(field):
            yield f"{target}.assign({source}.begin(), {source}.end());"
            return
        if field.kind is ConversionKind.HELD:
            stored = self._stored(f"{target}.emplace_back()", field, "item", field.ros.name)
        else:
            stored = f"{target}.push_back({self._value_to_ros(field, 'item', field.ros.name)});"
        yield from layout.block(f"for (const auto & item : {source})", [stored])

    def _entries_to_ros(self, field: ir.FieldConversion, entry: ir.MapEntry, source: str) -> Iterator[str]:
        stored = [
            self._stored(f"entry.{part.ros.name}", part, f"item->{place}", field.ros.name)
            for part, place in ((entry.key, "first"), (entry.value, "second"))
        ]
        new = f"auto & entry = message.{field.ros.name}.emplace_back();"
        yield from layout.block(f"for (const auto * item : roverlink::sorted({source}))", [new, *stored])

    def _stored(self, target: str, field: ir.FieldConversion, source: str, shown: str) -> str:
        """The statement that puts one value where it belongs; ``shown`` is how an error calls it."""
        held = f".{field.member}" if field.kind is ConversionKind.HELD else ""
        return f"{target}{held} = {self._value_to_ros(field, source, shown)};"

    def _value_to_ros(self, field: ir.FieldConversion, source: str, shown: str) -> str:
        """One value, out of its wrapping; of ``HELD`` without the message that holds it."""
        if self._is_field_mask(field):
            return f"roverlink::field_mask_to_ros({source}, {self._shown(shown)})"
        if field.wrapping:
            source = f"{source}.{cpp_names.accessor(field.wrapping.field)}()"
        if field.kind is ConversionKind.MESSAGE:
            return f"{self._converter(field.converter)}::to_ros({source})"
        if field.kind in _BY_THE_RUNTIME:
            return self._by_the_runtime(field, "to_ros", source, shown)
        ros = self._ros_of_value(field)
        if ros.enum:
            return f"roverlink::narrow<{cpp_names.primitive(ros.type.name)}>({source}, {self._shown(shown)})"
        if ros.type.name == "string":
            return f"roverlink::text({source}, {self._shown(shown)})"
        return f"roverlink::octets({source})" if _is_bytes(field, ros) else source

    def _ros_of_value(self, field: ir.FieldConversion) -> ir.RosField:
        """The ROS field that has the bare value."""
        if field.kind is ConversionKind.HELD:
            return self._context.ros_field(field.ros.type.name, field.member)
        return field.ros

    # --- from ROS ---

    def from_ros(self) -> Iterator[str]:
        """The statements of ``from_ros``, which make ``payload`` from ``message``."""
        yield f"{cpp_names.proto_class(self._conversion.proto)} payload;"
        self._holders = {(): "payload"}
        told: set[str] = set()
        for field in self._conversion.fields:
            if field.kind in _SAYS_WHAT_IS_SET or field.which in told:
                continue
            yield from self._hold(field.proto_path[:-1])
            if field.which:
                told.add(field.which)
                yield from self._which_from_ros(field.which)
            else:
                yield from self._field_from_ros(field)
        yield "return payload;"

    def _hold(self, path: tuple[str, ...]) -> Iterator[str]:
        """Names for the messages that a path leads through, which are set thereby, too."""
        for depth in range(1, len(path) + 1):
            part = path[:depth]
            if part not in self._holders:
                name = f"{'_'.join(part)}_payload"
                while name in self._holders.values():
                    name += "_"
                yield f"auto & {name} = *{self._holders[path[: depth - 1]]}.mutable_{cpp_names.accessor(part[-1])}();"
                self._holders = {**self._holders, part: name}

    def _which_from_ros(self, which: str) -> Iterator[str]:
        members = {field.proto_path[-1]: field for field in self._conversion.fields if field.which == which}
        said = next(field for field in self._conversion.fields if field.ros.name == which)
        yield f"switch (message.{which}) {{"
        yield from ("  case 0:", "    break;")
        for choice in said.choices:
            yield f"  case {self._message}::{choice.constant}:"
            yield from layout.indented(self._set(members[choice.proto]), 2)
            yield "    break;"
        yield "  default:"
        yield f"    throw roverlink::no_member(message.{which}, {self._shown(which)});"
        yield "}"

    def _field_from_ros(self, field: ir.FieldConversion) -> Iterator[str]:
        source = f"message.{field.ros.name}"
        statements = list(self._set(field))
        if field.kind is ConversionKind.EMPTY:
            yield from layout.block(f"if ({source})", statements)
        elif field.presence:
            yield from layout.block(f"if (message.{field.presence})", statements)
        elif field.kind is ConversionKind.JSON and not field.repeated and field.entry is None:
            yield from layout.block(f"if (!{source}.empty())", statements)
        else:
            yield from statements

    def _set(self, field: ir.FieldConversion) -> Iterator[str]:
        """The statements that set a field, whatever says whether it is set."""
        holder, name = self._holders[field.proto_path[:-1]], cpp_names.accessor(field.proto_path[-1])
        source = f"message.{field.ros.name}"
        if field.kind is ConversionKind.EMPTY:
            yield f"{holder}.mutable_{name}();"
        elif field.entry is not None:
            yield from self._entries_from_ros(field, field.entry, f"*{holder}.mutable_{name}()")
        elif not field.repeated:
            yield self._put(field, holder, name, source)
        elif _is_copied(field):
            yield f"{holder}.mutable_{name}()->Add({source}.begin(), {source}.end());"
        else:
            yield from layout.block(f"for (const auto & item : {source})", [self._put(field, holder, name, "item")])

    def _put(self, field: ir.FieldConversion, holder: str, name: str, source: str) -> str:
        """The statement that sets a field, or adds to it, one value."""
        value, reached = self._value_from_ros(field, source, field.ros.name), "add" if field.repeated else "mutable"
        if field.wrapping and not self._is_field_mask(field):
            return f"{holder}.{reached}_{name}()->set_{cpp_names.accessor(field.wrapping.field)}({value});"
        if field.kind is ConversionKind.MESSAGE or field.kind in _BY_THE_RUNTIME or self._is_field_mask(field):
            return f"*{holder}.{reached}_{name}() = {value};"
        return f"{holder}.{'add' if field.repeated else 'set'}_{name}({value});"

    def _entries_from_ros(self, field: ir.FieldConversion, entry: ir.MapEntry, target: str) -> Iterator[str]:
        key = self._value_from_ros(entry.key, f"item.{entry.key.ros.name}", field.ros.name)
        value = self._value_from_ros(entry.value, f"item.{entry.value.ros.name}", field.ros.name)
        new = f"auto & value = roverlink::added({target}, {key}, {self._shown(field.ros.name)});"
        if entry.value.wrapping and not self._is_field_mask(entry.value):
            stored = f"value.set_{cpp_names.accessor(entry.value.wrapping.field)}({value});"
        else:
            stored = f"value = {value};"
        yield from layout.block(f"for (const auto & item : message.{field.ros.name})", [new, stored])

    def _value_from_ros(self, field: ir.FieldConversion, source: str, shown: str) -> str:
        """One value, without its wrapping; ``shown`` is how an error calls it."""
        if self._is_field_mask(field):
            return f"roverlink::field_mask_from_ros({source}, {self._shown(shown)})"
        if field.kind is ConversionKind.MESSAGE:
            return f"{self._converter(field.converter)}::from_ros({source})"
        if field.kind in _BY_THE_RUNTIME:
            return self._by_the_runtime(field, "from_ros", source, shown)
        if field.kind is ConversionKind.HELD:
            source = f"{source}.{field.member}"
        ros = self._ros_of_value(field)
        if ros.enum:
            return f"roverlink::Enumerator({source}, {self._shown(shown)})"
        if ros.type.name == "string":
            return f"roverlink::text({source}, {self._shown(shown)})"
        return f"roverlink::bytes({source})" if _is_bytes(field, ros) else source


def _is_copied(field: ir.FieldConversion) -> bool:
    """Whether a list is the same on both sides, element by element."""
    return field.kind is ConversionKind.VALUE and not (
        field.wrapping or field.ros.enum or field.ros.type.name == "string"
    )


def _is_bytes(field: ir.FieldConversion, ros: ir.RosField) -> bool:
    """Whether the bare value is bytes."""
    return ros.type.name == "uint8" and ros.type.is_sequence and (not field.repeated or ros is not field.ros)
