"""Comparisons that decide if two fields, two enum values or two contents of a message have the same meaning."""

from __future__ import annotations

from collections.abc import Collection
from functools import lru_cache

from roverlink.generator.lint.comparison.field_type_changes import broken_by_kind
from roverlink.generator.lint.history.usage_model import Content
from roverlink.generator.lint.names.name_words import share_a_word, words
from roverlink.generator.protos.parser import SCALARS
from roverlink.generator.protos.schema import Fact

_FEWEST = 3  # with fewer fields, each one may have changed on its own
_TELLING = 2  # half of all messages have a single field, so that one proves nothing
_ENUM_LIKE = frozenset({"int32", "int64", "uint32", "uint64"})


def same_field(old: Fact, new: Fact) -> bool:
    """Return True if two fields have the same meaning: compatible bytes, and names that share a word."""
    # A packed list is one LEN record, a single number is a VARINT, I32 or I64 record (encoding guide, "Repeated
    # Elements").
    if (old.label == "repeated") != (new.label == "repeated"):
        return False
    return _types_agree(old, new) and alike(old.name, new.name)


@lru_cache(maxsize=1 << 16)
def alike(old: str, new: str) -> bool:
    """Return True if two names share a word. Results are cached, because the same names are compared many times."""
    return old == new or share_a_word([old], [new])


def _types_agree(old: Fact, new: Fact) -> bool:
    """Return True if two fields may have compatible types, as far as the names of fields and types show."""
    scalars = [fact.type in SCALARS for fact in (old, new)]
    if all(scalars):
        return not broken_by_kind(old.type, new.type)
    if any(scalars):  # the other may be an enum
        return old.name == new.name and (old.type if scalars[0] else new.type) in _ENUM_LIKE
    return old.name == new.name or simple(old.type) == simple(new.type)


def differ(one: tuple[str, str], other: tuple[str, str]) -> bool:
    """Return True if two usages of a number, each given as type and name, are different payloads.

    Usages with different types are different; a package in front of one type is ignored. Scalars of one type, and enum
    values, are different if their names are different.
    """
    types = [f".{type.lstrip('.')}" for type, _ in (one, other)]
    if not (types[0].endswith(types[1]) or types[1].endswith(types[0])):  # one of the two may include the package
        return True
    return (not one[0] or one[0] in SCALARS) and one[1] != other[1]


def simple(type: str) -> str:
    """Return a type's name without its package and the messages around it: ``rover.Imu`` -> ``Imu``."""
    return type.rpartition(".")[2]


def survivors(old: Content, new: Content) -> int:
    """Return the number of old fields or values that exist with the same meaning in the new content."""
    after: dict[int, list[Fact]] = {}
    for fact in new.facts:
        after.setdefault(fact.number, []).append(fact)
    return sum(any(_survives(one, other) for other in after.get(one.number, ())) for one in old.facts)


def _survives(old: Fact, new: Fact) -> bool:
    return same_field(old, new) if old.type and new.type else old[1:3] == new[1:3]


def nearly_the_same(old: Content, new: Content, left: int) -> bool:
    """Return True if at least two thirds of the fields of the smaller content are left.

    ``left`` is the number of old fields that the new content still has; see `survivors`.
    """
    # The smaller content counts: a message that only got more fields, as protobuf allows, is still the same one.
    return left * 3 >= 2 * min(len(old.facts), len(new.facts))


def is_telling(old: Content, new: Content) -> bool:
    """Return True if both contents have so many fields (at least two) that they are hardly equal by chance."""
    return min(len(old.facts), len(new.facts)) >= _TELLING


def replaced(old: Content, new: Content, left: int) -> bool:
    """Return True if fewer than a third of the old fields are left, and new fields took some of the old numbers.

    ``left`` is the number of old fields that the new content still has; see `survivors`.
    """
    numbers = {fact.number for fact in new.facts}
    gone = [fact for fact in old.facts if fact.number not in numbers]
    # A message that lost fields without replacement is misread by nobody: its old numbers are unknown fields.
    return len(old.facts) >= _FEWEST and left * 3 < len(old.facts) and left + len(gone) < len(old.facts)


class ValueNames:
    """Comparison of the names of an enum's values, without the words that most of the names share.

    In an enum ``GpsFix``, the words ``gps`` and ``fix`` of ``GPS_FIX_NONE`` do not count.
    """

    def __init__(self, owner: str, names: Collection[str]) -> None:
        # Protobuf's style guide asks for the enum's name as prefix of every value (`GPS_FIX_NONE`). Such a word would
        # make all values of an enum alike.
        of_owner = frozenset(words(simple(owner)))
        counts: dict[str, int] = {}
        for name in set(names):
            for word in set(words(name)):
                counts[word] = counts.get(word, 0) + 1
        many = len(set(names))
        self._common = of_owner | {word for word, count in counts.items() if many > _FEWEST and count * 2 > many}

    def share_a_word(self, old: str, new: str) -> bool:
        """Return True if two value names share a word which is not part of most value names."""
        return alike(self._own(old), self._own(new))

    def _own(self, name: str) -> str:
        return "_".join(word for word in words(name) if word not in self._common) or name
