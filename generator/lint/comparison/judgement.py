"""The judgement of two declarations that had the same number: decides if the number has kept its meaning.

It does not matter how much time is between the two: the comparison with an earlier state, with the ledger and with the
whole history all ask here. The bytes are judged first, because a receiver with the new type must be able to read the
old bytes. Then the names are judged. Bytes contain no names, but names tell what people mean; see `similar_names`.

A message or enum that takes the place of another one is judged by its fields or values, and by the name of the field
that it is the type of. Less than two telling names that stayed prove nothing: half of all messages have one field, and
many have `x`, `y` and `z`. Then the names of the types decide, unless the field that has the type kept its name, or
has a similar one and all fields of the type survive.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache

from roverlink.generator.lint.comparison.cardinality import broken_by_cardinality, only_required, shown
from roverlink.generator.lint.comparison.field_type_changes import ENUM_LIKE, broken_by_kind
from roverlink.generator.lint.names.name_units import Measure, disagree, factor, measure
from roverlink.generator.lint.names.name_words import words
from roverlink.generator.lint.names.similar_names import Comparison, Likeness, compare_names, is_telling
from roverlink.generator.lint.names.value_names import shared_words
from roverlink.generator.protos.parser import SCALARS, map_types
from roverlink.numerals import counted

ENUM_VALUE = "enum value"
NAMED = "message or enum"

_OF_NAMED = frozenset({NAMED, "message", "group"}) | ENUM_LIKE
_WITHOUT_UNIT = frozenset({"string", "bytes", "bool", "enum", ENUM_VALUE})
_FEWEST = 3  # with fewer fields, each one may have changed on its own
_PROOF = 2


class Meaning(Enum):
    """Result of a judgement: what became of the meaning of a number. A later one is graver."""

    SAME = "the same meaning under the same name"
    RENAMED = "the same meaning under another name"
    DOUBTFUL = "perhaps another meaning"
    UNIT = "the same quantity in another unit, scale or reference"
    OTHER = "another meaning"
    WIRE = "another type, which reads the bytes differently"


_GRAVITY = list(Meaning)
_BY_LIKENESS = {
    Likeness.SAME: Meaning.SAME,
    Likeness.SIMILAR: Meaning.RENAMED,
    Likeness.DOUBTFUL: Meaning.DOUBTFUL,
    Likeness.DIFFERENT: Meaning.OTHER,
    Likeness.OPPOSITE: Meaning.OTHER,
}


@dataclass(frozen=True, slots=True)
class Judgement:
    """The judgement of two declarations, with the reason as a clause; empty if the meaning is the same."""

    meaning: Meaning
    reason: str = ""
    by_words: bool = False
    """True if the meaning is another one only because the names have different words, which no rule knows."""

    @property
    def certain(self) -> bool:
        """True if bytes with the old meaning are misread with the new one."""
        return self.meaning in (Meaning.OTHER, Meaning.WIRE)


@dataclass(frozen=True, slots=True)
class Part:
    """A field of a message, or a value of an enum, as it is judged."""

    number: int
    name: str
    kind: str = ENUM_VALUE
    """The scalar type, ``message``, ``enum`` or ``group``, or `NAMED` if it is not known which of these.

    It may also be a map with the types of its keys and values, such as ``map<string, Wheel>``. For a value of an enum,
    it is `ENUM_VALUE`.
    """
    cardinality: str = ""
    """A result of the function `cardinality`; empty for a value of an enum."""
    json_name: str = ""
    payload: bool = False
    """True for a message in a oneof. Its type says what it means."""


@dataclass(frozen=True, slots=True)
class TypeState:
    """A message or enum in one state, as it is judged."""

    full_name: str
    parts: tuple[Part, ...] = ()
    """The fields or values; empty if they are unknown."""

    @property
    def name(self) -> str:
        """The name without its package and the messages around it."""
        return self.full_name.rpartition(".")[2]

    @property
    def shared_words(self) -> frozenset[str]:
        """The words that say nothing in the names of an enum's values; empty for a message."""
        names = [part.name for part in self.parts if part.kind == ENUM_VALUE]
        return shared_words(self.name, names) if names else frozenset()


@dataclass(frozen=True, slots=True)
class TypePair:
    """The old and the new type of a field or payload."""

    old: TypeState
    new: TypeState
    beside: bool
    """True if the old and the new state declare both types, so that none of them is the other one with another name."""
    at_once: bool = True
    """True if no state between the old and the new one left the number unused."""


