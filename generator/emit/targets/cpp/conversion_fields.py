"""Fields of a conversion, as the template ``templates/cpp/fields.j2`` reads them."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit.targets.cpp import cpp_names
from roverlink.generator.emit.targets.cpp.conversion_context import Context
from roverlink.generator.emit.targets.cpp.literals import comment_lines
from roverlink.generator.ir.model import ConversionKind
from roverlink.generator.resolve.well_known import FIELD_MASK

_RUNTIME_HEADERS = {ConversionKind.WELL_KNOWN: "well_known", ConversionKind.JSON: "json"}


@dataclass(frozen=True, slots=True)
class Value:
    """Value on both sides: of a field, of each item of a list, or the key or value of a map's entry."""

    field: ir.FieldConversion
    shown: str
    """Name of the field in error messages, as a C++ literal."""
    context: Context

    @property
    def name(self) -> str:
        """Name of the ROS field."""
        return self.field.ros.name

    @property
    def member(self) -> str:
        """Member of the ROS message that contains the value, with its dot; empty if the field is the value itself."""
        return f".{self.field.member}" if self.field.kind is ConversionKind.HELD else ""

    @property
    def wrapped(self) -> str:
        """Accessor of the field in a wrapper such as google.protobuf.FloatValue; empty if there is no wrapper."""
        wrapping = self.field.wrapping
        return cpp_names.accessor(wrapping.field) if wrapping and not self._is_field_mask else ""

    @property
    def is_message(self) -> bool:
        """True if protobuf's side is a message, which is set by assigning to ``mutable_...``."""
        return self._is_field_mask or self.field.kind in {ConversionKind.MESSAGE, *_RUNTIME_HEADERS}

    @property
    def headers(self) -> set[str]:
        """Headers of the functions that convert the value."""
        if self.field.kind is ConversionKind.MESSAGE:
            return {self.context.converter(self.field.converter).header}
        name = "well_known" if self._is_field_mask else _RUNTIME_HEADERS.get(self.field.kind)
        return {cpp_names.runtime_header(name)} if name else set()

    def to_ros(self, source: str) -> str:
        """Return the expression of the ROS value."""
        if self.wrapped:
            source = f"{source}.{self.wrapped}()"
        if self.is_message:
            return self._called("to_ros", source)
        if self._ros.enum:
            return f"roverlink::narrow<{cpp_names.primitive(self._ros.type.name)}>({source}, {self.shown})"
        if self._ros.type.name == "string":
            return f"roverlink::text({source}, {self.shown})"
        return f"roverlink::octets({source})" if self._is_bytes else source

    def from_ros(self, source: str) -> str:
        """Return the expression of protobuf's value."""
        if self.is_message:
            return self._called("from_ros", source)
        source += self.member
        if self._ros.enum:
            return f"roverlink::Enumerator({source}, {self.shown})"
        if self._ros.type.name == "string":
            return f"roverlink::text({source}, {self.shown})"
        return f"roverlink::bytes({source})" if self._is_bytes else source

    def _called(self, direction: str, source: str) -> str:
        if self.field.kind is ConversionKind.MESSAGE:
            return f"{self.context.converter(self.field.converter).name}::{direction}({source})"
        name = "field_mask" if self._is_field_mask else self.field.converter
        return f"roverlink::{name}_{direction}({source}, {self.shown})"

    @property
    def _is_field_mask(self) -> bool:
        return self.field.wrapping is not None and self.field.wrapping.proto == FIELD_MASK

    @property
    def _ros(self) -> ir.RosField:
        """ROS field that contains the value itself."""
        return self.context.ros_field(self.field.ros.type.name, self.field.member) if self.member else self.field.ros

    @property
    def _is_bytes(self) -> bool:
        type = self._ros.type
        return type.name == "uint8" and type.is_sequence and (not self.field.repeated or bool(self.member))


@dataclass(frozen=True, slots=True)
class Holder:
    """Variable in ``from_ros`` for a nested message whose fields are fields of the ROS message."""

    name: str
    outer: str
    """Variable of the enclosing message."""
    accessor: str


