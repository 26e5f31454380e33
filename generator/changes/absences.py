"""Types and extensions that are not where they were."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from generator.changes.pairing import extensions_by_number
from generator.findings import Span
from generator.protos import ProtoEnum, ProtoExtension, ProtoMessage, Schema
from generator.subject import Change, Subject

_PROTOBUF = "google/protobuf/"


@dataclass(frozen=True, slots=True)
class Absence:
    """A message or an enum that its file does not declare any more."""

    old: ProtoMessage | ProtoEnum
    new: ProtoMessage | ProtoEnum | None
    """What has its full name, in another file; None where nothing has."""
    span: Span
    """Where it is missed: the message that it stood in, or else the file."""


def absent_types(subject: Subject, change: Change) -> Iterator[Absence]:
    """The outermost of the types that their files do not declare any more.

    What protobuf itself comes with is left out: that nothing imports it any more is no fault.
    """
    if change.of_ledger:
        return
    before, after = _types(change.before), _types(change.after)
    absent = {name for name, old in before.items() if name not in after or after[name].file != old.file}
    for name in sorted(absent):
        old, scope = before[name], name.rpartition(".")[0]
        written = isinstance(old, ProtoEnum) or not old.map_entry
        if written and scope not in absent and not old.file.startswith(_PROTOBUF):
            yield Absence(old, after.get(name), _missed(subject, change, old.file, scope))


def absent_extensions(subject: Subject, change: Change) -> Iterator[tuple[ProtoExtension, ProtoExtension | None, Span]]:
    """The extensions whose number nothing has any more, or something in another file: with that, and where."""
    if change.of_ledger:
        return
    after = extensions_by_number(change.after)
    for key, old in extensions_by_number(change.before).items():
        new = after.get(key)
        if new is None or new.file != old.file:
            yield old, new, _missed(subject, change, old.file, old.scope)


def _types(schema: Schema) -> dict[str, ProtoMessage | ProtoEnum]:
    return {**schema.messages, **schema.enums}


def _missed(subject: Subject, change: Change, file: str, scope: str) -> Span:
    """The innermost message that is left of those around something, or its file, or where that was."""
    while scope:
        message = change.after.messages.get(scope)
        if message is not None and message.file == file:
            return message.span
        scope = scope.rpartition(".")[0]
    return subject.place(file, 1, 1) if file in change.after.files else subject.place(file, 0, 0)