_SAME = Judgement(Meaning.SAME)


# --- fields and values ------------------------------------------------------------------------------------------------


def judge_field(old: Part, new: Part, types: TypePair | None, moved: bool) -> Judgement:
    """Judge two declarations of a field.

    ``types`` are the types of the field if these are messages or enums. ``moved`` is True if a field with another
    number had the new name in the old state.
    """
    found = _judge_alone(old, new)
    if found.meaning is Meaning.WIRE:
        return found
    if types and types.old.full_name != types.new.full_name:
        by_type = judge_types(types, old.name, new.name)
        if by_type.meaning is not Meaning.RENAMED or old.payload or new.payload:
            return by_type
        # The fields of the type say that it is the same one. So other words in the field's name are no proof.
        if found.meaning is Meaning.OTHER:
            return Judgement(Meaning.DOUBTFUL, f"the types have the same fields, but {found.reason}")
        return by_type if found.meaning is Meaning.SAME else found
    if moved:
        return _had_another_number(new)
    if types and found.meaning is Meaning.OTHER and old.payload and new.payload and _says_the_type(types.old, old, new):
        return Judgement(Meaning.RENAMED)
    return found


def judge_value(old: Part, new: Part, moved: bool, shared: frozenset[str]) -> Judgement:
    """Judge two values of an enum. ``moved`` is True if another number had the new name in the old state.

    ``shared`` are the words that say nothing in the names of this enum; see `TypeState.shared_words`.
    """
    return _had_another_number(new) if moved else _judge_alone(old, new, shared)


def judge_compounds(judged: Judgement, old: str, new: str, shared: frozenset[str], names: Iterable[str]) -> Judgement:
    """Judge two names with different words again, with compound words split into words of the ``names`` beside them."""
    if not judged.by_words:
        return judged
    return _by_names(compare_names(old, new, shared, _words_of(frozenset(names))))


@lru_cache(maxsize=1024)
def _words_of(names: frozenset[str]) -> frozenset[str]:
    return frozenset(word for name in names for word in words(name))


def _had_another_number(new: Part) -> Judgement:
    return Judgement(Meaning.OTHER, f"{new.name!r} had another number")


def least(judgements: Iterable[Judgement]) -> Judgement:
    """Return the least grave of some judgements."""
    return min(judgements, key=lambda judgement: _GRAVITY.index(judgement.meaning))


def gravest(judgements: Iterable[Judgement]) -> Judgement:
    """Return the gravest of some judgements."""
    return max(judgements, key=lambda judgement: _GRAVITY.index(judgement.meaning))


def _judge_alone(old: Part, new: Part, shared: frozenset[str] = frozenset()) -> Judgement:
    """Judge two fields or values by their own bytes and names, without a look at other fields and at the types."""
    if old == new:
        return _SAME
    if _broken(old.kind, new.kind):
        return Judgement(Meaning.WIRE, f"a receiver of {new.kind} misreads {old.kind}")
    counts = old.cardinality, new.cardinality
    if broken_by_cardinality(*counts) and not only_required(*counts):
        return Judgement(Meaning.WIRE, f"it was {shown(old.cardinality)} and is now {shown(new.cardinality)}")
    compared = compare_names(old.name, new.name, shared)
    # The name in JSON of `motor_speed` is `motorSpeed`, but people also write the old name as it was.
    if compared.likeness is not Likeness.SAME and new.json_name and new.json_name in (old.json_name, old.name):
        return Judgement(Meaning.RENAMED)
    if compared.likeness in (Likeness.SIMILAR, Likeness.DOUBTFUL) and new.kind not in _WITHOUT_UNIT:
        measures = measure(words(old.name)), measure(words(new.name))
        if disagree(*measures):
            return Judgement(Meaning.UNIT, _other_unit(*measures))
    return _by_names(compared)


def _by_names(compared: Comparison) -> Judgement:
    return Judgement(_BY_LIKENESS[compared.likeness], compared.reason, compared.likeness is Likeness.DIFFERENT)


def _broken(old: str, new: str) -> bool:
    """Return True if a receiver of the kind ``new`` misreads bytes of the kind ``old``; see `Part.kind`."""
    old_map, new_map = map_types(old), map_types(new)
    if old_map and new_map:
        inner = zip(old_map, new_map, strict=True)
        return any(_broken(*(type if type in SCALARS else NAMED for type in pair)) for pair in inner)
    old, new = "message" if old_map else old, "message" if new_map else new
    if NAMED in (old, new):
        return not {old, new} <= _OF_NAMED
    return broken_by_kind(old, new)


