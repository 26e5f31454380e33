"""The second phase: the table and the proto descriptors to the IR.

What the table or a proto asks for, and this version cannot convert, is a finding; no field is dropped in silence.
"""

from __future__ import annotations

import dataclasses
import itertools
import keyword
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath

from generator import ir, naming
from generator.findings import Finding, Rule, Severity, Span, nearest
from generator.protos import DeclarationIndex, ProtoEnum, ProtoField, ProtoMessage, Schema
from generator.table import EnumSettings, Row, Table

UNKNOWN_PROTO = Rule("PRO103", "unknown-proto-message")
EXCLUDED_PROTO = Rule("PRO104", "excluded-proto-message")
AMBIGUOUS_PROTO = Rule("PRO105", "ambiguous-proto-message")
CANNOT_CONVERT = Rule("CNV101", "cannot-convert")
UNMAPPED_FIELD = Rule("CNV102", "unmapped-field")
UNKNOWN_FIELD = Rule("CNV103", "unknown-field")
FIELD_NAME_FORBIDDEN = Rule("CNV104", "field-name-forbidden")
FIELD_NAME_TAKEN = Rule("CNV105", "field-name-taken")
MESSAGE_NAME_TAKEN = Rule("CNV106", "message-name-taken")
DISAGREEING_ROWS = Rule("CNV107", "rows-disagree-on-a-message")
CONSTANT_NAME = Rule("CNV108", "constant-name")
UNKNOWN_ENUM = Rule("CNV109", "unknown-enum")
EXTENSIONS = Rule("CNV110", "extensions-not-carried", Severity.WARNING)
CONTRADICTING_PATHS = Rule("CNV111", "contradicting-paths")
UNIMPORTABLE_PROTO = Rule("PRO106", "unimportable-proto-path")
PAYLOAD_IN_ENVELOPE_FILE = Rule("PRO109", "payload-in-envelope-file")

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
_INTEGERS = (("uint8", 0, 2**8), ("uint16", 0, 2**16), ("uint32", 0, 2**32))
_SIGNED_INTEGERS = (("int8", -(2**7), 2**7), ("int16", -(2**15), 2**15), ("int32", -(2**31), 2**31))
_NEEDED_IN_CLASSES = frozenset({"bytes", "dataclasses", "list", "str"})


# --- which file has it ------------------------------------------------------------------------------------------


def locate(table: Table, index: DeclarationIndex, findings: list[Finding]) -> dict[str, str]:
    """The file of each message that a row names; a message that cannot be told is a finding."""
    files: dict[str, str] = {}
    for row in table.rows:
        declared = index.files.get(row.proto, [])
        if len(declared) != 1:
            findings.append(_not_located(row, declared, index))
        elif declared[0] == table.envelope.file and table.envelope.owner == "mapping":
            message = f"{row.proto} is declared in {declared[0]}, which is written from {table.file}"
            findings.append(PAYLOAD_IN_ENVELOPE_FILE.at(row.at("proto"), message, "move it to a file of its own"))
        else:
            files[row.proto] = declared[0]
    return files


def _not_located(row: Row, declared: list[str], index: DeclarationIndex) -> Finding:
    span = row.at("proto")
    if declared:
        help = "name all but one of them under proto.exclude"
        return AMBIGUOUS_PROTO.at(span, f"{row.proto} is declared in {' and in '.join(declared)}", help)
    if row.proto in index.excluded:
        file = index.excluded[row.proto][0]
        return EXCLUDED_PROTO.at(span, f"{row.proto} is declared in {file}, which proto.exclude leaves out")
    help = nearest(row.proto, index.files, "is its file below proto.root?")
    return UNKNOWN_PROTO.at(span, f"no .proto file declares a message {row.proto}", help)


def resolve_envelope(table: Table, files: Mapping[str, str]) -> ir.Envelope:
    """The envelope, with a member for every row whose message was located."""
    members = [ir.Member(row.number, row.name, row.proto, files[row.proto]) for row in table.rows if row.proto in files]
    return ir.Envelope(
        file=table.envelope.file,
        message=table.envelope.message,
        oneof=table.envelope.oneof,
        ours=table.envelope.owner == "mapping",
        members=tuple(sorted(members, key=lambda member: member.number)),
        retired=tuple(
            ir.Retired(row.number, row.name, row.proto) for row in sorted(table.retired, key=lambda row: row.number)
        ),
    )


