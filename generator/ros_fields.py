"""One proto message to one ROS message: which field becomes which, and by which conversion."""

from __future__ import annotations

import dataclasses
import itertools
import keyword
from collections.abc import Iterator
from typing import TYPE_CHECKING

from generator import ir, naming, ros_enums
from generator.findings import Rule, nearest
from generator.protos import ProtoEnum, ProtoField, ProtoMessage
from generator.shape import Shape

if TYPE_CHECKING:
    from generator.ros_messages import RosMessages

CANNOT_CONVERT = Rule("CNV101", "cannot-convert")
UNMAPPED_FIELD = Rule("CNV102", "unmapped-field")
UNKNOWN_FIELD = Rule("CNV103", "unknown-field")
FIELD_NAME_FORBIDDEN = Rule("CNV104", "field-name-forbidden")
FIELD_NAME_TAKEN = Rule("CNV105", "field-name-taken")
CONTRADICTING_PATHS = Rule("CNV111", "contradicting-paths")

BY_KEYWORD = "is named by a keyword of Python, so that generated code cannot reach it"
_RENAME = "rename it in the .proto: no wire has its name"
_SCALARS = {
    "double": "float64",
    "float": "float32",
    "int32": "int32",
    "sint32": "int32",
    "sfixed32": "int32",
    "int64": "int64",
    "sint64": "int64",
    "sfixed64": "int64",
    "uint32": "uint32",
    "fixed32": "uint32",
    "uint64": "uint64",
    "fixed64": "uint64",
    "bool": "bool",
    "string": "string",
}
_NEEDED_IN_CLASSES = frozenset({"bytes", "dataclasses", "list", "str"})


def unusable(name: str) -> str:
    """Why a ROS field cannot have a name; empty where it can."""
    if keyword.iskeyword(name):
        return "it is a keyword of Python"
    if name in _NEEDED_IN_CLASSES:
        return "the generated class needs Python's own"
    return "" if naming.is_field_name(name) else "lower case, digits, single underscores"