@dataclass(frozen=True, slots=True)
class Field:
    """Field of a ROS message, with the payload's field on the other side."""

    conversion: ir.FieldConversion
    value: Value
    holder: str
    """Variable of the message that contains the payload's field."""
    members: tuple[tuple[str, Field], ...] = ()
    """Members of a oneof: the constant and the field of each."""

    @property
    def name(self) -> str:
        """Name of the ROS field."""
        return self.conversion.ros.name

    @property
    def kind(self) -> str:
        """Name of the `ConversionKind`; or ``MAP``, ``LIST``, or ``COPY`` for a list of unchanged values."""
        if self.conversion.entry:
            return "MAP"
        if not self.conversion.repeated:
            return self.conversion.kind.name
        return "COPY" if self.value.to_ros("item") + self.value.member == "item" else "LIST"

    @property
    def comment(self) -> list[str]:
        """Comment lines from the .proto file."""
        own = self.conversion.kind in (ConversionKind.PRESENCE, ConversionKind.WHICH)
        return [] if own else comment_lines(self.conversion.ros.comment)

    @property
    def accessor(self) -> str:
        """Accessor of the payload's field."""
        return cpp_names.accessor(self.conversion.proto_path[-1])

    @property
    def outer(self) -> str:
        """Expression in ``to_ros`` for the message that contains the payload's field."""
        return cpp_names.getter(self.conversion.proto_path[:-1])

    @property
    def entry(self) -> list[Value]:
        """Key and value of a map's entries; empty if the field is not a map."""
        entry = self.conversion.entry
        return [Value(part, self.value.shown, self.value.context) for part in (entry.key, entry.value)] if entry else []

    @property
    def condition(self) -> str:
        """Condition under which the payload's field is set; empty if it is always set."""
        if self.conversion.presence:
            return f"message.{self.conversion.presence}"
        conditions = {"EMPTY": f"message.{self.name}", "JSON": f"!message.{self.name}.empty()"}
        return conditions.get(self.kind, "")

    @property
    def is_set(self) -> bool:
        """True if ``from_ros`` has its own statement for the field.

        Presence, and members of a oneof, are part of another field's statement.
        """
        return self.conversion.kind is not ConversionKind.PRESENCE and not self.conversion.which

    @property
    def headers(self) -> set[str]:
        """Headers of the functions that convert the field."""
        return set().union(*(value.headers for value in self.entry or [self.value]))


@dataclass(frozen=True, slots=True)
class Fields:
    """Bodies of ``to_ros`` and ``from_ros`` of one conversion."""

    holders: tuple[Holder, ...]
    fields: tuple[Field, ...]
    """Fields in the order of the ROS message."""

    @property
    def headers(self) -> set[str]:
        """Headers that the bodies need."""
        return {cpp_names.runtime_header("values")}.union(*(field.headers for field in self.fields))


def fields_of(conversion: ir.Conversion, context: Context) -> Fields:
    """Return the fields of a conversion."""
    holders = _holders(conversion)

    def field_of(one: ir.FieldConversion) -> Field:
        value = Value(one, f'"{conversion.ros}.{one.ros.name}"', context)
        holder = holders.get(one.proto_path[:-1])
        by_name = {member.proto_path[-1]: member for member in conversion.fields if member.which == one.ros.name}
        members = tuple(
            (f"{context.struct(conversion.ros)}::{choice.constant}", field_of(by_name[choice.proto]))
            for choice in one.choices
        )
        return Field(one, value, holder.name if holder else "payload", members)

    return Fields(tuple(holders.values()), tuple(map(field_of, conversion.fields)))


def _holders(conversion: ir.Conversion) -> dict[tuple[str, ...], Holder]:
    """Return the variables for nested messages on the paths of fields, by path."""
    holders: dict[tuple[str, ...], Holder] = {}
    for field in conversion.fields:
        for depth in range(1, len(field.proto_path)):
            path = field.proto_path[:depth]
            if path not in holders:
                name = f"{'_'.join(path)}_payload"
                while name in {holder.name for holder in holders.values()}:
                    name += "_"
                outer = holders[path[:-1]].name if path[:-1] else "payload"
                holders[path] = Holder(name, outer, cpp_names.accessor(path[-1]))
    return holders
