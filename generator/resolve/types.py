"""Conversion of one proto field: the type of the ROS field, and the kind of conversion."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir import ros_names
from roverlink.generator.ir.model import ConversionKind
from roverlink.generator.ir.protobuf_facts import OWN_FILES
from roverlink.generator.protos.schema import ProtoEnum, ProtoField, ProtoMessage, Schema, commented
from roverlink.generator.resolve import enums, well_known
from roverlink.generator.resolve.field_overrides import FieldSettings
from roverlink.generator.table import EnumSettings


class MessageMaker(Protocol):
    """Interface through which the conversion of a field gets the ROS messages that the field needs.

    `RosMessages` implements it. `RosMessages` uses this module for the fields of a message, and this module needs ROS
    messages for nested messages. The protocol breaks this import cycle.
    """

    schema: Schema
    settings: FieldSettings
    report: Callable[[Diagnostic], None]
    messages: dict[str, ir.RosMessage]

    def claim(self, ros: str, source: str, span: Span) -> None:
        """Record that a ROS message's name is used; report the name if it is already used for another source.

        ``source`` names the proto message or field that needs the ROS message.
        """

    def nested_message(self, field: ProtoField, proto: str) -> str | None:
        """Return the name of the ROS message for the proto message ``proto``, which is the type of a field.

        A field that makes a message contain itself is reported, and the result is None.
        """

    def any_message(self, message: ProtoMessage, field: ProtoField, ros: str, types: tuple[str, ...]) -> str:
        """Return the name of the ROS message for a google.protobuf.Any that may contain the messages ``types``."""

    def bytes_message(self) -> str:
        """Return the name of the ROS message for one item of a `repeated bytes` field."""

    def enum_message(self, enum: ProtoEnum) -> EnumSettings | None:
        """Return the settings of an enum that the table lists under `enums`; None for any other enum.

        An enum under `enums` becomes a ROS message of its own, which is built by the first call for this enum.
        """


@dataclass(frozen=True, slots=True)
class _Value:
    """ROS type and conversion of a single value of a proto field.

    The attributes have the meanings that they have in `ir.FieldConversion` and `ir.RosField`.
    """

    kind: ConversionKind
    type: ir.RosType
    converter: str = ""
    member: str = ""
    wrapping: ir.Wrapping | None = None
    enum: str = ""


class FieldTypes:
    """Converter of the fields of one proto message. It collects the enums whose constants the ROS message needs."""

    def __init__(self, messages: MessageMaker, ros: str) -> None:
        self._messages, self._schema, self._ros = messages, messages.schema, ros
        self.enums: dict[str, ProtoEnum] = {}

    def conversion(
        self, message: ProtoMessage, field: ProtoField, path: tuple[str, ...], name: str
    ) -> ir.FieldConversion | None:
        """Return the conversion between a proto field and the ROS field ``name``.

        A field that cannot be converted is reported, and the result is None. ``message`` declares the field. ``path``
        has the names of the fields that lead to the field, then its own name.
        """
        held = self._schema.messages.get(field.type_name)
        if held is not None and held.map_entry:
            return self._map(message, field, path, name)
        if field.type_name == well_known.EMPTY and not (field.repeated or field.oneof or message.map_entry):
            ros = ir.RosField(f"has_{name}", ir.RosType("bool"), _comment(message, field, path))
            return ir.FieldConversion(path, ros, ConversionKind.EMPTY)
        value = self._value(message, field, path)
        if value is None:
            return None
        type = dataclasses.replace(value.type, is_sequence=field.repeated or value.type.is_sequence)
        return ir.FieldConversion(
            path,
            ir.RosField(name, type, _comment(message, field, path), value.enum),
            value.kind,
            field.repeated,
            converter=value.converter,
            member=value.member,
            wrapping=value.wrapping,
        )

    def _value(self, message: ProtoMessage, field: ProtoField, path: tuple[str, ...]) -> _Value | None:
        if field.type == "enum":
            return self._enum(self._schema.enums[field.type_name])
        if field.type not in ("message", "group"):
            return self._scalar(field.type, field.repeated)
        proto = field.type_name
        if proto in well_known.TIMES:
            module, type = well_known.time_type(proto)
            return _Value(ConversionKind.WELL_KNOWN, type, module)
        if proto in well_known.TEXTS:
            return _Value(ConversionKind.JSON, ir.RosType("string"), well_known.TEXTS[proto])
        if proto in well_known.WRAPPERS:
            bare = self._scalar(well_known.WRAPPERS[proto], field.repeated)
            return dataclasses.replace(bare, wrapping=ir.Wrapping(proto, "value"))
        if proto == well_known.FIELD_MASK and not field.repeated:
            paths = ir.RosType("string", is_sequence=True)
            return _Value(ConversionKind.VALUE, paths, wrapping=ir.Wrapping(proto, "paths"))
        nested = self._message(message, field, path)
        return _Value(ConversionKind.MESSAGE, ir.RosType(nested, is_message=True), nested) if nested else None

    def _scalar(self, type: str, repeated: bool) -> _Value:
        if type != "bytes":
            return _Value(ConversionKind.VALUE, ir.RosType(well_known.SCALARS[type]))
        if not repeated:
            return _Value(ConversionKind.VALUE, ir.RosType("uint8", is_sequence=True))
        held = ir.RosType(self._messages.bytes_message(), is_message=True)  # ROS has no sequence of sequences
        return _Value(ConversionKind.HELD, held, member="data")

    def _enum(self, enum: ProtoEnum) -> _Value:
        settings = self._messages.enum_message(enum)
        if settings is not None:
            return _Value(ConversionKind.HELD, ir.RosType(settings.ros, is_message=True), member=settings.field)
        self.enums[enum.full_name] = enum
        return _Value(ConversionKind.VALUE, ir.RosType(enums.integer_type(enum)), enum=enum.full_name)

    def _message(self, message: ProtoMessage, field: ProtoField, path: tuple[str, ...]) -> str | None:
        """Return the name of the ROS message for a proto field whose type is a message.

        A field that makes a message contain itself is reported, and the result is None.
        """
        holder, owner = self._owner(message, field)
        types = self._messages.settings.anys.get((holder.full_name, owner.name))
        if field.type_name == well_known.ANY and types:
            ros = self._ros.removesuffix("Entry") if message.map_entry else f"{self._ros}{_camel(path)}"
            return self._messages.any_message(holder, owner, ros, types)
        return self._messages.nested_message(owner, field.type_name)

    def _owner(self, message: ProtoMessage, field: ProtoField) -> tuple[ProtoMessage, ProtoField]:
        """Replace a field of a generated map entry by the map's field, and return it with the message that declares it.

        protoc generates a message for the entries of a map, with the fields ``key`` and ``value``. The .proto file
        declares the map only. Any other field is returned unchanged.
        """
        if not message.map_entry:
            return message, field
        holder = self._schema.messages[message.full_name.rpartition(".")[0]]
        return holder, next(field for field in holder.fields if field.type_name == message.full_name)

    def _map(
        self, message: ProtoMessage, field: ProtoField, path: tuple[str, ...], name: str
    ) -> ir.FieldConversion | None:
        entry = self._schema.messages[field.type_name]
        # ROS has no maps. A map becomes a list of entries with key and value, which is what protobuf sends, too.
        ros = f"{self._ros}{_camel(path)}Entry"
        self._messages.claim(ros, f"{self._ros}.{'.'.join(path)}", field.span)
        types = FieldTypes(self._messages, ros)
        key, value = (types.conversion(entry, part, (part.name,), part.name) for part in entry.fields)
        if key is None or value is None:
            return None
        constants = tuple(enums.constants_of(types.enums.values(), (), ros, field.span, self._messages.report))
        self._messages.messages[ros] = ir.RosMessage(ros, (key.ros, value.ros), constants, "", entry.full_name)
        field_of_entries = ir.RosField(name, ir.RosType(ros, True, True), _comment(message, field, path))
        return ir.FieldConversion(
            path, field_of_entries, ConversionKind.MESSAGE, True, entry=ir.MapEntry(ros, key, value)
        )


def _comment(message: ProtoMessage, field: ProtoField, path: tuple[str, ...]) -> str:
    """Return the comment of a proto field, which the .msg file repeats.

    The result is empty for a field of google.protobuf's messages: these comments explain protobuf's libraries.
    """
    return "" if message.file.startswith(OWN_FILES) and len(path) == 1 else commented(field)


def _camel(path: tuple[str, ...]) -> str:
    return ros_names.camel_case("_".join(path))
