"""Builder of the generated ROS messages and their conversions, for all payloads and the messages inside payloads."""

from __future__ import annotations

import keyword

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir import ros_names
from roverlink.generator.protos.schema import ProtoEnum, ProtoField, ProtoMessage, Schema, commented
from roverlink.generator.resolve import enums
from roverlink.generator.resolve.conversion_rules import (
    CannotConvert,
    ExtensionsNotCarried,
    FieldNameForbidden,
    FieldNameTaken,
    MessageNameTaken,
    UnknownEnum,
)
from roverlink.generator.resolve.field_overrides import FieldSettings
from roverlink.generator.resolve.fields import MessageBuilder
from roverlink.generator.resolve.message_shapes import Shape, shapes_of
from roverlink.generator.resolve.numeric_ranges import smallest_integer
from roverlink.generator.resolve.oneofs import NONE
from roverlink.generator.table import EnumSettings, Row, Table
from roverlink.suggestions import nearest


class RosMessages:
    """Builder of all generated ROS messages, and of the conversions between them and the proto messages.

    A ROS message that several rows need is built once.
    """

    def __init__(self, table: Table, schema: Schema, findings: list[Diagnostic]) -> None:
        self.schema, self.report = schema, findings.append
        self._enum_settings = {enum.proto: enum for enum in table.enums}
        self._shapes = shapes_of(table, findings)
        self.settings = FieldSettings(table, schema, self.report)
        self._names: dict[str, tuple[str, str]] = {}
        self._in_progress: list[str] = []
        self._made: dict[str, ir.Conversion] = {}
        self.messages: dict[str, ir.RosMessage] = {}
        self.anys: dict[str, ir.AnyConversion] = {}
        self.enums_used: set[str] = set()

    @property
    def conversions(self) -> dict[str, ir.Conversion]:
        """Conversions between proto messages and generated ROS messages, by the name of the ROS message."""
        return {conversion.ros: conversion for conversion in self._made.values()}

    def conversion(self, row: Row) -> ir.Conversion | None:
        """Return the conversion between a row's payload and its generated ROS message.

        It is None if the row has a standard message, such as ``sensor_msgs/Imu``.
        """
        return None if row.standard else self._conversion(self.schema.messages[row.proto])

    def check_enums(self) -> None:
        """Report each enum that the table lists under `enums`, but that no payload contains."""
        for settings in self._enum_settings.values():
            if settings.proto not in self.enums_used:
                help = nearest(settings.proto, self.enums_used, "remove the entry, or correct the enum's name")
                self.report(UnknownEnum.at(settings.span, f"no payload contains the enum {settings.proto!r}", help))

    # --- messages ---

    def _conversion(self, message: ProtoMessage) -> ir.Conversion:
        proto = message.full_name
        if proto in self._made:
            return self._made[proto]
        package = self._package_of(message)
        shape = self._shapes.get(proto) or Shape(ros_names.message_name(proto, package))
        self.claim(shape.ros, proto, _place(shape, message), shape.row)
        if any(keyword.iskeyword(part) for part in proto.split(".")):
            fault = f"the name {proto!r} contains a Python keyword, so generated code cannot access it"
            self.report(
                CannotConvert.at(
                    message.span, fault, "rename the message; the name is not sent, so the encoding does not change"
                )
            )
        if message.extendable:
            fault = f"extensions of {proto!r} are lost, because they have no ROS fields"
            self.report(
                ExtensionsNotCarried.at(message.span, fault, "declare the extensions as ordinary fields of the message")
            )
        # A message that is found again while it is in progress contains itself. Protobuf allows that, a ROS message
        # cannot: its size in memory would be infinite (rosidl generates C structs by value).
        self._in_progress.append(proto)
        builder = MessageBuilder(self, message, shape)
        builder.add_fields(message, ())
        builder.check_paths()
        self._in_progress.pop()
        self.messages[shape.ros] = builder.message()
        self._made[proto] = ir.Conversion(proto, package, message.file, shape.ros, tuple(builder.conversions))
        return self._made[proto]

    def _package_of(self, message: ProtoMessage) -> str:
        """Return the proto package of a message: its full name without its own name and the messages around it.

        For example, the package of ``rover.Imu.Sample`` is ``rover`` if ``Sample`` is declared inside ``Imu``.
        """
        outer = message.full_name.rpartition(".")[0]
        while outer in self.schema.messages:
            outer = outer.rpartition(".")[0]
        return outer

    def claim(self, ros: str, source: str, span: Span, row: Row | None = None) -> None:
        """Record that a ROS message's name is used; report a name that ROS forbids or that collides with another name.

        rosidl names header files in snake_case, so two names collide if their snake_case forms are equal: ``PHInfo``
        and ``PhInfo``. ``source`` names the proto message, enum or field that needs the ROS message. ``row`` is the row
        that sets the name; None if no row sets it.
        """
        if not ros_names.is_message_name(ros) and row is None:  # ROS101 checks the name in a row
            fault = f"{source!r} cannot become the ROS message {ros!r}: ROS does not allow the name"
            self.report(
                CannotConvert.at(
                    span, fault, "rename it in the .proto file; the name is not sent, so the encoding does not change"
                )
            )
        taken, holder = self._names.setdefault(ros_names.snake_case(ros), (ros, source))
        if holder != source:
            why = (
                f"and so would {holder!r}"
                if taken == ros
                else f"which differs from {taken!r} (of {holder!r}) only in capitals"
            )
            help = "give one of the two another name with the key `ros`"
            self.report(MessageNameTaken.at(span, f"{source!r} would become the ROS message {ros!r}, {why}", help))

    def nested_message(self, field: ProtoField, proto: str) -> str | None:
        """Return the name of the ROS message for the proto message ``proto``, which is the type of a field.

        The ROS message is built if it does not exist yet. A field that makes a message contain itself is reported, and
        the result is None.
        """
        if self._is_recursive(field, proto, "list this field, or one that leads to it, under `ignore`"):
            return None
        return self._conversion(self.schema.messages[proto]).ros

    def _is_recursive(self, field: ProtoField, proto: str, help: str) -> bool:
        """Return True, and report the field, if the field makes a proto message contain itself.

        This can happen directly or through other messages. ROS does not allow it. ``proto`` is the message in the
        field; ``help`` is the help line of the diagnostic.
        """
        if proto not in self._in_progress:
            return False
        cycle = " -> ".join([*self._in_progress[self._in_progress.index(proto) :], proto])
        fault = f"the field {field.name!r} makes a message contain itself, which ROS does not allow: {cycle}"
        self.report(CannotConvert.at(field.span, fault, help))
        return True

    def any_message(self, message: ProtoMessage, field: ProtoField, ros: str, types: tuple[str, ...]) -> str:
        """Build the ROS message ``ros`` for a google.protobuf.Any, and return the name of the ROS message.

        ``types`` are the proto messages that the Any may contain according to the table. The ROS message has a field
        for each of them, and a field ``which`` that tells which one the Any contains. ``message`` declares ``field``.
        """
        source = f"{message.full_name}.{field.name}"
        self.claim(ros, f"{source} of {ros}", field.span)
        which = ir.RosField(
            "which", ir.RosType(smallest_integer([len(types)])), "The message that it contains.", source
        )
        # 0 is NONE: a ROS message that nobody filled has zeros everywhere, and must not claim to hold a message.
        fields, constants = [which], [ir.RosConstant(NONE, which.type.name, 0, "", source)]
        members: list[ir.AnyMember] = []
        for number, type in enumerate(types, start=1):
            if type not in self.schema.messages or self._is_recursive(field, type, f"remove {type!r} from `any`"):
                continue
            held = self._conversion(self.schema.messages[type]).ros
            last = ros_names.snake_case(type.rpartition(".")[2])
            member = ir.AnyMember(type, held, ros_names.field_name(last), ros_names.constant_name(last))
            if member.field in [field.name for field in fields] or member.constant == NONE:
                fault = f"the ROS message {ros!r} cannot have a field {member.field!r} for {type!r}: the name is taken"
                self.report(
                    FieldNameTaken.at(
                        field.span,
                        fault,
                        "rename the message in the .proto files of all peers, because an Any contains its name",
                    )
                )
            members.append(member)
            fields.append(ir.RosField(member.field, ir.RosType(held, is_message=True), ""))
            constants.append(ir.RosConstant(member.constant, which.type.name, number, "", source))
        self.messages[ros] = ir.RosMessage(ros, tuple(fields), tuple(constants), "", source)
        self.anys[ros] = ir.AnyConversion(source, ros, tuple(members))
        return ros

    def bytes_message(self) -> str:
        """Build the ROS message ``Bytes``, which contains one item of a `repeated bytes` field, and return its name.

        ROS has no sequences of sequences, so the field becomes a sequence of ``Bytes`` messages.
        """
        self.claim("Bytes", "bytes in a list", Span(""))
        field = ir.RosField("data", ir.RosType("uint8", is_sequence=True), "")
        self.messages["Bytes"] = ir.RosMessage("Bytes", (field,), (), "", "bytes")
        return "Bytes"

    def enum_message(self, enum: ProtoEnum) -> EnumSettings | None:
        """Return the settings of an enum that the table lists under `enums`; None for any other enum.

        An enum under `enums` becomes a ROS message of its own. It is built when the enum is first used.
        """
        settings = self._enum_settings.get(enum.full_name)
        if settings is not None and enum.full_name not in self.enums_used:
            self._make_enum_message(enum, settings)
        self.enums_used.add(enum.full_name)
        return settings

    def _make_enum_message(self, enum: ProtoEnum, settings: EnumSettings) -> None:
        self.claim(settings.ros, enum.full_name, settings.at("ros"))
        if why := ros_names.unusable(settings.field):
            message = f"{settings.field!r} cannot be a field of a ROS message: {why}"
            self.report(FieldNameForbidden.at(settings.at("field"), message, "write another name under `field`"))
        self.messages[settings.ros] = ir.RosMessage(
            settings.ros,
            (ir.RosField(settings.field, ir.RosType(enums.integer_type(enum)), "", enum.full_name),),
            tuple(enums.constants(enum, "", self.report)),
            commented(enum),
            enum.full_name,
        )


def _place(shape: Shape, message: ProtoMessage) -> Span:
    return shape.row.ros_span if shape.row else message.span
