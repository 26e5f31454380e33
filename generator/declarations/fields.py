"""Fields and enum values: one statement each."""

from __future__ import annotations

from generator.declarations.model import EnumValue, Field
from generator.declarations.phrases import Words
from generator.declarations.source import Source
from generator.declarations.statements import LABELS, Statement
from generator.declarations.tokens import Kind


def is_group(statement: Statement) -> bool:
    """Whether a statement opens a group: a field that is a message at once."""
    texts = [token.text for token in statement.tokens[:2] if token.text not in LABELS]
    return statement.ending == "{" and texts[:1] == ["group"]


def read_field(source: Source, statement: Statement, oneof: str) -> Field | None:
    """The field that a statement declares, if it has at least a name; what it lacks else is a problem."""
    words, first = Words(statement.tokens), statement.tokens[0]
    label = words.take(*LABELS) if words.next(1).kind is Kind.NAME or words.next(1).is_symbol(".") else ""
    key_type, value_type = words.map_types()
    type = f"map<{key_type}, {value_type}>" if value_type else words.type_name()
    name = words.name()
    if not name and "." not in type and not value_type:
        type, name = "", type  # more is known of a field without a type than of a type without a field
    follows = words.next()
    if not name or not ((words.done and type) or follows.text in ("=", "[") or follows.kind is Kind.NUMBER):
        source.unreadable(statement, "neither a field nor another declaration")
        return None
    number, options, complete = _numbered(source, words, signed=False)
    if not (complete and type and statement.ending):
        source.unreadable(statement, "a field that is not written as it should be")
    group = type == "group"
    if group != (statement.ending == "{") and statement.ending:
        source.unreadable(statement, "a group without a body")
    name = name.lower() if group else name
    comment = "" if group else source.comment(statement)
    place = first.line, first.column
    return Field(number, name, type, key_type, value_type, label, oneof, options, comment, *place)


def read_value(source: Source, statement: Statement) -> EnumValue | None:
    """The enum value that a statement declares, if it has at least a name."""
    words, first = Words(statement.tokens), statement.tokens[0]
    name = words.name()
    if not name:
        source.unreadable(statement, "not an enum value")
        return None
    number, options, complete = _numbered(source, words, signed=True)
    if not (complete and statement.ending == ";"):
        source.unreadable(statement, "an enum value that is not written as it should be")
    return EnumValue(name, number, options, source.comment(statement), first.line, first.column)


def _numbered(source: Source, words: Words, signed: bool) -> tuple[int | None, dict[str, str], bool]:
    """The number and the options, and whether they are all that there is."""
    assigned = bool(words.take("="))
    number = words.number(signed)
    options = words.bracketed(source.text)
    return number, options, assigned and number is not None and words.done and words.closed
