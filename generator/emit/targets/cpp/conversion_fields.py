"""Fields of a conversion with the C++ code for each, as the template ``templates/cpp/fields.j2`` reads them."""

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
    """Value that is converted: a field's value, an item of a list, or the key or value of a map's entry."""

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
        """Member of the ROS message that contains the value, after a dot; empty if the ROS field is the value."""
        return f".{self.field.member}" if self.field.kind is ConversionKind.HELD else ""

    @property
    def wrapped(self) -> str:
        """Accessor of the value in a wrapper such as google.protobuf.FloatValue; empty if there is no wrapper."""
        wrapping = self.field.wrapping
        return cpp_names.accessor(wrapping.field) if wrapping and not self._is_field_mask else ""

    @property
    def is_message(self) -> bool:
        """True if the value is a message in protobuf. Such a value is assigned to ``*mutable_NAME()``."""
        return self._is_field_mask or self.field.kind in {ConversionKind.MESSAGE, *_RUNTIME_HEADERS}

    @property
    def headers(self) -> set[str]:
        """Headers that declare the C++ functions which convert the value."""
        if self.field.kind is ConversionKind.MESSAGE:
            return {self.context.converter(self.field.converter).header}
        name = "well_known" if self._is_field_mask else _RUNTIME_HEADERS.get(self.field.kind)
        return {cpp_names.runtime_header(name)} if name else set()

    def to_ros(self, source: str) -> str:
        """Return the C++ expression for the ROS value; ``source`` is the expression for protobuf's value."""
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
        """Return the C++ expression for protobuf's value; ``source`` is the expression for the ROS value."""
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
        """ROS field that contains the value: the field itself, or its only member if the ROS field is a message."""
        return self.context.ros_field(self.field.ros.type.name, self.field.member) if self.member else self.field.ros

    @property
    def _is_bytes(self) -> bool:
        type = self._ros.type
        return type.name == "uint8" and type.is_sequence and (not self.field.repeated or bool(self.member))


@dataclass(frozen=True, slots=True)
class Holder:
    """C++ variable in ``from_ros`` for a nested proto message whose fields stand directly in the ROS message."""

    name: str
    outer: str
    """Variable of the message that contains the nested message."""
    accessor: str


@dataclass(frozen=True, slots=True)
class Field:
    """Field of a ROS message, and the field of the payload to which it is converted."""

    conversion: ir.FieldConversion
    value: Value
    holder: str
    """C++ variable of the proto message that contains the payload's field."""
    members: tuple[tuple[str, Field], ...] = ()
    """Members of a oneof: the C++ constant of each member, and the member's field. Empty for other fields."""

    @property
    def name(self) -> str:
        """Name of the ROS field."""
        return self.conversion.ros.name

    @property
    def kind(self) -> str:
        """Kind of the conversion, as the template distinguishes it.

        This is ``MAP`` for a map, ``COPY`` for a list whose values stay the same, ``LIST`` for another list, and
        otherwise the name of the `ConversionKind`.
        """
        if self.conversion.entry:
            return "MAP"
        if not self.conversion.repeated:
            return self.conversion.kind.name
        return "COPY" if self.value.to_ros("item") + self.value.member == "item" else "LIST"

    @property
    def comment(self) -> list[str]:
        """Lines of the field's comment in the .proto file."""
        own = self.conversion.kind in (ConversionKind.PRESENCE, ConversionKind.WHICH)
        return [] if own else comment_lines(self.conversion.ros.comment)

    @property
    def accessor(self) -> str:
        """Name of protobuf's C++ accessor for the payload's field."""
        return cpp_names.accessor(self.conversion.proto_path[-1])

    @property
    def outer(self) -> str:
        """C++ expression in ``to_ros`` for the proto message that contains the payload's field."""
        return cpp_names.getter(self.conversion.proto_path[:-1])

    @property
    def entry(self) -> list[Value]:
        """Two values, the key and the value of a map's entry; empty if the field is not a map."""
        entry = self.conversion.entry
        return [Value(part, self.value.shown, self.value.context) for part in (entry.key, entry.value)] if entry else []

    @property
    def condition(self) -> str:
        """C++ condition under which ``from_ros`` sets the payload's field; empty if it is always set."""
        if self.conversion.presence:
            return f"message.{self.conversion.presence}"
        conditions = {"EMPTY": f"message.{self.name}", "JSON": f"!message.{self.name}.empty()"}
        return conditions.get(self.kind, "")

    @property
    def is_set(self) -> bool:
        """True if ``from_ros`` has a statement for this field alone.

        A field for presence is read by the statement of another field, and a member of a oneof by that of the oneof.
        """
        return self.conversion.kind is not ConversionKind.PRESENCE and not self.conversion.which

    @property
    def headers(self) -> set[str]:
        """Headers that declare the C++ functions which convert the field."""
        return set().union(*(value.headers for value in self.entry or [self.value]))


@dataclass(frozen=True, slots=True)
class Fields:
    """Data from which the template writes the C++ functions ``to_ros`` and ``from_ros`` of one conversion."""

    holders: tuple[Holder, ...]
    fields: tuple[Field, ...]
    """Fields of the ROS message, in the order of the message."""

    @property
    def headers(self) -> set[str]:
        """Headers that the two functions need."""
        return {cpp_names.runtime_header("values")}.union(*(field.headers for field in self.fields))


def fields_of(conversion: ir.Conversion, context: Context) -> Fields:
    """Return the data from which the template writes the functions of a conversion."""
    holders = _holders(conversion)

    def field_of(converted: ir.FieldConversion) -> Field:
        value = Value(converted, f'"{conversion.ros}.{converted.ros.name}"', context)
        holder = holders.get(converted.proto_path[:-1])
        by_name = {member.proto_path[-1]: member for member in conversion.fields if member.which == converted.ros.name}
        members = tuple(
            (f"{context.struct(conversion.ros)}::{choice.constant}", field_of(by_name[choice.proto]))
            for choice in converted.choices
        )
        return Field(converted, value, holder.name if holder else "payload", members)

    return Fields(tuple(holders.values()), tuple(map(field_of, conversion.fields)))


def _holders(conversion: ir.Conversion) -> dict[tuple[str, ...], Holder]:
    """Return the C++ variables for the nested proto messages of a conversion, by the path of the nested message."""
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