# --- the whole --------------------------------------------------------------------------------------------------


def resolve(table: Table, schema: Schema, envelope: ir.Envelope, findings: list[Finding]) -> ir.Bridge:
    """The IR of a table. Where findings were added, it is not fit to be emitted."""
    resolver = _Resolver(table, schema, findings)
    located = [row for row in table.rows if row.proto in schema.messages]
    routes = tuple(resolver.route(row) for row in sorted(located, key=lambda row: row.number))
    rows = {row.proto for row in table.rows}
    resolver.check_enums()
    findings += _unimportable(table, schema)
    findings += _excluded(table, schema)
    messages, enums = _reachable(schema, envelope.message)
    return ir.Bridge(
        table=table.file,
        package=table.package,
        envelope=envelope,
        peers=tuple(
            ir.Peer(peer.name, peer.parameter, peer.port, peer.strip_trailing_zeros)
            for peer in sorted(table.peers, key=lambda peer: peer.name)
        ),
        routes=routes,
        messages=tuple(sorted(resolver.messages.values(), key=lambda message: message.name)),
        nested=tuple(conversion for proto, conversion in sorted(resolver.conversions.items()) if proto not in rows),
        wire_messages=tuple(_wire_message(schema.messages[name]) for name in sorted(messages)),
        wire_enums=tuple(_wire_enum(schema.enums[name]) for name in sorted(enums)),
        modules=schema.modules,
    )


def _unimportable(table: Table, schema: Schema) -> Iterator[Finding]:
    """Files whose Python modules could not be imported by name."""
    for file in schema.files:
        parts = file.removesuffix(".proto").split("/")
        if bad := [part for part in parts if not part.isidentifier() or keyword.iskeyword(part)]:
            span = Span(f"{table.proto.root}/{file}")
            yield UNIMPORTABLE_PROTO.at(span, f"{bad[0]!r} in its path cannot be a Python module", "rename it")


def _excluded(table: Table, schema: Schema) -> Iterator[Finding]:
    """Files that the table leaves out, and that what it needs imports all the same."""
    for path in table.proto.exclude:
        if str(PurePosixPath(path)) in schema.files:
            span = table.proto.at(f"exclude.{path}")
            yield EXCLUDED_PROTO.at(span, f"{path} is left out, but what the rows name imports it")


def _reachable(schema: Schema, root: str) -> tuple[set[str], set[str]]:
    """The messages and the enums that can travel inside a message, itself included."""
    messages: set[str] = set()
    enums: set[str] = set()
    waiting = [root]
    while waiting:
        name = waiting.pop()
        if name in schema.enums:
            enums.add(name)
        elif name not in messages:
            messages.add(name)
            waiting += [field.type_name for field in schema.messages[name].fields if field.type_name]
    return messages, enums


def _wire_message(message: ProtoMessage) -> ir.WireMessage:
    return ir.WireMessage(
        message.full_name,
        tuple(
            f"{field.number} {field.name} {'repeated ' if field.repeated else ''}{field.wire_type}"
            for field in sorted(message.fields, key=lambda field: field.number)
        ),
        (
            *(str(first) if first == last else f"{first} to {last}" for first, last in sorted(message.reserved)),
            *sorted(message.reserved_names),
        ),
    )


def _wire_enum(enum: ProtoEnum) -> ir.WireEnum:
    return ir.WireEnum(
        enum.full_name, tuple(f"{value.number} {value.name}" for value in sorted(enum.values, key=lambda v: v.number))
    )


@dataclass(slots=True)
class _Shape:
    """What a row says of the ROS message that its proto becomes."""

    ros: str
    fields: Mapping[str, str] = dataclasses.field(default_factory=dict)
    ignore: tuple[str, ...] = ()
    row: Row | None = None

    def at(self, group: str, path: str, otherwise: Span) -> Span:
        return self.row.spans.get(f"{group}.{path}", otherwise) if self.row else otherwise


