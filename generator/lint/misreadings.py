"""Misreadings between two states of the protos: numbers that two programs, each built from one state, read differently.

The comparison starts at the envelope and follows the fields, so a message is compared with whatever the other state
decodes at the same place. The declarations are judged as `--against` judges them, from the older state to the newer
one (see `judgement`). But two programs talk in both directions, so bytes that only the older one misreads count, too.

Numbers that only one state has are no misreading: a receiver skips unknown fields.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass, replace

from roverlink.generator.diagnostics import Span
from roverlink.generator.lint.comparison import EnumPair, FieldPair, MessagePair, SchemaChange, fields_of_messages
from roverlink.generator.lint.comparison.cardinality import is_map, required_changes
from roverlink.generator.lint.comparison.default_values import default_changed
from roverlink.generator.lint.comparison.default_values import shown as shown_default
from roverlink.generator.lint.comparison.enum_renames import renamed_in
from roverlink.generator.lint.comparison.field_type_changes import broken_by_kind, kind
from roverlink.generator.lint.comparison.judged_changes import judge_number, judge_pair
from roverlink.generator.lint.comparison.judgement import (
    NAMED,
    Judgement,
    Meaning,
    Part,
    TypePair,
    TypeState,
    judge_field,
)
from roverlink.generator.lint.comparison.oneof_changes import broken_by_oneof, moved_text
from roverlink.generator.lint.comparison.pairing import extensions_by_number
from roverlink.generator.lint.fixits.declarations import declaration, value_place
from roverlink.generator.lint.fixits.put_back_or_reserve import values as declared_values
from roverlink.generator.protos.schema import ProtoField, Schema


@dataclass(frozen=True, slots=True)
class Side:
    """A declaration in one of two states: a text that says what it is, and its place."""

    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Misreading:
    """A number of a message or enum whose declarations in an older and a newer state do not mean the same."""

    owner: str
    """Full name of the message or enum in the newer state."""
    number: int | None
    """The number of the field or enum value; None if the message as a whole is encoded differently."""
    old: Side
    new: Side
    reason: str
    """Why a program misreads the other one, as a clause; empty if the two declarations show it."""
    certain: bool
    """False if the two declarations perhaps mean the same."""


def misreadings(change: SchemaChange, old: str, new: str) -> tuple[Misreading, ...]:
    """Return the misreadings in all messages and enums that an envelope can contain, sorted by owner and number.

    ``old`` and ``new`` are the full names of the envelope in the two states of the change.
    """
    names = _names_in_package(change, old, new)
    walk = _Walk(replace(change, before=_renamed(change.before, names)) if names else change)
    walk.compare(names.get(old, old), new)
    return tuple(sorted(walk.found.values(), key=lambda misreading: (misreading.owner, misreading.number or 0)))


def _names_in_package(change: SchemaChange, old: str, new: str) -> dict[str, str]:
    """Return the new full name of each type of the older state, if only the package of the envelope has changed.

    A package that is added or changed renames every type in it, but changes no bytes. Types that the newer state does
    not have under the new name are left out.
    """
    was, now = (f"{name.rpartition('.')[0]}.".lstrip(".") for name in (old, new))
    before, after = ({*schema.messages, *schema.enums} for schema in (change.before, change.after))
    moved = {name: f"{now}{name.removeprefix(was)}" for name in before if was != now and name.startswith(was)}
    return {name: other for name, other in moved.items() if other in after - before and name not in after}


def _renamed(schema: Schema, names: dict[str, str]) -> Schema:
    """Return a schema in which some messages and enums have other full names."""

    def linked(field: ProtoField) -> ProtoField:
        return replace(field, type_name=names.get(field.type_name, field.type_name))

    messages = [
        replace(message, full_name=names.get(name, name), fields=tuple(map(linked, message.fields)))
        for name, message in schema.messages.items()
    ]
    enums = [replace(enum, full_name=names.get(name, name)) for name, enum in schema.enums.items()]
    extensions = [
        replace(extension, extendee=names.get(extension.extendee, extension.extendee), field=linked(extension.field))
        for extension in schema.extensions
    ]
    return replace(
        schema,
        messages={message.full_name: message for message in messages},
        enums={enum.full_name: enum for enum in enums},
        extensions=tuple(extensions),
    )


def _on_the_wire(field: ProtoField) -> tuple[Hashable, ...]:
    return field.number, field.name, field.type, field.type_name, field.label, field.oneof, tuple(field.facets.items())


class _Walk:
    """Comparison of two messages with all messages and enums inside them, also if these contain each other."""

    def __init__(self, change: SchemaChange) -> None:
        self.change = change
        self.found: dict[tuple[str, int | None], Misreading] = {}
        self._extensions = [extensions_by_number(schema) for schema in (change.before, change.after)]

    def compare(self, old: str, new: str) -> None:
        """Compare two messages of the older and the newer state, and the types of their fields at any depth."""
        seen = {(old, new)}
        waiting: list[tuple[str, str, FieldPair | None]] = [(old, new, None)]
        while waiting:
            for next in self._types(*waiting.pop()):
                if next[:2] not in seen:
                    seen.add(next[:2])
                    waiting.append(next)

    def _types(self, old: str, new: str, of_map: FieldPair | None) -> Iterator[tuple[str, str, FieldPair | None]]:
        """Compare two types, and yield the types of their fields.

        ``of_map`` is the map to which the types belong, if they are the entries that protoc generates for it.
        """
        before, after = self.change.before, self.change.after
        if old in before.enums and new in after.enums:
            self._enums(EnumPair(self.change, before.enums[old], after.enums[new]))
        if old not in before.messages or new not in after.messages:
            return
        messages = MessagePair(self.change, before.messages[old], after.messages[new])
        for pair in (*fields_of_messages(messages), *self._pairs_of_extensions(old, new)):
            if judged := self._judged(pair):
                self._add_field(of_map or pair, judged)
            if not (judged and judged.certain) and pair.old.type_name and pair.new.type_name:
                is_entry = is_map(pair.old, before) and is_map(pair.new, after)
                yield pair.old.type_name, pair.new.type_name, pair if is_entry else None
        self._whole(messages)

    def _pairs_of_extensions(self, old: str, new: str) -> Iterator[FieldPair]:
        before, after = self._extensions
        for (extendee, number), extension in after.items():
            if extendee == new and (was := before.get((old, number))):
                yield FieldPair(self.change, new, was.field, extension.field, None, (was.file, extension.file))

    # --- judgement ----------------------------------------------------------------------------------------------------

    def _judged(self, pair: FieldPair) -> Judgement | None:
        """Return the judgement of a field that is perhaps misread; None for the others."""
        # Most fields are the same in all states. The default of an enum is its first value, which may be another one.
        if pair.old.type != "enum" and _on_the_wire(pair.old) == _on_the_wire(pair.new):
            return None
        judged = judge_pair(pair) if self._declares_both(pair) else self._judged_by_name(pair)
        if judged.certain:
            return judged
        if broken_by_oneof(pair):
            return Judgement(Meaning.WIRE, f"{moved_text(pair)}, and a receiver keeps only the last field of a oneof")
        if self._is_compiled(*pair.files) and default_changed(pair):
            old, new = shown_default(pair.old, self.change.before), shown_default(pair.new, self.change.after)
            return Judgement(Meaning.WIRE, f"if the field is absent, it is read as {old} and as {new}")
        old_kind, new_kind = kind(pair.old), kind(pair.new)
        if self._declares_both(pair) and broken_by_kind(new_kind, old_kind):
            return Judgement(Meaning.WIRE, f"a receiver of {old_kind} misreads {new_kind}")
        return judged if judged.meaning in (Meaning.DOUBTFUL, Meaning.UNIT) else None

    def _declares_both(self, pair: FieldPair) -> bool:
        """Return False if the type of the field is a message or enum that one of the two states does not declare."""
        sides = (self.change.before, pair.old), (self.change.after, pair.new)
        return all(
            not field.type_name or field.type_name in schema.messages or field.type_name in schema.enums
            for schema, field in sides
        )

    def _judged_by_name(self, pair: FieldPair) -> Judgement:
        """Judge a field whose type is unknown, because a file does not compile."""
        old, new = (
            Part(fact.number, fact.name, NAMED if fact.type_name else fact.type) for fact in (pair.old, pair.new)
        )
        types = TypePair(TypeState(pair.old.type_name), TypeState(pair.new.type_name), beside=False)
        return judge_field(old, new, types if pair.old.type_name and pair.new.type_name else None, moved=False)

    def _is_compiled(self, old: str, new: str) -> bool:
        return old not in self.change.before.uncompiled and new not in self.change.after.uncompiled

    # --- results ------------------------------------------------------------------------------------------------------

    def _add(self, owner: str, number: int | None, old: Side, new: Side, judged: Judgement) -> None:
        known = self.found.get((owner, number))
        if known is None or (judged.certain and not known.certain):
            self.found[owner, number] = Misreading(owner, number, old, new, judged.reason, judged.certain)

    def _add_field(self, pair: FieldPair, judged: Judgement) -> None:
        owner = pair.messages.old.full_name if pair.messages else pair.owner
        old = self._side(pair.old, self.change.before, owner, pair.files[0])
        new = self._side(pair.new, self.change.after, pair.owner, pair.files[1])
        self._add(pair.owner, pair.new.number, old, new, judged)

    @staticmethod
    def _side(field: ProtoField, schema: Schema, owner: str, file: str) -> Side:
        return Side(f"`{declaration(field, schema, owner, schema.syntax_of(file))}`", field.span)

    def _whole(self, pair: MessagePair) -> None:
        """Compare what concerns two messages as a whole: required fields, and the format of their extensions."""
        if not self._is_compiled(pair.old.file, pair.new.file):
            return  # options decide about both
        for fields in required_changes(pair):
            states = zip(fields, (pair.old, pair.new), (self.change.before, self.change.after), strict=True)
            old, new = (
                (
                    self._side(state, schema, message.full_name, message.file)
                    if state
                    else Side("not declared", message.span)
                )
                for state, message, schema in states
            )
            number = next(field.number for field in fields if field)
            reason = "a receiver with the required field rejects messages without it"
            self._add(pair.new.full_name, number, old, new, Judgement(Meaning.WIRE, reason))
        if pair.old.facets != pair.new.facets:
            old, new = (
                Side("a message set" if fact.facets else "no message set", fact.span) for fact in (pair.old, pair.new)
            )
            self._add(pair.new.full_name, None, old, new, Judgement(Meaning.WIRE, "no program reads both formats"))

    def _enums(self, pair: EnumPair) -> None:
        for number, gone, values in renamed_in(pair):
            judged = judge_number(pair, number, gone, values)
            if judged.meaning not in (Meaning.SAME, Meaning.RENAMED):
                names = [value.name for value in pair.old.values if value.number == number]
                old = Side(f"`{declared_values(names, number)}`", value_place(pair.old, number))
                new = Side(
                    f"`{declared_values([value.name for value in values], number)}`", value_place(pair.new, number)
                )
                self._add(pair.new.full_name, number, old, new, judged)
