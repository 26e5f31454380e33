"""Types and extensions that are not where they were."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from generator.changes.pairing import extensions_by_number
from generator.diagnostics import Span
from generator.protos import ProtoEnum, ProtoExtension, ProtoField, ProtoMessage, Schema
from generator.subject import Change, Subject

_PROTOBUF = "google/protobuf/"


@dataclass(frozen=True, slots=True)
class Absence:
    """A message or an enum that its file does not declare any more."""

    old: ProtoMessage | ProtoEnum
    new: ProtoMessage | ProtoEnum | None
    """What has its full name, in another file; None where nothing has."""
    span: Span
    """Where it is missed: the message that it stood in, or else the file, or else where it was."""


def absent_types(subject: Subject, change: Change) -> Iterator[Absence]:
    """The outermost of the types that their files neither declare any more nor hand on.

    What protobuf itself comes with is left out: that nothing imports it any more is no fault.
    """
    if change.of_ledger:
        return
    before, after = _types(change.before), _types(change.after)
    absent = {name for name, old in before.items() if name not in after or after[name].file != old.file}
    for name in sorted(absent):
        old, new, scope = before[name], after.get(name), name.rpartition(".")[0]
        found = new is not None and change.after.hands_on(old.file, new.file)
        if _is_written(old) and not found and scope not in absent and not old.file.startswith(_PROTOBUF):
            yield Absence(old, new, _missed(subject, change, old.file, scope, old.span))


def absent_extensions(subject: Subject, change: Change) -> Iterator[tuple[ProtoExtension, ProtoExtension | None, Span]]:
    """The extensions whose number nothing has any more, or something in a file that the old one does not hand on.

    With that, and with where to say so.
    """
    if change.of_ledger:
        return
    after = extensions_by_number(change.after)
    for key, old in extensions_by_number(change.before).items():
        new = after.get(key)
        if new is None or not change.after.hands_on(old.file, new.file):
            yield old, new, _missed(subject, change, old.file, old.scope, old.field.span)


def heir(change: Change, old: ProtoMessage | ProtoEnum) -> str:
    """The full name of a new type with the very contents of one that is gone; empty for none."""
    contents, known = _contents(old), _types(change.before)
    fresh = {name: new for name, new in _types(change.after).items() if name not in known and _is_written(new)}
    found = [name for name, new in fresh.items() if _contents(new) == contents]
    return min(found, default="") if contents else ""


def _is_written(declared: ProtoMessage | ProtoEnum) -> bool:
    """Whether it is no map's entry, which nobody wrote."""
    return isinstance(declared, ProtoEnum) or not declared.map_entry


def _contents(of: ProtoMessage | ProtoEnum) -> set[tuple[int, str, str, str]]:
    if isinstance(of, ProtoEnum):
        return {(value.number, value.name, "enum", "") for value in of.values}
    return {(one.number, one.name, _type_inside(one, of), one.label) for one in of.fields}


def _type_inside(field: ProtoField, of: ProtoMessage) -> str:
    """A field's type, without the name of its own message."""
    return field.wire_type.removeprefix(of.full_name)


def _types(schema: Schema) -> dict[str, ProtoMessage | ProtoEnum]:
    return {**schema.messages, **schema.enums}


def _missed(subject: Subject, change: Change, file: str, scope: str, earlier: Span) -> Span:
    """The innermost message that is left of those around something, or its file, or where it was in that."""
    while scope:
        message = change.after.messages.get(scope)
        if message is not None and message.file == file:
            return message.span
        scope = scope.rpartition(".")[0]
    return subject.place(file, 1, 1) if file in change.after.files else earlier
