"""Evidence that a type which one commit removes goes on as a type which the same commit adds.

A type is a message or an enum. A commit that moves a file, changes a package, renames a type, or nests it in another
message, removes the type under one full name and adds it under another. This module pairs removed and added types, one
to one, the clearest evidence first:

1. They have the same full name: the file moved.
2. They have the same name in another package or message, and most fields of all types that moved between the same two
   places agree. So a message with few fields is judged together with its neighbours.
3. They have different names, and most of their own fields agree, or the added type has all fields of the removed one.
   The fields of very small messages prove little, so their names must be similar, too.

If a message goes on under another name, the types inside it follow it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from posixpath import basename
from typing import NamedTuple, TypeVar

from roverlink.generator.lint.history.judged_facts import same_field
from roverlink.generator.lint.history.numbered_types import NumberedType
from roverlink.generator.lint.names.similar_names import Likeness, compare_names, is_telling
from roverlink.generator.protos.schema import Fact

_Key = TypeVar("_Key")

_MOST_PAIRS = 10_000  # types of one name that are compared each with each
_MOST_ALIKE = 50  # added types with a field of the same number and name, which are compared with a removed one
_ALIKE = (Likeness.SAME, Likeness.SIMILAR, Likeness.DOUBTFUL)
_TELLING = 2  # one equal field proves nothing: half of all messages have a single field


class Place(NamedTuple):
    """Path of the file and full name of a declared message or enum."""

    path: str
    name: str


Declarations = Mapping[Place, NumberedType]


def continuations(removed: Declarations, added: Declarations) -> dict[Place, Place]:
    """Return the place of the removed type for each added type that continues a removed type.

    Both contain the declarations of one commit. A message never continues an enum.
    """
    matching = _Matching(removed, added)
    matching.take_same_names()
    matching.take_moved()
    matching.take_renamed()
    return matching.found


def equal(one: NumberedType, other: NumberedType) -> bool:
    """Return True if two types declare the same fields or values; lines and comments may differ."""
    ours, theirs = ({fact for fact in type.facts if not fact.claimed} for type in (one, other))
    return one.enum == other.enum and ours == theirs


@dataclass(frozen=True, slots=True)
class _Agreement:
    """The number of fields or values of a removed and an added type (or of several types) that agree."""

    agreed: int
    weight: int
    """Like ``agreed``, but names that many messages have, such as ``x``, do not count, and a member of a oneof counts
    twice: its type and name are specific to one message."""
    smaller: int
    """The number of fields or values of the type that has fewer."""
    larger: int
    removed: int
    """The number of fields or values of the removed type."""

    @property
    def most(self) -> bool:
        """True if most fields of both types agree."""
        return self.larger > 0 and self.agreed * 3 >= self.smaller * 2 and self.agreed * 2 >= self.larger

    @property
    def survives(self) -> bool:
        """True if the added type has all fields of the removed one, however many others it has."""
        return self.agreed == self.removed > 0

    @property
    def telling(self) -> bool:
        """True if so many fields agree that they are hardly equal by chance."""
        return self.weight >= _TELLING

    @property
    def ratio(self) -> float:
        """The share of the fields that agree, from 0 to 1."""
        return self.agreed / self.larger if self.larger else 0.0


class _Matching:
    def __init__(self, removed: Declarations, added: Declarations) -> None:
        self.found: dict[Place, Place] = {}
        self._removed, self._added = dict(sorted(removed.items())), dict(sorted(added.items()))
        self._messages = {place for all in (removed, added) for place, type in all.items() if not type.enum}
        self._inside = _grouped(self._removed, lambda place: [_container(place)])
        self._contents: dict[NumberedType, _Content] = {}

    def take_same_names(self) -> None:
        """Pair the types that have the same full name in another file."""
        by_name = _grouped(self._added, lambda place: [place.name])
        ranked = [
            (basename(removed.path) != basename(other.path), -self._agreement(removed, other).ratio, removed, other)
            for removed in self._removed
            for other in by_name.get(removed.name, ())
            if self._same_kind(removed, other)
        ]
        for *_, one, other in sorted(ranked):
            self._take(one, other)

    def take_moved(self) -> None:
        """Pair the types that have the same name in another package or in another message."""
        # The types inside other ones follow these, and are compared on their own only if they are left.
        for outer in (True, False):
            groups: dict[tuple[str, str, str, str], list[tuple[Place, Place]]] = {}
            for one, other in self._with_common_name(outer):
                groups.setdefault((one.path, other.path, *_scopes(one.name, other.name)), []).append((one, other))
            judged = [(_sum(self._agreement(*pair) for pair in pairs), key, pairs) for key, pairs in groups.items()]
            judged.sort(key=lambda group: (-group[0].ratio, -group[0].agreed, group[1]))
            for agreement, key, pairs in judged:
                if self._is_move(agreement, *key):
                    for one, other in pairs:
                        self._take(one, other)

    def _with_common_name(self, outer: bool) -> Iterator[tuple[Place, Place]]:
        """Yield the pairs of types with the same name in different packages or messages.

        ``outer`` selects the types that are not inside other types of the commit.
        """
        removed, added = (
            [place for place in places if not (outer and _container(place) in self._messages)]
            for places in (self._removed, self._added)
        )
        ours, theirs = (_grouped(places, lambda place: [_simple(place.name)]) for places in (removed, added))
        for name in ours.keys() & theirs.keys():
            # A commit that replaces a thousand messages may have a thousand enums `Type`.
            few = len(ours[name]) * len(theirs[name]) <= _MOST_PAIRS
            for one, other in product(ours[name], theirs[name]):
                if self._same_kind(one, other) and (few or basename(one.path) == basename(other.path)):
                    yield one, other

    def _is_move(self, agreement: _Agreement, old_path: str, new_path: str, old_scope: str, new_scope: str) -> bool:
        """Return True if the types of one package or message in a file moved to another one.

        ``agreement`` is that of all these types. In one file, the same names in a new package are evidence, too.
        """
        unrelated = {Place(old_path, old_scope), Place(new_path, new_scope)} <= self._messages
        if old_path == new_path and not unrelated:
            return agreement.agreed * 2 >= agreement.larger
        return agreement.most and (basename(old_path) == basename(new_path) or agreement.telling)

    def take_renamed(self) -> None:
        """Pair the types that have another name and most of their fields."""
        ranked = []
        for one, other in self._with_common_fields():
            agreement, likeness = self._agreement(one, other), _likeness(one, other)
            if likeness is Likeness.OPPOSITE or not (agreement.most or agreement.survives):
                continue
            if agreement.telling or self._is_tiny_rename(one, other, agreement):
                far = (one.path != other.path, likeness not in _ALIKE)
                ranked.append((-agreement.ratio, -agreement.agreed, *far, one, other))
        for *_, one, other in sorted(ranked):
            self._take(one, other)

    def _is_tiny_rename(self, one: Place, other: Place, agreement: _Agreement) -> bool:
        return one.path == other.path and agreement.ratio == 1 and _likeness(one, other) in _ALIKE

    def _with_common_fields(self) -> Iterator[tuple[Place, Place]]:
        """Yield the pairs of types with a common field or value that few others of the commit have."""
        by_field = _grouped(self._added, lambda place: self._content(self._added[place]).keys)
        for one, type in self._removed.items():
            shared = (by_field.get(key, ()) for key in self._content(type).keys)
            others = {other for places in shared if len(places) <= _MOST_ALIKE for other in places}
            yield from ((one, other) for other in sorted(others) if self._same_kind(one, other))

    def _same_kind(self, one: Place, other: Place) -> bool:
        return self._removed[one].enum == self._added[other].enum

    def _agreement(self, one: Place, other: Place) -> _Agreement:
        return _agreement(self._content(self._removed[one]), self._content(self._added[other]))

    def _content(self, type: NumberedType) -> _Content:
        if type not in self._contents:
            self._contents[type] = _content(type)
        return self._contents[type]

    def _take(self, one: Place, other: Place) -> None:
        """Record that the removed type ``one`` goes on as ``other``, and so do the types inside it.

        Nothing is recorded if one of the two already has another partner.
        """
        if one not in self._removed or other not in self._added:
            return
        self.found[other] = one
        del self._removed[one], self._added[other]
        for place in self._inside.get(one, ()):
            follower = Place(other.path, f"{other.name}.{_simple(place.name)}")
            if follower in self._added and place in self._removed and self._same_kind(place, follower):
                self._take(place, follower)


def _simple(full_name: str) -> str:
    return full_name.rpartition(".")[2]


def _likeness(one: Place, other: Place) -> Likeness:
    """Compare the names of two types, without their packages and the messages around them."""
    return compare_names(_simple(one.name), _simple(other.name)).likeness


@dataclass(frozen=True, slots=True)
class _Content:
    """The fields of a message, or the values of an enum, as they are compared."""

    parts: list[tuple[Fact, str]]
    """Each field or value, with its name; names of values are without the words that all values begin with."""
    by_number: dict[int, list[tuple[Fact, str]]]
    keys: set[tuple[int, str]]
    """Number and name of each field or value."""


def _content(type: NumberedType) -> _Content:
    facts = [fact for fact in type.facts if not fact.claimed]
    parts = list(zip(facts, _own_names(facts) if type.enum else (fact.name for fact in facts)))
    by_number: dict[int, list[tuple[Fact, str]]] = {}
    for fact, name in parts:
        by_number.setdefault(fact.number, []).append((fact, name))
    return _Content(parts, by_number, {(fact.number, name) for fact, name in parts})


def _agreement(old: _Content, new: _Content) -> _Agreement:
    """Return how many fields or values of a removed and an added type have the same number and the same meaning."""
    agreeing = [
        (fact, name)
        for fact, name in old.parts
        if any(_agree(fact, name, other, other_name) for other, other_name in new.by_number.get(fact.number, ()))
    ]
    smaller, larger = sorted((len(old.parts), len(new.parts)))
    weight = sum(2 if fact.oneof else 1 for fact, name in agreeing if is_telling(name))
    return _Agreement(len(agreeing), weight, smaller, larger, len(old.parts))


def _agree(fact: Fact, name: str, other: Fact, other_name: str) -> bool:
    """Return True if two fields, or two enum values with the same number, have the same meaning."""
    if fact.type and other.type:
        return same_field(fact, other)
    return not (fact.type or other.type) and (name == other_name or fact.name == other.name)


def _sum(agreements: Iterable[_Agreement]) -> _Agreement:
    all = list(agreements)
    return _Agreement(
        sum(agreement.agreed for agreement in all),
        sum(agreement.weight for agreement in all),
        sum(agreement.smaller for agreement in all),
        sum(agreement.larger for agreement in all),
        sum(agreement.removed for agreement in all),
    )


def _own_names(values: list[Fact]) -> list[str]:
    """Return the names of an enum's values without the words that all of them begin with: ``NONE`` for ``GPS_NONE``."""
    names = [value.name.split("_") for value in values]
    common = 0
    while len(names) > 1 and all(len(name) > common + 1 and name[common] == names[0][common] for name in names):
        common += 1
    return ["_".join(name[common:]) for name in names]


def _scopes(one: str, other: str) -> tuple[str, str]:
    """Return the beginnings of two full names that differ: ``a`` and ``b.C`` for ``a.Imu.Mode``, ``b.C.Imu.Mode``."""
    ours, theirs = one.split("."), other.split(".")
    while ours and theirs and ours[-1] == theirs[-1]:
        ours.pop()
        theirs.pop()
    return ".".join(ours), ".".join(theirs)


def _container(place: Place) -> Place:
    """Return the place of the message, or of the package, that contains a type."""
    return Place(place.path, place.name.rpartition(".")[0])


def _grouped(places: Iterable[Place], keys: Callable[[Place], Iterable[_Key]]) -> dict[_Key, list[Place]]:
    """Return the places by each of their keys."""
    found: dict[_Key, list[Place]] = {}
    for place in places:
        for key in keys(place):
            found.setdefault(key, []).append(place)
    return found
