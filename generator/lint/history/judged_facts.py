"""Facts and contents of the history as the judgement takes them."""

from __future__ import annotations

from functools import lru_cache

from roverlink.generator.lint.comparison.cardinality import EXPLICIT, MAP, REPEATED, REQUIRED
from roverlink.generator.lint.comparison.judgement import NAMED, Part, TypeState, judge_field
from roverlink.generator.lint.history.usage_model import Content
from roverlink.generator.protos.parser import SCALARS
from roverlink.generator.protos.schema import Fact, default_json_name

_UNNAMED = SCALARS | {"", "group"}
_CARDINALITIES = {"repeated": REPEATED, "required": REQUIRED}


def part(fact: Fact, content: Content | None = None) -> Part:
    """Return a field or enum value as it is judged. ``content`` is the content of the field's type, if it is known."""
    return _part(fact, _kind(fact.type, content))


@lru_cache(maxsize=1 << 16)
def _part(fact: Fact, kind: str) -> Part:
    if not fact.type:
        return Part(fact.number, fact.name)
    # The syntax of the file, which decides about presence, is not stored. Presence changes no bytes that are sent.
    count = MAP if fact.type.startswith("map<") else _CARDINALITIES.get(fact.label, EXPLICIT)
    json_name = fact.json_name or default_json_name(fact.name)
    return Part(fact.number, fact.name, kind, count, json_name, bool(fact.oneof) and kind in ("message", NAMED))


def is_named(type: str) -> bool:
    """Return True if a type is the name of a message or enum. A group has no name of its own."""
    return type not in _UNNAMED and not type.startswith("map<")


def _kind(type: str, content: Content | None) -> str:
    if not is_named(type):
        return type
    return NAMED if content is None else "enum" if content.enum else "message"


def type_state(type: str, content: Content | None) -> TypeState:
    """Return the type of a field as it is judged; without fields or values if ``content`` is None."""
    return TypeState(content.type, tuple(map(part, content.facts))) if content else TypeState(type.lstrip("."))


def same_field(old: Fact, new: Fact) -> bool:
    """Return True if two fields agree as far as they show themselves: compatible bytes, and names that are no other."""
    return not judge_field(part(old), part(new), types=None, moved=False).certain
