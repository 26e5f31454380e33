"""Conversion of one proto message to one generated ROS message, field by field."""

from __future__ import annotations

import dataclasses
import itertools

from roverlink.generator import ir
from roverlink.generator.ir import ros_names
from roverlink.generator.ir.protobuf_facts import OWN_FILES
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, commented
from roverlink.generator.resolve import enums, oneofs, well_known
from roverlink.generator.resolve.conversion_rules import (
    CannotConvert,
    ContradictingPaths,
    FieldNameForbidden,
    FieldNameTaken,
    UnknownField,
    UnmappedField,
)
from roverlink.generator.resolve.message_shapes import Shape
from roverlink.generator.resolve.types import FieldTypes, MessageMaker
from roverlink.suggestions import nearest

_HIDING = frozenset({"HasField", "WhichOneof"})
"""Methods of Python's protobuf messages that generated code calls. A field with such a name would hide the method."""
_RENAME = "rename the field in the .proto file; the name is not sent, so the encoding does not change"


class MessageBuilder:
    """Builder of one generated ROS message: its fields, its constants, and the conversions of its fields."""

    def __init__(self, messages: MessageMaker, message: ProtoMessage, shape: Shape) -> None:
        self._messages, self._message, self._shape = messages, message, shape
        self._schema, self._report = messages.schema, messages.report
        self._types = FieldTypes(messages, shape.ros)
        self._fields: dict[str, ir.RosField] = {}
        self._paths_seen: set[str] = set()
        self._which: dict[tuple[str, ...], str] = {}
        self._oneof_constants: list[ir.RosConstant] = []
        self.conversions: list[ir.FieldConversion] = []

    def message(self) -> ir.RosMessage:
        """Return the ROS message with the fields that `add_fields` has added."""
        declared, ros = self._types.enums.values(), self._shape.ros
        return ir.RosMessage(
            ros,
            tuple(self._fields.values()),
            tuple(enums.constants_of(declared, self._oneof_constants, ros, self._message.span, self._report)),
            "" if self._message.file.startswith(OWN_FILES) else commented(self._message),
            self._message.full_name,
        )

    def add_fields(self, message: ProtoMessage, path: tuple[str, ...]) -> None:
        """Add a ROS field, and its conversion, for each field of a proto message.

        ``path`` has the names of the fields that lead from the builder's own proto message to ``message``. It is
        empty for the own message, and ``("accel",)`` for a nested message whose fields move into the outer ROS message.
        """
        for field in message.fields:
            full_path = (*path, field.name)
            dotted = ".".join(full_path)
            self._paths_seen.add(dotted)
            if dotted in self._shape.ignore:
                continue
            if field.name in _HIDING:
                self._report(
                    CannotConvert.at(
                        field.span, f"the field {dotted!r} would hide a method of Python's protobuf messages", _RENAME
                    )
                )
            if self._is_flattened(dotted):
                self._flatten(message, field, full_path)
            elif path and dotted not in self._shape.fields:
                help = f"give the field a ROS field under `fields`, or list {dotted!r} under `ignore`"
                self._report(
                    UnmappedField.at(
                        field.span,
                        f"the ROS message {self._shape.ros!r} has no field for the proto field {dotted!r}",
                        help,
                    )
                )
            else:
                self._convert(message, field, full_path)

    def _is_flattened(self, dotted: str) -> bool:
        """Return True if the row's `fields` or `ignore` has a path into a field: ``accel.x`` is a path into ``accel``.

        The fields of the nested message then move into the outer ROS message.
        """
        return any(path.startswith(f"{dotted}.") for path in (*self._shape.fields, *self._shape.ignore))

    def _flatten(self, message: ProtoMessage, field: ProtoField, path: tuple[str, ...]) -> None:
        """Add ROS fields for the fields of a nested message, instead of one ROS field for the whole nested message."""
        dotted, nested = ".".join(path), self._schema.messages.get(field.type_name)
        if self._keeps_presence(message, field):
            fault = (
                f"{dotted!r} is optional; if its fields are moved out of it, subscribers cannot see whether it was set"
            )
            help = f"keep the field as a nested message, or set `presence: {{{dotted}: false}}` if absent means zero"
            self._report(CannotConvert.at(field.span, fault, help))
        if nested is None or field.repeated or field.oneof:
            self._report_paths_into(dotted, field)
        else:
            self.add_fields(nested, path)

    def _report_paths_into(self, dotted: str, field: ProtoField) -> None:
        """Report the row's paths that lead into a field which is not a single message, such as a list or a number."""
        for group, paths in (("fields", self._shape.fields), ("ignore", self._shape.ignore)):
            for path in paths:
                if path.startswith(f"{dotted}."):
                    self._paths_seen.add(path)
                    message = f"the field {dotted!r} is not a single message, so a path cannot lead into it"
                    self._report(UnknownField.at(self._shape.at(group, path, field.span), message, f"write {dotted!r}"))

    def check_paths(self) -> None:
        """Report paths under the row's `fields` and `ignore` that lead to no field or contradict another path."""
        row = self._shape.row
        if row is None:
            return
        for group, paths in (("fields", self._shape.fields), ("ignore", self._shape.ignore)):
            for path in paths:
                span = self._shape.at(group, path, row.span)
                if contradiction := self._contradiction(group, path):
                    self._report(ContradictingPaths.at(span, contradiction, "keep only one of the two settings"))
                elif path not in self._paths_seen:
                    known = ", ".join(sorted(self._paths_seen)) or "none"
                    help = nearest(path, self._paths_seen, f"known fields: {known}")
                    message = f"the proto message {self._message.full_name!r} has no field {path!r}"
                    self._report(UnknownField.at(span, message, help))

    def _contradiction(self, group: str, path: str) -> str:
        """Return a message about a setting of the row that contradicts the setting of a path; empty if there is none.

        ``group`` is the key that contains the path: ``fields`` or ``ignore``.
        """
        fields, ignore = self._shape.fields, self._shape.ignore
        if group == "ignore" and path in fields:
            return f"the field {path!r} is renamed to {fields[path]!r}, and also ignored"
        for whole in itertools.accumulate(path.split(".")[:-1], "{}.{}".format):
            if whole in ignore:
                return f"{path!r} has a setting, but {whole!r} and all its fields are ignored"
            if whole in fields:
                return f"{path!r} has a setting, but all of {whole!r} becomes one ROS field, {fields[whole]!r}"
        return ""

    def _convert(self, message: ProtoMessage, field: ProtoField, path: tuple[str, ...]) -> None:
        name = self._shape.fields.get(".".join(path)) or ros_names.field_name(field.name)
        conversion = self._types.conversion(message, field, path, name)
        if conversion is None:
            return
        if field.oneof:
            conversion = dataclasses.replace(conversion, which=self._discriminator(message, field, path[:-1]))
        elif self._keeps_presence(message, field) and name not in self._fields:
            presence = ir.RosField(f"has_{name}", ir.RosType("bool"), f"True if {name} is set.")
            self._add(ir.FieldConversion(path, presence, ir.ConversionKind.PRESENCE), field)
            conversion = dataclasses.replace(conversion, presence=presence.name)
        self._add(conversion, field)

    def _keeps_presence(self, message: ProtoMessage, field: ProtoField) -> bool:
        """Return True if the ROS message gets a field ``has_<field>``, which tells if the proto field is set."""
        if field.label != "optional" or field.oneof or field.type_name in (*well_known.TEXTS, well_known.EMPTY):
            return False
        setting = self._messages.settings.presence.get((message.full_name, field.name))
        return setting if setting is not None else field.optional or field.type_name in well_known.WRAPPERS

    def _discriminator(self, message: ProtoMessage, field: ProtoField, path: tuple[str, ...]) -> str:
        """Return the name of the ROS field that tells which member of a oneof is set, such as ``which_order``.

        ``field`` is a member of the oneof. The call for the first member adds the ROS field to the ROS message.
        """
        full_path = (*path, field.oneof)
        if full_path not in self._which:
            dotted = ".".join(full_path)
            self._paths_seen.add(dotted)
            members = [
                member for member in message.fields if member.oneof == field.oneof and self._placed(member, path)
            ]
            ros, constants, choices = oneofs.discriminator(
                message, field.oneof, members, self._shape.fields.get(dotted)
            )
            self._which[full_path] = ros.name
            self._oneof_constants += constants
            self._add(ir.FieldConversion(full_path, ros, ir.ConversionKind.WHICH, choices=choices), field)
        return self._which[full_path]

    def _placed(self, field: ProtoField, path: tuple[str, ...]) -> bool:
        """Return True if the ROS message gets a field for a member of a oneof."""
        dotted = ".".join((*path, field.name))
        return dotted not in self._shape.ignore and (not path or dotted in self._shape.fields)

    def _add(self, conversion: ir.FieldConversion, field: ProtoField) -> None:
        name = conversion.ros.name
        span = self._shape.at("fields", ".".join(conversion.proto_path), field.span)
        if why := ros_names.unusable(name):
            dotted = ".".join(conversion.proto_path)
            help = f"give the field another name under `fields` of the row ({dotted}: other_name)"
            if self._shape.row is None:
                help = _RENAME
            self._report(FieldNameForbidden.at(span, f"{name!r} cannot be a field of a ROS message: {why}", help))
        if name in self._fields:
            help = "give one of the two fields another name under `fields` of the row"
            if self._shape.row is None:
                help = f"rename one of them in the .proto file, or give {self._message.full_name!r} a row with `fields`"
            self._report(
                FieldNameTaken.at(span, f"the ROS message {self._shape.ros!r} already has a field {name!r}", help)
            )
        self._fields[name] = conversion.ros
        self.conversions.append(conversion)