class MessageBuilder:
    """The fields, constants and conversions of one ROS message, from one proto message."""

    def __init__(self, messages: RosMessages, message: ProtoMessage, shape: Shape) -> None:
        self._messages, self._message, self._shape = messages, message, shape
        self._schema, self._report = messages.schema, messages.report
        self._fields: dict[str, ir.RosField] = {}
        self._enums: dict[str, ProtoEnum] = {}
        self._paths_seen: set[str] = set()
        self.conversions: list[ir.FieldConversion] = []

    def message(self) -> ir.RosMessage:
        """The ROS message."""
        return ir.RosMessage(
            self._shape.ros,
            tuple(self._fields.values()),
            tuple(self._constants()),
            self._message.comment,
            self._message.full_name,
        )

    def add_fields(self, message: ProtoMessage, path: tuple[str, ...]) -> None:
        """Convert the fields of a proto message; ``path`` leads to it from the payload."""
        for field in message.fields:
            full_path = (*path, field.name)
            dotted = ".".join(full_path)
            self._paths_seen.add(dotted)
            if dotted in self._shape.ignore:
                continue
            if self._taken_apart(dotted):
                self._take_apart(field, full_path)
            elif path and dotted not in self._shape.fields:
                help = f"give it a ROS field under `fields`, or name {dotted} under `ignore`"
                self._report(UNMAPPED_FIELD.at(field.span, f"no ROS field of {self._shape.ros} takes {dotted}", help))
            elif self._is_convertible(message, field, dotted):
                self._convert(field, full_path, self._shape.fields.get(dotted, field.name))

    def _taken_apart(self, dotted: str) -> bool:
        """Whether the table names fields inside this one."""
        return any(path.startswith(f"{dotted}.") for path in (*self._shape.fields, *self._shape.ignore))

    def _take_apart(self, field: ProtoField, path: tuple[str, ...]) -> None:
        """Fields of a nested message become fields of this one."""
        dotted, nested = ".".join(path), self._schema.messages.get(field.type_name)
        if keyword.iskeyword(field.name):
            self._report(CANNOT_CONVERT.at(field.span, f"{dotted} {BY_KEYWORD}", _RENAME))
        if field.optional:
            message = f"{dotted} is optional; taken apart, nothing would say whether it is set"
            self._report(CANNOT_CONVERT.at(field.span, message, "let it be a message of its own"))
        if nested is None or field.repeated or field.oneof:
            self._report_paths_into(dotted, field)
        else:
            self.add_fields(nested, path)

    def _report_paths_into(self, dotted: str, field: ProtoField) -> None:
        """Report the table's paths into a field that has no fields of its own."""
        for group, paths in (("fields", self._shape.fields), ("ignore", self._shape.ignore)):
            for path in paths:
                if path.startswith(f"{dotted}."):
                    self._paths_seen.add(path)
                    message = f"{dotted} is no single message, so that no field in it can be named"
                    self._report(UNKNOWN_FIELD.at(self._shape.at(group, path, field.span), message))

    def check_paths(self) -> None:
        """Every path that the row names must lead to a field, and none must say otherwise than another."""
        row = self._shape.row
        if row is None:
            return
        for group, paths in (("fields", self._shape.fields), ("ignore", self._shape.ignore)):
            for path in paths:
                span = self._shape.at(group, path, row.span)
                if contradiction := self._contradiction(group, path):
                    self._report(CONTRADICTING_PATHS.at(span, contradiction, "keep one of them"))
                elif path not in self._paths_seen:
                    help = nearest(path, self._paths_seen)
                    message = f"{self._message.full_name} has no field {path!r}"
                    self._report(UNKNOWN_FIELD.at(span, message, help))

    def _contradiction(self, group: str, path: str) -> str:
        """What else the row says of a path, or of the field that it leads into; empty for nothing."""
        fields, ignore = self._shape.fields, self._shape.ignore
        if group == "ignore" and path in fields:
            return f"{path} is renamed to {fields[path]}, and ignored"
        for whole in itertools.accumulate(path.split(".")[:-1], "{}.{}".format):
            if whole in ignore:
                return f"{path} is named, and {whole} is ignored as a whole"
            if whole in fields:
                return f"{path} is named, and {whole} is renamed to {fields[whole]} as a whole"
        return ""

    def _is_convertible(self, message: ProtoMessage, field: ProtoField, dotted: str) -> bool:
        reason = self._obstacle(field)
        if reason:
            help = f"name {dotted} under `ignore` of its row"
            if self._shape.row is None:
                help = f"name the field that holds {message.full_name} under `ignore` of its row"
            self._report(CANNOT_CONVERT.at(field.span, f"{dotted} {reason}", help))
        return not reason

    def _obstacle(self, field: ProtoField) -> str:
        """Why this version cannot convert a field; empty where it can."""
        nested = self._schema.messages.get(field.type_name)
        if nested is not None and nested.map_entry:
            return "is a map, which has no conversion yet"
        if field.oneof:
            return f"stands in the oneof {field.oneof}, which has no conversion yet"
        if field.type == "group":
            return "is a group, which has no conversion"
        if field.type == "bytes" and field.repeated:
            return "is a repeated bytes field, and ROS has no sequence of sequences"
        if keyword.iskeyword(field.name):
            return BY_KEYWORD
        return ""

    def _convert(self, field: ProtoField, path: tuple[str, ...], name: str) -> None:
        conversion = self._field_conversion(field, path, name)
        if conversion is None:
            return
        if field.optional and not field.repeated:
            presence = ir.RosField(f"has_{name}", ir.RosType("bool"), f"Whether {name} is set.")
            self._add(ir.FieldConversion(path, presence, ir.ConversionKind.PRESENCE), field)
            conversion = dataclasses.replace(conversion, guarded=True)
        self._add(conversion, field)

    def _field_conversion(self, field: ProtoField, path: tuple[str, ...], name: str) -> ir.FieldConversion | None:
        if field.type == "message":
            nested = self._messages.nested_type(field)
            if nested is None:
                return None
            ros = ir.RosField(name, ir.RosType(nested, True, field.repeated), field.comment)
            return ir.FieldConversion(path, ros, ir.ConversionKind.MESSAGE, field.repeated, proto=field.type_name)
        if field.type == "enum":
            return self._enum_conversion(field, path, name)
        if field.type == "bytes":
            ros = ir.RosField(name, ir.RosType("uint8", is_sequence=True), field.comment)
            return ir.FieldConversion(path, ros, ir.ConversionKind.VALUE)
        ros = ir.RosField(name, ir.RosType(_SCALARS[field.type], is_sequence=field.repeated), field.comment)
        return ir.FieldConversion(path, ros, ir.ConversionKind.VALUE, field.repeated)

    def _enum_conversion(self, field: ProtoField, path: tuple[str, ...], name: str) -> ir.FieldConversion:
        enum = self._schema.enums[field.type_name]
        settings = self._messages.enum_message(enum)
        if settings is not None:
            ros = ir.RosField(name, ir.RosType(settings.ros, True, field.repeated), field.comment)
            return ir.FieldConversion(path, ros, ir.ConversionKind.ENUM_MESSAGE, field.repeated, member=settings.field)
        self._enums[enum.full_name] = enum
        type = ir.RosType(ros_enums.integer_type(enum), is_sequence=field.repeated)
        ros = ir.RosField(name, type, field.comment, enum.full_name)
        return ir.FieldConversion(path, ros, ir.ConversionKind.VALUE, field.repeated)

    def _add(self, conversion: ir.FieldConversion, field: ProtoField) -> None:
        name = conversion.ros.name
        span = self._shape.at("fields", ".".join(conversion.proto_path), field.span)
        if why := unusable(name):
            dotted = ".".join(conversion.proto_path)
            help = f"give it another name under `fields` of its row ({dotted}: other_name)"
            if self._shape.row is None:
                help = _RENAME
            self._report(FIELD_NAME_FORBIDDEN.at(span, f"{name!r} cannot be a field of a ROS message: {why}", help))
        if name in self._fields:
            help = "give one of them another name under `fields` of its row"
            self._report(FIELD_NAME_TAKEN.at(span, f"{self._shape.ros} has a field {name} already", help))
        self._fields[name] = conversion.ros
        self.conversions.append(conversion)

    def _constants(self) -> Iterator[ir.RosConstant]:
        """The values of the message's enums; where two enums share a name, each gets its enum's name before it."""
        names = [value.name for enum in self._enums.values() for value in enum.values]
        seen: dict[str, str] = {}
        for enum in self._enums.values():
            shared = any(names.count(value.name) > 1 for value in enum.values)
            prefix = f"{naming.snake_case(enum.full_name.rpartition('.')[2]).upper()}_" if shared else ""
            for constant in ros_enums.constants(enum, prefix, self._report):
                holder = seen.setdefault(constant.name, enum.full_name)
                if holder != enum.full_name:
                    message = f"{self._shape.ros} would have {constant.name} twice, of {holder} and of {enum.full_name}"
                    self._report(
                        ros_enums.CONSTANT_NAME.at(enum.span, message, "give one of the enums a message of its own")
                    )
                yield constant
