"""What a draft can do about a finding: another name, a field left out, a rule that counts for less."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from generator import naming, read
from generator.adopt.draft import Draft, DraftRow
from generator.adopt.tree import Tree
from generator.diagnostics import Diagnostic, Severity, Span
from generator.protos import ProtoMessage, Schema
from generator.rules import modules

_FIELD_NAMES, _ROS_NAME = ("CNV104", "CNV105"), "ROS101"
_MUST_HOLD = frozenset({"ENV101", "ENV104", "ROS101", "TAB101", "TAB102", "TAB103", "TAB104"})
"""Rules without which what is generated would make no sense."""
_MANY_ROWS = 3


def cure(draft: Draft, tree: Tree, text: str, table: str, findings: Sequence[Diagnostic]) -> bool:
    """Change the draft so that it has fewer of the findings; whether anything was changed.

    ``text`` is what the draft was tried as, and ``table`` how findings call it.
    """
    grave = [finding for finding in findings if finding.severity.rank <= Severity.WARNING.rank]
    places = _places(draft, tree.schema)
    rows = _rows_by_span(draft, text, table)
    changed = False
    for finding in grave:
        if finding.rule.id.startswith("CNV") or finding.rule.id == _ROS_NAME:
            held = places.get(finding.span, [])
            named = [_Place(row, "", False) for row in rows.get(finding.span, [])]
            for place in [*held, *named]:
                changed |= _cure_row(place, finding, draft)
    lowered = [finding for finding in grave if finding.rule.id in modules() and finding.rule.id not in _MUST_HOLD]
    if not changed:
        changed = _lower(draft, lowered, tree.schema)
    return changed


@dataclass(frozen=True, slots=True)
class _Place:
    """What stands at a place of a .proto file, as a row sees it."""

    row: DraftRow
    field: str
    """The payload's field that it is, or is in; empty for the payload itself."""
    own: bool
    """Whether it is that field itself."""


def _places(draft: Draft, schema: Schema) -> Mapping[Span, list[_Place]]:
    """Where the messages, fields and enums of the rows stand."""
    found: defaultdict[Span, list[_Place]] = defaultdict(list)

    def add(message: ProtoMessage, row: DraftRow, top: str, seen: frozenset[str]) -> None:
        found[message.span].append(_Place(row, top, False))
        for field in message.fields:
            held = top or field.name
            found[field.span].append(_Place(row, held, not top))
            if field.type_name in schema.enums:
                found[schema.enums[field.type_name].span].append(_Place(row, held, False))
            elif field.type_name in schema.messages and field.type_name not in seen:
                add(schema.messages[field.type_name], row, held, seen | {field.type_name})

    for row in draft.rows:
        add(schema.messages[row.proto], row, "", frozenset({row.proto}))
    return found


def _rows_by_span(draft: Draft, text: str, table: str) -> Mapping[Span, list[DraftRow]]:
    """The rows by the places of their keys in the table."""
    by_number = {row.number: row for row in draft.rows}
    found: defaultdict[Span, list[DraftRow]] = defaultdict(list)
    for row in read.parse(text, table, []).rows:
        for span in {row.span, *row.spans.values()}:
            found[span].append(by_number[row.number])
    return found


def _cure_row(place: _Place, finding: Diagnostic, draft: Draft) -> bool:
    """Rename what can be renamed, leave out what cannot be converted; whether anything was changed."""
    row = place.row
    if not place.field:
        return finding.rule.id != "CNV110" and _rename_message(row, draft)
    if place.field in row.ignore:
        return False
    if finding.rule.id in _FIELD_NAMES and place.own and place.field not in row.fields:
        row.fields[place.field] = f"{naming.field_name(place.field)}_field"
        return True
    if finding.severity is Severity.WARNING:
        return False
    row.fields.pop(place.field, None)
    row.ignore[place.field] = finding.message
    return True


def _rename_message(row: DraftRow, draft: Draft) -> bool:
    """Give the row's message, and its other rows', a name of its own in ROS."""
    taken = {other.ros or other.proto.rpartition(".")[2] for other in draft.rows if other.proto != row.proto}
    plain = naming.camel_case(re.sub(r"\W", "_", row.proto.rpartition(".")[2]))
    full = naming.camel_case(re.sub(r"\W", "_", row.proto))
    for name in (plain, full, f"{naming.camel_case(row.name)}Message"):
        if name not in taken and naming.is_message_name(name) and name != (row.ros or row.proto.rpartition(".")[2]):
            for other in draft.rows:
                if other.proto == row.proto:
                    other.ros = name
            return True
    return False


def _lower(draft: Draft, findings: Sequence[Diagnostic], schema: Schema) -> bool:
    """Let what was found count for less: in the rows that it is about, or everywhere where those are many or none."""
    for rule, found in groupby(sorted(findings, key=lambda one: one.rule.id), key=lambda one: one.rule.id):
        listed = list(found)
        about = [_rows_about(finding, draft, schema) for finding in listed]
        rows = {id(row): row for of_one in about for row in of_one}
        if not all(about) or len(rows) > _MANY_ROWS or any(rule in row.lint for row in rows.values()):
            times = "once" if len(listed) == 1 else f"{len(listed)} times"
            draft.lint[rule] = f"the tree had it {times} when it was taken over"
        else:
            for row in rows.values():
                row.lint[rule] = "it was so when the tree was taken over"
    return bool(findings)


def _rows_about(finding: Diagnostic, draft: Draft, schema: Schema) -> list[DraftRow]:
    """The rows that a finding is about, as the table's own settings of a row are understood."""
    if finding.type in ("", draft.message):
        return [row for row in draft.rows if row.number == finding.number]
    return [row for row in draft.rows if any(finding.type in kind for kind in schema.reachable(row.proto))]