class _Resolver:
    """Makes ROS messages and conversions, each once, from the protos that the rows reach."""

    def __init__(self, table: Table, schema: Schema, findings: list[Finding]) -> None:
        self._table, self._schema, self._findings = table, schema, findings
        self._enum_settings = {enum.proto: enum for enum in table.enums}
        self._shapes = self._row_shapes()
        self._names: dict[str, tuple[str, str]] = {}
        self._in_progress: list[str] = []
        self.messages: dict[str, ir.RosMessage] = {}
        self.conversions: dict[str, ir.Conversion] = {}
        self.enums_used: set[str] = set()

    def _row_shapes(self) -> dict[str, _Shape]:
        """By proto message; rows that carry the same one must agree on what it becomes."""
        shapes: dict[str, _Shape] = {}
        for row in self._table.rows:
            shape = _Shape(row.ros, row.fields, row.ignore, row)
            first = shapes.setdefault(row.proto, shape)
            if (first.ros, first.fields, first.ignore) != (shape.ros, shape.fields, shape.ignore):
                message = f"{row.proto} becomes {row.ros} here, and something else in another row"
                also = [(first.row.span, f"the row {first.row.name}")] if first.row else []
                help = "give both rows the same ros, fields and ignore"
                self._report(DISAGREEING_ROWS.at(row.at("proto"), message, help, also))
        return shapes

    def _report(self, finding: Finding) -> None:
        self._findings.append(finding)

    def route(self, row: Row) -> ir.Route:
        """A row, with the conversion of its payload."""
        qos = ir.Qos(row.qos.reliability, row.qos.durability, row.qos.history, row.qos.depth)
        conversion = self._conversion(self._schema.messages[row.proto])
        return ir.Route(row.number, row.name, row.topic, row.direction, qos, row.forward, conversion)

    def check_enums(self) -> None:
        """An enum that the table names, but no payload has, is a mistake."""
        for settings in self._table.enums:
            if settings.proto not in self.enums_used:
                help = nearest(settings.proto, self.enums_used, "remove it, or correct its name")
                self._report(UNKNOWN_ENUM.at(settings.span, f"no payload has the enum {settings.proto}", help))

    # --- messages ---

    def _conversion(self, message: ProtoMessage) -> ir.Conversion:
        proto = message.full_name
        if proto in self.conversions:
            return self.conversions[proto]
        package = self._package_of(message)
        shape = self._shapes.get(proto) or _Shape(naming.message_name(proto, package))
        self._claim(shape.ros, proto, shape.row.ros_span if shape.row else message.span)
        if any(keyword.iskeyword(part) for part in proto.split(".")):
            self._report(CANNOT_CONVERT.at(message.span, f"{proto} {_BY_KEYWORD}", "rename it: no wire has its name"))
        if message.extendable:
            self._report(EXTENSIONS.at(message.span, f"extensions of {proto} are not carried: no ROS field takes them"))
        self._in_progress.append(proto)
        builder = _MessageBuilder(self, message, shape)
        builder.add_fields(message, ())
        builder.check_paths()
        self._in_progress.pop()
        self.messages[shape.ros] = builder.message()
        self.conversions[proto] = ir.Conversion(proto, package, message.file, shape.ros, tuple(builder.conversions))
        return self.conversions[proto]

    def _package_of(self, message: ProtoMessage) -> str:
        """The proto package: what is left of the full name without the nesting messages."""
        outer = message.full_name.rpartition(".")[0]
        while outer in self._schema.messages:
            outer = outer.rpartition(".")[0]
        return outer

    def _claim(self, ros: str, source: str, span: Span) -> None:
        """Two sources must not become ROS messages of one name, nor of two whose files have one name."""
        if not naming.is_message_name(ros) and source not in self._shapes:  # a row's own name has a rule of its own
            self._report(
                CANNOT_CONVERT.at(span, f"{source} cannot become the ROS message {ros!r}: ROS forbids the name")
            )
        taken, holder = self._names.setdefault(naming.snake_case(ros), (ros, source))
        if holder != source:
            why = (
                f"which {holder} is already" if taken == ros else f"which is too much like {taken}, made from {holder}"
            )
            help = "give one of them another `ros`"
            self._report(MESSAGE_NAME_TAKEN.at(span, f"{source} would become {ros}, {why}", help))

    def nested_type(self, field: ProtoField) -> str | None:
        """The ROS message of a message field; None, with a finding, where it cannot be one."""
        proto = field.type_name
        if proto in self._in_progress:
            cycle = " -> ".join([*self._in_progress[self._in_progress.index(proto) :], proto])
            help = "no ROS message holds itself: name the field under `ignore` of its row"
            self._report(CANNOT_CONVERT.at(field.span, f"{field.name} makes a recursive message: {cycle}", help))
            return None
        if proto.startswith("google.protobuf."):
            help = "name the field under `ignore` of its row, or carry the value in fields of your own"
            self._report(CANNOT_CONVERT.at(field.span, f"{field.name} is a {proto}, which has no conversion yet", help))
            return None
        return self._conversion(self._schema.messages[proto]).ros

    def enum_message(self, enum: ProtoEnum) -> EnumSettings | None:
        """The table's settings of an enum that is a message of its own; that message is made."""
        settings = self._enum_settings.get(enum.full_name)
        if settings is not None and enum.full_name not in self.enums_used:
            self._make_enum_message(enum, settings)
        self.enums_used.add(enum.full_name)
        return settings

    def _make_enum_message(self, enum: ProtoEnum, settings: EnumSettings) -> None:
        self._claim(settings.ros, enum.full_name, settings.at("ros"))
        if why := _unusable(settings.field):
            message = f"{settings.field!r} cannot be a field of a ROS message: {why}"
            self._report(FIELD_NAME_FORBIDDEN.at(settings.at("field"), message))
        self.messages[settings.ros] = ir.RosMessage(
            settings.ros,
            (ir.RosField(settings.field, ir.RosType(self.enum_type(enum)), ""),),
            tuple(self.constants(enum, "")),
            enum.comment,
            enum.full_name,
        )

    def enum_type(self, enum: ProtoEnum) -> str:
        """The smallest ROS integer that holds every declared value; signed only where one is negative."""
        numbers = [value.number for value in enum.values]
        for name, low, end in _SIGNED_INTEGERS if min(numbers) < 0 else _INTEGERS:
            if low <= min(numbers) and max(numbers) < end:
                return name
        raise AssertionError("an enum value is an int32")

    def constants(self, enum: ProtoEnum, prefix: str) -> Iterator[ir.RosConstant]:
        """An enum's values as constants of a ROS message."""
        type = self.enum_type(enum)
        for value in enum.values:
            name = prefix + value.name
            if not naming.is_constant_name(name):
                message = f"{enum.full_name}.{value.name} cannot be a constant: ROS wants capitals, digits and single _"
                self._report(CONSTANT_NAME.at(enum.span, message, "rename it: no wire has its name"))
            yield ir.RosConstant(name, type, value.number, value.comment)

    @property
    def schema(self) -> Schema:
        """The compiled protos."""
        return self._schema

    def report(self, finding: Finding) -> None:
        """Add a finding."""
        self._report(finding)