def _other_unit(old: Measure, new: Measure) -> str:
    read = f"old values ({old.shown}) are read as {new.shown}"
    times = factor(old, new)
    if times is None or times == 1:
        return read
    return f"{read}, {f'{times:.6g} times too large' if times > 1 else f'{1 / times:.6g} times too small'}"


def _says_the_type(type: TypeState, *parts: Part) -> bool:
    """Return True if one of the fields has the name of its type: then the type says what a payload means."""
    # A type such as `Empty` or `Vector` says nothing: `Empty start` is not `Empty reset`.
    likenesses = (compare_names(part.name, type.name).likeness for part in parts)
    opposite = compare_names(*(part.name for part in parts)).likeness is Likeness.OPPOSITE
    return not opposite and any(likeness in (Likeness.SAME, Likeness.SIMILAR) for likeness in likenesses)


# --- types ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Kept:
    """Comparison of the fields or values of two types by number."""

    before: int
    """Number of fields or values of the old type."""
    kept: int
    """Number of them that have the same meaning and type in the new type. Doubtful ones are counted."""
    telling: int
    """Number of these whose names two types hardly share by chance."""
    retyped: int
    """Number of old fields that have the same name and another type now."""
    replaced: int
    """Number of old fields or values whose number has another meaning and name now."""

    @property
    def left(self) -> int:
        """Number of old fields that have kept their meaning, perhaps with another type."""
        return self.kept + self.retyped

    @property
    def is_another_message(self) -> bool:
        """True if less than a third of the fields are left, and others took at least half of the old numbers."""
        # A message that lost fields without replacement is misread by nobody: its old numbers are unknown fields.
        return self.before >= _FEWEST and self.left * 3 < self.before <= self.replaced * 2


def compare_parts(old: TypeState, new: TypeState) -> Kept:
    """Compare the fields or values of two types by number."""
    shared = old.shared_words | new.shared_words
    after: dict[int, list[Part]] = {}
    for part in new.parts:
        after.setdefault(part.number, []).append(part)
    kept = telling = retyped = replaced = 0
    for part in old.parts:
        found = [(_judge_alone(part, other, shared), other) for other in after.get(part.number, ())]
        if any(not judgement.certain for judgement, _ in found):
            kept += 1
            telling += is_telling(part.name, shared)
        elif any(other.name == part.name for _, other in found):
            retyped += 1
        elif found:
            replaced += 1
    return Kept(len(old.parts), kept, telling, retyped, replaced)


def judge_types(types: TypePair, *fields: str) -> Judgement:
    """Judge a message or enum that took the place of another one.

    ``fields`` are the old and the new name of the field or payload that has the type.
    """
    old, new = types.old, types.new
    parts, smaller = compare_parts(old, new), min(len(old.parts), len(new.parts))
    if smaller and parts.kept * 3 < 2 * smaller:
        kept = f"{parts.kept} of the {counted(parts.before, 'field')} of {old.name!r}"
        return Judgement(Meaning.OTHER, f"{new.name!r} has {kept}")
    by_type, by_field = compare_names(old.name, new.name), compare_names(fields[0], fields[1])
    for compared in (by_type, by_field):
        if compared.likeness is Likeness.OPPOSITE:
            return Judgement(Meaning.OTHER, compared.reason)
    if by_type.likeness is Likeness.SAME:  # it moved to another package
        return Judgement(Meaning.RENAMED)
    same_field = by_field.likeness is Likeness.SAME
    survives = by_field.likeness is Likeness.SIMILAR and parts.kept == parts.before
    proven = parts.telling >= _PROOF or (parts.kept and (same_field or survives) and not types.beside)
    if not proven and by_type.likeness is Likeness.DIFFERENT and same_field:
        return Judgement(Meaning.DOUBTFUL, f"{by_type.reason}, and too few of their fields have telling names")
    if not proven or (types.beside and not same_field):
        return _by_names(by_type)
    named_alike = {by_type.likeness, by_field.likeness} & {Likeness.SAME, Likeness.SIMILAR}
    if types.at_once or named_alike:
        return Judgement(Meaning.RENAMED)
    return Judgement(Meaning.DOUBTFUL, f"the types have the same fields, but {by_type.reason}")
