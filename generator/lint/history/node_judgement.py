"""The judgement of two facts at two nodes of the history, with the contents that their types have there.

A fact is the declaration of a field or an enum value. A node is a commit that changes .proto files.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from roverlink.generator.lint.comparison.judgement import Judgement, TypePair, judge_field, judge_value
from roverlink.generator.lint.history.judged_facts import is_named, part, type_state
from roverlink.generator.lint.history.lookup import Record
from roverlink.generator.lint.history.usage_model import Content
from roverlink.generator.protos.parser import map_types
from roverlink.generator.protos.schema import Fact


@dataclass(frozen=True, slots=True)
class FactAtNode:
    """A fact of the message or enum with the id ``owner``, at a node."""

    owner: int
    fact: Fact
    node: int


@dataclass(frozen=True, slots=True)
class JudgedFacts:
    """The judgement of an old and a new fact, and what was known about their types."""

    judgement: Judgement
    types: TypePair | None
    """The types, if both facts are fields with a message or enum as their type, or maps with such values."""
    old: Content | None
    new: Content | None
    """The contents of the types; None if a type is no message or enum, or is unknown. For a map, that of its values."""


def judge_facts(
    record: Record, old: FactAtNode, new: FactAtNode, moved: bool, at_once: bool, shared: frozenset[str]
) -> JudgedFacts:
    """Judge two facts with the same number.

    ``moved`` is True if a fact with another number has the new name at the old node. ``at_once`` is True if no commit
    between the two left the number unused. ``shared`` are the words that say nothing in the names of an enum.
    """
    values = [(map_types(at.fact.type) or ("", at.fact.type))[1] for at in (old, new)]
    one, other = (record.content_of_type(type, at.owner, at.node) for type, at in zip(values, (old, new)))
    types = None
    if all(map(is_named, values)):
        types = _types(record, old, new, values, one, other, at_once)
    if old.fact.type or new.fact.type:
        judged = judge_field(part(old.fact, one), part(new.fact, other), types, moved)
    else:
        judged = judge_value(part(old.fact), part(new.fact), moved, shared)
    return JudgedFacts(judged, types, one, other)


def _types(
    record: Record,
    old: FactAtNode,
    new: FactAtNode,
    names: Sequence[str],
    one: Content | None,
    other: Content | None,
    at_once: bool,
) -> TypePair:
    """Return the types of two facts as they are judged; ``one`` and ``other`` are their contents."""
    states = type_state(names[0], one), type_state(names[1], other)
    if one is None or other is None or one.id == other.id:
        return TypePair(*states, False, at_once)
    beside = record.declared(one.id, new.node) and record.declared(other.id, old.node)
    return TypePair(*states, bool(beside), at_once)
