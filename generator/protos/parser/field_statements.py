"""Parser for the statement of one field or enum value."""

from __future__ import annotations

from roverlink.generator.protos.parser.phrases import Words
from roverlink.generator.protos.parser.source_text import Source
from roverlink.generator.protos.parser.statements import LABELS, Statement
from roverlink.generator.protos.parser.tokens import Kind
from roverlink.generator.protos.schema import ProtoEnumValue, ProtoField


def group_name(statement: Statement) -> str:
    """Return the name of the message that a proto2 group declares: ``Result`` for ``optional group Result = 1 {``.

    Returns an empty text if the statement is not a group.
    """
    texts = [token.text for token in statement.tokens[:3] if token.text not in LABELS]
    is_group = statement.ending == "{" and texts[:1] == ["group"] and texts[1:] and texts[1].isidentifier()
    return texts[1] if is_group else ""


def read_field(source: Source, statement: Statement, oneof: str) -> ProtoField | None:
    """Return the field that a statement declares; None if the name or the number is missing.

    All faults of the statement are reported as problems of the file.
    """
    words = Words(statement.tokens)
    # `optional = 1` is a field without a type, whose name is `optional`; `optional .pkg.Type x = 1` has a label.
    label = words.take(*LABELS) if words.next(1).kind is Kind.NAME or words.next(1).is_symbol(".") else ""
    key_type, value_type = words.map_types()
    type = f"map<{key_type}, {value_type}>" if value_type else words.type_name()
    name = words.name()
    if not name and "." not in type and not value_type:
        type, name = "", type  # of `x = 1`, the one word is more useful as a name than as a type
    follows = words.next()
    if not name or not ((words.done and type) or follows.text in ("=", "[") or follows.kind is Kind.NUMBER):
        source.unreadable(statement, "not a declaration")
        return None
    number, complete, options = _numbered(words, signed=False)
    if not (complete and type and statement.ending):
        source.unreadable(statement, "a field with wrong syntax")
    group = type == "group"
    if group != (statement.ending == "{") and statement.ending:
        source.unreadable(statement, "a group without a body")
    if number is None:
        return None
    # `optional group Result = 1 {}` declares the message Result and the field `result` (Language Guide proto2,
    # "Groups").
    name = name.lower() if group else name
    return ProtoField(
        span=source.span(statement),
        number=number,
        name=name,
        type=type,
        label=label,
        oneof=oneof,
        json_name=options.get("json_name", Words(())).string() or "",
    )


def read_value(source: Source, statement: Statement) -> ProtoEnumValue | None:
    """Return the enum value that a statement declares; None if the name or the number is missing."""
    words = Words(statement.tokens)
    name = words.name()
    if not name:
        source.unreadable(statement, "not an enum value")
        return None
    number, complete, _ = _numbered(words, signed=True)
    if not (complete and statement.ending == ";"):
        source.unreadable(statement, "an enum value with wrong syntax")
    return None if number is None else ProtoEnumValue(span=source.span(statement), name=name, number=number)


def _numbered(words: Words, signed: bool) -> tuple[int | None, bool, dict[str, Words]]:
    """Read the part of a statement after the name: ``= 4 [options]``.

    Returns the number, which is None if it is missing, then True if the part is complete and nothing else follows, and
    the values of the options by name.
    """
    assigned = bool(words.take("="))
    number = words.number(signed)
    options = words.bracketed_options()
    return number, assigned and number is not None and words.done and words.closed, options
