"""The ROS messages and the conversions of a table, each made once, from the protos that its rows reach."""

from __future__ import annotations

import keyword

from generator import ir, naming, ros_enums
from generator.findings import Finding, Rule, Severity, Span, nearest
from generator.protos import ProtoEnum, ProtoField, ProtoMessage, Schema
from generator.ros_fields import BY_KEYWORD, CANNOT_CONVERT, FIELD_NAME_FORBIDDEN, MessageBuilder, unusable
from generator.shape import Shape, shapes_of
from generator.table import EnumSettings, Row, Table

MESSAGE_NAME_TAKEN = Rule("CNV106", "message-name-taken")
UNKNOWN_ENUM = Rule("CNV109", "unknown-enum")
EXTENSIONS = Rule("CNV110", "extensions-not-carried", Severity.WARNING)


class RosMessages:
    """Makes ROS messages and conversions, each once, from the protos that the rows reach."""

    def __init__(self, table: Table, schema: Schema, findings: list[Finding]) -> None:
        self.schema, self.report = schema, findings.append
        self._enum_settings = {enum.proto: enum for enum in table.enums}
        self._shapes = shapes_of(table, findings)
        self._names: dict[str, tuple[str, str]] = {}
        self._in_progress: list[str] = []
        self.messages: dict[str, ir.RosMessage] = {}
        self.conversions: dict[str, ir.Conversion] = {}
        self.enums_used: set[str] = set()

    def route(self, row: Row) -> ir.Route:
        """A row, with the conversion of its payload."""
        conversion = self._conversion(self.schema.messages[row.proto])
        return ir.Route(row.number, row.name, row.topic, row.direction, row.inbound, row.qos, row.forward, conversion)

    def check_enums(self) -> None:
        """An enum that the table names, but no payload has, is a mistake."""
        for settings in self._enum_settings.values():
            if settings.proto not in self.enums_used:
                help = nearest(settings.proto, self.enums_used, "remove it, or correct its name")
                self.report(UNKNOWN_ENUM.at(settings.span, f"no payload has the enum {settings.proto}", help))

    # --- messages ---

    def _conversion(self, message: ProtoMessage) -> ir.Conversion:
        proto = message.full_name
        if proto in self.conversions:
            return self.conversions[proto]
        package = self._package_of(message)
        shape = self._shapes.get(proto) or Shape(naming.message_name(proto, package))
        self._claim(shape.ros, proto, shape.row.ros_span if shape.row else message.span)
        if any(keyword.iskeyword(part) for part in proto.split(".")):
            self.report(CANNOT_CONVERT.at(message.span, f"{proto} {BY_KEYWORD}", "rename it: no wire has its name"))
        if message.extendable:
            self.report(EXTENSIONS.at(message.span, f"extensions of {proto} are not carried: no ROS field takes them"))
        self._in_progress.append(proto)
        builder = MessageBuilder(self, message, shape)
        builder.add_fields(message, ())
        builder.check_paths()
        self._in_progress.pop()
        self.messages[shape.ros] = builder.message()
        self.conversions[proto] = ir.Conversion(proto, package, message.file, shape.ros, tuple(builder.conversions))
        return self.conversions[proto]

    def _package_of(self, message: ProtoMessage) -> str:
        """The proto package: what is left of the full name without the nesting messages."""
        outer = message.full_name.rpartition(".")[0]
        while outer in self.schema.messages:
            outer = outer.rpartition(".")[0]
        return outer

    def _claim(self, ros: str, source: str, span: Span) -> None:
        """Two sources must not become ROS messages of one name, nor of two whose files have one name."""
        if not naming.is_message_name(ros) and source not in self._shapes:  # a row's own name has a rule of its own
            self.report(
                CANNOT_CONVERT.at(span, f"{source} cannot become the ROS message {ros!r}: ROS forbids the name")
            )
        taken, holder = self._names.setdefault(naming.snake_case(ros), (ros, source))
        if holder != source:
            why = (
                f"which {holder} is already" if taken == ros else f"which is too much like {taken}, made from {holder}"
            )
            help = "give one of them another `ros`"
            self.report(MESSAGE_NAME_TAKEN.at(span, f"{source} would become {ros}, {why}", help))

    def nested_type(self, field: ProtoField) -> str | None:
        """The ROS message of a message field; None, with a finding, where it cannot be one."""
        proto = field.type_name
        if proto in self._in_progress:
            cycle = " -> ".join([*self._in_progress[self._in_progress.index(proto) :], proto])
            help = "no ROS message holds itself: name the field under `ignore` of its row"
            self.report(CANNOT_CONVERT.at(field.span, f"{field.name} makes a recursive message: {cycle}", help))
            return None
        if proto.startswith("google.protobuf."):
            help = "name the field under `ignore` of its row, or carry the value in fields of your own"
            self.report(CANNOT_CONVERT.at(field.span, f"{field.name} is a {proto}, which has no conversion yet", help))
            return None
        return self._conversion(self.schema.messages[proto]).ros

    def enum_message(self, enum: ProtoEnum) -> EnumSettings | None:
        """The table's settings of an enum that is a message of its own; that message is made."""
        settings = self._enum_settings.get(enum.full_name)
        if settings is not None and enum.full_name not in self.enums_used:
            self._make_enum_message(enum, settings)
        self.enums_used.add(enum.full_name)
        return settings

    def _make_enum_message(self, enum: ProtoEnum, settings: EnumSettings) -> None:
        self._claim(settings.ros, enum.full_name, settings.at("ros"))
        if why := unusable(settings.field):
            message = f"{settings.field!r} cannot be a field of a ROS message: {why}"
            self.report(FIELD_NAME_FORBIDDEN.at(settings.at("field"), message))
        self.messages[settings.ros] = ir.RosMessage(
            settings.ros,
            (ir.RosField(settings.field, ir.RosType(ros_enums.integer_type(enum)), "", enum.full_name),),
            tuple(ros_enums.constants(enum, "", self.report)),
            enum.comment,
            enum.full_name,
        )