_BY_KEYWORD = "is named by a keyword of Python, so that generated code cannot reach it"


def _unusable(name: str) -> str:
    """Why a ROS field cannot have a name; empty where it can."""
    if keyword.iskeyword(name):
        return "it is a keyword of Python"
    if name in _NEEDED_IN_CLASSES:
        return "the generated class needs Python's own"
    return "" if naming.is_field_name(name) else "lower case, digits, single underscores"


class _MessageBuilder:
    """The fields, constants and conversions of one ROS message, from one proto message."""

    def __init__(self, resolver: _Resolver, message: ProtoMessage, shape: _Shape) -> None:
        self._resolver, self._message, self._shape = resolver, message, shape
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
                self._resolver.report(
                    UNMAPPED_FIELD.at(field.span, f"no ROS field of {self._shape.ros} takes {dotted}", help)
                )
            elif self._is_convertible(message, field, dotted):
                self._convert(field, full_path, self._shape.fields.get(dotted, field.name))

    def _taken_apart(self, dotted: str) -> bool:
        """Whether the table names fields inside this one."""
        return any(path.startswith(f"{dotted}.") for path in (*self._shape.fields, *self._shape.ignore))

    def _take_apart(self, field: ProtoField, path: tuple[str, ...]) -> None:
        """Fields of a nested message become fields of this one."""
        nested = self._resolver.schema.messages.get(field.type_name)
        if field.optional:
            message = f"{'.'.join(path)} is optional; taken apart, nothing would say whether it is set"
            self._resolver.report(CANNOT_CONVERT.at(field.span, message, "let it be a message of its own"))
        if nested is None or field.repeated or field.oneof:
            self._report_paths_into(".".join(path), field)
        else:
            self.add_fields(nested, path)

    def _report_paths_into(self, dotted: str, field: ProtoField) -> None:
        """Report the table's paths into a field that has no fields of its own."""
        for group, paths in (("fields", self._shape.fields), ("ignore", self._shape.ignore)):
            for path in paths:
                if path.startswith(f"{dotted}."):
                    self._paths_seen.add(path)
                    message = f"{dotted} is no single message, so that no field in it can be named"
                    self._resolver.report(UNKNOWN_FIELD.at(self._shape.at(group, path, field.span), message))

    def check_paths(self) -> None:
        """Every path that the row names must lead to a field, and none must say otherwise than another."""
        row = self._shape.row
        if row is None:
            return
        for group, paths in (("fields", self._shape.fields), ("ignore", self._shape.ignore)):
            for path in paths:
                span = self._shape.at(group, path, row.span)
                if contradiction := self._contradiction(group, path):
                    self._resolver.report(CONTRADICTING_PATHS.at(span, contradiction, "keep one of them"))
                elif path not in self._paths_seen:
                    help = nearest(path, self._paths_seen)
                    message = f"{self._message.full_name} has no field {path!r}"
                    self._resolver.report(UNKNOWN_FIELD.at(span, message, help))

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
            self._resolver.report(CANNOT_CONVERT.at(field.span, f"{dotted} {reason}", help))
        return not reason

    def _obstacle(self, field: ProtoField) -> str:
        """Why this version cannot convert a field; empty where it can."""
        nested = self._resolver.schema.messages.get(field.type_name)
        if nested is not None and nested.map_entry:
            return "is a map, which has no conversion yet"
        if field.oneof:
            return f"stands in the oneof {field.oneof}, which has no conversion yet"
        if field.type == "group":
            return "is a group, which has no conversion"
        if field.type == "bytes" and field.repeated:
            return "is a repeated bytes field, and ROS has no sequence of sequences"
        if keyword.iskeyword(field.name):
            return _BY_KEYWORD
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
            nested = self._resolver.nested_type(field)
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
        enum = self._resolver.schema.enums[field.type_name]
        settings = self._resolver.enum_message(enum)
        if settings is not None:
            ros = ir.RosField(name, ir.RosType(settings.ros, True, field.repeated), field.comment)
            return ir.FieldConversion(path, ros, ir.ConversionKind.ENUM_MESSAGE, field.repeated, member=settings.field)
        self._enums[enum.full_name] = enum
        ros = ir.RosField(name, ir.RosType(self._resolver.enum_type(enum), is_sequence=field.repeated), field.comment)
        return ir.FieldConversion(path, ros, ir.ConversionKind.VALUE, field.repeated)

    def _add(self, conversion: ir.FieldConversion, field: ProtoField) -> None:
        name = conversion.ros.name
        span = self._shape.at("fields", ".".join(conversion.proto_path), field.span)
        if why := _unusable(name):
            dotted = ".".join(conversion.proto_path)
            help = f"give it another name under `fields` of its row ({dotted}: other_name)"
            if self._shape.row is None:
                help = "rename it in the .proto: no wire has its name"
            self._resolver.report(
                FIELD_NAME_FORBIDDEN.at(span, f"{name!r} cannot be a field of a ROS message: {why}", help)
            )
        if name in self._fields:
            help = "give one of them another name under `fields` of its row"
            self._resolver.report(FIELD_NAME_TAKEN.at(span, f"{self._shape.ros} has a field {name} already", help))
        self._fields[name] = conversion.ros
        self.conversions.append(conversion)

    def _constants(self) -> Iterator[ir.RosConstant]:
        """The values of the message's enums; where two enums share a name, each gets its enum's name before it."""
        names = [value.name for enum in self._enums.values() for value in enum.values]
        seen: dict[str, str] = {}
        for enum in self._enums.values():
            shared = any(names.count(value.name) > 1 for value in enum.values)
            prefix = f"{naming.snake_case(enum.full_name.rpartition('.')[2]).upper()}_" if shared else ""
            for constant in self._resolver.constants(enum, prefix):
                holder = seen.setdefault(constant.name, enum.full_name)
                if holder != enum.full_name:
                    message = f"{self._shape.ros} would have {constant.name} twice, of {holder} and of {enum.full_name}"
                    self._resolver.report(
                        CONSTANT_NAME.at(enum.span, message, "give one of the enums a message of its own")
                    )
                yield constant
