"""Changes of a draft for ROS 2: renames messages and fields, and leaves out fields that cannot be converted.

Every row is compiled once, as `roverlink generate` does it. The diagnostics show which fields have to be changed.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

from roverlink.generator.adopt.draft import Draft, DraftRow
from roverlink.generator.adopt.table_text import text_of
from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.ir import ros_names
from roverlink.generator.protos.schema import ProtoField, Schema
from roverlink.generator.resolve.conversion_rules import FieldNameForbidden, FieldNameTaken
from roverlink.generator.resolve.messages import RosMessages
from roverlink.generator.table import reader


def fit(draft: Draft, schema: Schema, table: str) -> None:
    """Change the draft's rows so that ROS 2 allows all names, and fields that cannot be converted are ignored.

    The reason for an ignored field is the message of the diagnostic about it. ``table`` is the file name of the draft
    in diagnostics. A mistake that concerns a whole payload is not repaired; generate reports it.
    """
    _name_messages(draft.rows, schema)
    findings: list[Diagnostic] = []
    parsed = reader.parse(text_of(draft), table, [])
    messages = RosMessages(parsed, schema, findings)
    for row in parsed.rows:
        messages.conversion(row)
    declared = _declarations(schema)
    for finding in findings:
        if finding.severity.rank <= Severity.ERROR.rank and finding.span in declared:
            _fit(draft.rows, *declared[finding.span], finding, schema)


def _name_messages(rows: list[DraftRow], schema: Schema) -> None:
    """Set for each payload a ROS message name that ROS allows and that no other message has."""
    # Nested messages keep the names that generate gives them, so these are taken before any payload's name is chosen.
    protos = {row.proto: row.name for row in rows}
    nested = schema.reachable(*protos)[0] - protos.keys()
    taken = {
        ros_names.message_name(name, schema.packages[schema.messages[name].file])
        for name in nested
        if not name.startswith("google.protobuf.")
    }
    names: dict[str, str] = {}
    for proto, member in protos.items():
        last = proto.rpartition(".")[2]
        camel = [ros_names.camel_case(re.sub(r"\W", "_", name)) for name in (last, proto, f"{member}_message")]
        free = [name for name in (last, *camel) if ros_names.is_message_name(name) and name not in taken]
        names[proto] = next(iter(free), last)
        taken.add(names[proto])
    for row in rows:
        name = names[row.proto]
        row.ros = name if name != row.proto.rpartition(".")[2] else ""


def _declarations(schema: Schema) -> Mapping[Span, tuple[str, ProtoField | None]]:
    """Return, by place, the full name of the message or enum that is declared there.

    At the place of a field, this is the message that contains the field, and the second value is the field.
    """
    found: dict[Span, tuple[str, ProtoField | None]] = {enum.span: (name, None) for name, enum in schema.enums.items()}
    for message in schema.messages.values():
        found[message.span] = message.full_name, None
        found |= {field.span: (message.full_name, field) for field in message.fields}
    return {span: setting for span, setting in found.items() if span.line}


def _fit(rows: list[DraftRow], type: str, field: ProtoField | None, finding: Diagnostic, schema: Schema) -> None:
    """Change the rows so that a diagnostic does not appear again.

    ``type`` and ``field`` are the declaration at the place of the diagnostic. If the field belongs to a payload, the
    field is renamed or ignored. If the type is inside payloads, their fields that contain the type are ignored.
    """
    payloads = {row.proto for row in rows}
    for row in rows:
        own = schema.messages[row.proto].fields
        if row.proto == type and field is not None:
            if finding.rule in (FieldNameForbidden, FieldNameTaken):
                row.fields[field.name] = _free_name(field, own)
            else:
                row.ignore[field.name] = finding.message
        elif type not in payloads:
            inside = (field.name for field in own if type in _inside(field.type_name, schema, payloads))
            row.ignore.update((name, finding.message) for name in inside if name not in row.ignore)


def _free_name(field: ProtoField, fields: Collection[ProtoField]) -> str:
    taken = {ros_names.field_name(field.name) for field in fields}
    name = f"{ros_names.field_name(field.name)}_field"
    return name if name not in taken else f"field_{field.number}"


def _inside(type: str, schema: Schema, payloads: Collection[str]) -> set[str]:
    """Return a type, and all messages and enums inside it.

    The search does not look into payloads, because they have rows of their own.
    """
    found: set[str] = set()
    waiting = [type]
    while waiting:
        name = waiting.pop()
        if name not in found and name in schema.messages and name not in payloads:
            waiting += [field.type_name for field in schema.messages[name].fields]
        found.add(name)
    return found
