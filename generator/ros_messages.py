"""The ROS messages and the conversions of a table, each made once, from the protos that its rows reach."""

from __future__ import annotations

import dataclasses
import keyword
from collections.abc import Iterator

from generator import ir, naming, ros_enums, well_known
from generator.conversion_rules import (
    CANNOT_CONVERT,
    EXTENSIONS,
    FIELD_NAME_FORBIDDEN,
    FIELD_NAME_TAKEN,
    MESSAGE_NAME_TAKEN,
    UNKNOWN_ENUM,
    WITHOUT_EFFECT,
)
from generator.deprecation import commented
from generator.diagnostics import Diagnostic, Span, nearest
from generator.field_settings import FieldSettings, without_effect_on_standard
from generator.oneofs import NONE, smallest
from generator.protos import ProtoEnum, ProtoField, ProtoMessage, Schema
from generator.recursion import CUT, Levels
from generator.ros_fields import MessageBuilder
from generator.shape import Shape, shapes_of
from generator.table import EnumSettings, Row, Table

_LARGEST = 1000  # messages that stand in one another; two fields in sixteen levels would make 65535


class RosMessages:
    """Makes ROS messages and conversions, each once, from the protos that the rows reach."""

    def __init__(self, table: Table, schema: Schema, findings: list[Diagnostic]) -> None:
        self.schema, self.report = schema, findings.append
        self._enum_settings = {enum.proto: enum for enum in table.enums}
        self._shapes = shapes_of(table, findings)
        self.settings = FieldSettings(table, schema, self.report)
        self.levels = Levels(table, self._held, self.report)
        self._names: dict[str, tuple[str, str]] = {}
        self._in_progress: list[tuple[str, int]] = []
        self._made: dict[tuple[str, int], ir.Conversion] = {}
        self.messages: dict[str, ir.RosMessage] = {}
        self.anys: dict[str, ir.AnyConversion] = {}
        self.enums_used: set[str] = set()

    @property
    def conversions(self) -> dict[str, ir.Conversion]:
        """Those that were made, by their ROS messages."""
        return {conversion.ros: conversion for conversion in self._made.values()}

    def route(self, row: Row) -> ir.Route:
        """A row, with the conversion of its payload to a message of the package, where it becomes one."""
        conversion = None if row.feed else self._conversion(self.schema.messages[row.proto], 1)
        if row.recursion is not None:
            self._check_recursion(row, conversion)
        where = (row.number, row.name, row.topic, row.direction, row.inbound, row.qos, row.forward)
        return ir.Route(*where, row.proto, conversion, expect_rate=row.expect_rate)

    def _check_recursion(self, row: Row, conversion: ir.Conversion | None) -> None:
        span = row.at("recursion")
        if conversion is None:
            self.report(WITHOUT_EFFECT.at(span, *without_effect_on_standard("recursion", row)))
            return
        if row in self.levels.rows_without_effect:
            self.report(WITHOUT_EFFECT.at(span, f"{row.proto} holds no message that holds itself", "remove it"))
        count = self._count(conversion.ros, self.conversions)
        if count > _LARGEST:
            message = f"each {conversion.ros} would hold {count - 1} messages, whether they are set or not"
            self.report(CANNOT_CONVERT.at(span, message, "state a smaller recursion, or make the field repeated"))

    def _count(self, ros: str, conversions: dict[str, ir.Conversion], known: dict[str, int] | None = None) -> int:
        """How many messages stand in one that holds empty lists: itself, and what is in its fields."""
        known = {} if known is None else known
        if ros not in known:
            fields = conversions[ros].fields if ros in conversions else ()
            held = [one.converter for one in fields if one.converter and not one.repeated]
            held += [member.ros for member in self.anys[ros].members] if ros in self.anys else []
            known[ros] = 1 + sum(self._count(one, conversions, known) for one in held)
        return known[ros]

    def check_enums(self) -> None:
        """An enum that the table names, but no payload has, is a mistake."""
        for settings in self._enum_settings.values():
            if settings.proto not in self.enums_used:
                help = nearest(settings.proto, self.enums_used, "remove it, or correct its name")
                self.report(UNKNOWN_ENUM.at(settings.span, f"no payload has the enum {settings.proto}", help))

    # --- messages ---

    def _held(self, proto: str) -> Iterator[str]:
        """The messages that a message holds, as far as ROS messages are made of them."""
        message, shape = self.schema.messages.get(proto), self._shapes.get(proto)
        if message is None or not well_known.holds_messages(proto):
            return
        for field in message.fields:
            if shape is None or field.name not in shape.ignore:
                yield from self.settings.anys.get((proto, field.name), (self._held_in(field),))

    def _held_in(self, field: ProtoField) -> str:
        """The message in a field, or in the values of a map; empty for none."""
        held = self.schema.messages.get(field.type_name)
        return held.fields[1].type_name if held and held.map_entry else field.type_name

    def level_of(self, message: ProtoMessage, level: int, field: ProtoField) -> int:
        """The level of the message in a field of one at a level; `recursion.CUT` where it is one too many."""
        return self.levels.of(message.full_name, level, self._held_in(field))

    def _conversion(self, message: ProtoMessage, level: int) -> ir.Conversion:
        proto = message.full_name
        if (proto, level) in self._made:
            return self._made[proto, level]
        package = self._package_of(message)
        shape = self._shapes.get(proto) or Shape(naming.message_name(proto, package))
        if level > 1:
            shape = dataclasses.replace(shape, ros=f"{shape.ros}Level{level}")
        self.claim(shape.ros, proto if level == 1 else f"{proto} at level {level}", _place(shape, message), shape.row)
        if any(keyword.iskeyword(part) for part in proto.split(".")):
            told = f"{proto} is named by a keyword of Python, so that generated code cannot reach it"
            self.report(CANNOT_CONVERT.at(message.span, told, "rename it: no wire has its name"))
        if message.extendable:
            told = f"extensions of {proto} are not carried: no ROS field takes them"
            self.report(EXTENSIONS.at(message.span, told, "make them fields of the message to carry them"))
        self._in_progress.append((proto, level))
        builder = MessageBuilder(self, message, shape, level)
        builder.add_fields(message, (), level)
        if level == 1:
            builder.check_paths()
        self._in_progress.pop()
        self.messages[shape.ros] = builder.message()
        fields, cut = tuple(builder.conversions), tuple(builder.cut)
        self._made[proto, level] = ir.Conversion(proto, package, message.file, shape.ros, fields, cut)
        return self._made[proto, level]

    def _package_of(self, message: ProtoMessage) -> str:
        """The proto package: what is left of the full name without the nesting messages."""
        outer = message.full_name.rpartition(".")[0]
        while outer in self.schema.messages:
            outer = outer.rpartition(".")[0]
        return outer

    def claim(self, ros: str, source: str, span: Span, row: Row | None = None) -> None:
        """Two sources must not become ROS messages of one name, nor of two whose files have one name."""
        if not naming.is_message_name(ros) and row is None:  # a row's own name has a rule of its own
            told = f"{source} cannot become the ROS message {ros!r}: ROS forbids the name"
            self.report(CANNOT_CONVERT.at(span, told, "rename it in the .proto: no wire has its name"))
        taken, holder = self._names.setdefault(naming.snake_case(ros), (ros, source))
        if holder != source:
            why = (
                f"which {holder} is already" if taken == ros else f"which is too much like {taken}, made from {holder}"
            )
            help = "give one of them another `ros`"
            self.report(MESSAGE_NAME_TAKEN.at(span, f"{source} would become {ros}, {why}", help))

    def nested_message(self, message: ProtoMessage, level: int, field: ProtoField, proto: str) -> str | None:
        """The ROS message of what a field of a message at a level holds; None, with a finding, where there is none."""
        inner = self.levels.of(message.full_name, level, proto)
        if (proto, inner) in self._in_progress:
            circle = [name for name, _ in self._in_progress[self._in_progress.index((proto, inner)) :]]
            told = f"{field.name} makes a recursive message: {' -> '.join([*circle, proto])}"
            help = (
                "no ROS message holds itself: say how deep it may be with `recursion`, or name the field under `ignore`"
            )
            self.report(CANNOT_CONVERT.at(field.span, told, help))
            return None
        return self._conversion(self.schema.messages[proto], inner).ros

    def any_message(
        self, message: ProtoMessage, level: int, field: ProtoField, ros: str, types: tuple[str, ...]
    ) -> str | None:
        """The ROS message of an Any of which the table says what it may hold."""
        source = f"{message.full_name}.{field.name}"
        self.claim(ros, f"{source} of {ros}", field.span)
        which = ir.RosField("which", ir.RosType(smallest(len(types))), "Which of them it holds.", source)
        fields, constants = [which], [ir.RosConstant(NONE, which.type.name, 0, "", source)]
        members: list[ir.AnyMember] = []
        for number, type in enumerate(types, start=1):
            inner = self.levels.of(message.full_name, level, type)
            if type not in self.schema.messages or inner == CUT:
                continue
            if (type, inner) in self._in_progress:
                told = f"{field.name} makes a recursive message: it may hold a {type}, which holds it"
                help = "say how deep it may be with `recursion`, or take the type out of `any`"
                self.report(CANNOT_CONVERT.at(field.span, told, help))
                continue
            held = self._conversion(self.schema.messages[type], inner).ros
            last = naming.snake_case(type.rpartition(".")[2])
            member = ir.AnyMember(type, held, naming.field_name(last), naming.constant_name(last))
            if member.field in [one.name for one in fields] or member.constant == NONE:
                told = f"{ros} would have a second {member.field}, for {type}"
                self.report(
                    FIELD_NAME_TAKEN.at(field.span, told, "rename one in the .proto: but for Any, no wire has it")
                )
            members.append(member)
            fields.append(ir.RosField(member.field, ir.RosType(held, is_message=True), ""))
            constants.append(ir.RosConstant(member.constant, which.type.name, number, "", source))
        self.messages[ros] = ir.RosMessage(ros, tuple(fields), tuple(constants), "", source)
        self.anys[ros] = ir.AnyConversion(source, ros, tuple(members))
        return ros

    def bytes_message(self) -> str:
        """The ROS message of bytes in a list."""
        self.claim("Bytes", "bytes in a list", Span(""))
        field = ir.RosField("data", ir.RosType("uint8", is_sequence=True), "")
        self.messages["Bytes"] = ir.RosMessage("Bytes", (field,), (), "", "bytes")
        return "Bytes"

    def enum_message(self, enum: ProtoEnum) -> EnumSettings | None:
        """The table's settings of an enum that is a message of its own; that message is made."""
        settings = self._enum_settings.get(enum.full_name)
        if settings is not None and enum.full_name not in self.enums_used:
            self._make_enum_message(enum, settings)
        self.enums_used.add(enum.full_name)
        return settings

    def _make_enum_message(self, enum: ProtoEnum, settings: EnumSettings) -> None:
        self.claim(settings.ros, enum.full_name, settings.at("ros"))
        if why := naming.unusable(settings.field):
            message = f"{settings.field!r} cannot be a field of a ROS message: {why}"
            self.report(FIELD_NAME_FORBIDDEN.at(settings.at("field"), message))
        self.messages[settings.ros] = ir.RosMessage(
            settings.ros,
            (ir.RosField(settings.field, ir.RosType(ros_enums.integer_type(enum)), "", enum.full_name),),
            tuple(ros_enums.constants(enum, "", self.report)),
            commented(enum),
            enum.full_name,
        )


def _place(shape: Shape, message: ProtoMessage) -> Span:
    return shape.row.ros_span if shape.row else message.span
