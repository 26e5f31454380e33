"""Evidence that a type which one commit removes goes on as a type which the same commit adds.

A type is a message or an enum. A commit that moves a file, changes a package, renames a type, or nests it in another
message, removes the type under one full name and adds it under another. This module pairs removed and added types, one
to one, the clearest evidence first:

1. They have the same full name: the file moved.
2. They have the same name in another package or message, and most fields of all types that moved between the same two
   places agree. So a message with few fields is judged together with its neighbours.
3. They have different names, and most of their own fields agree. The fields of very small messages prove little, so
   their names must be similar, too.

If a message goes on under another name, the types inside it follow it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from posixpath import basename
from typing import NamedTuple, TypeVar

from roverlink.generator.lint.history.numbered_types import NumberedType
from roverlink.generator.lint.history.same_meaning import alike, same_field, simple
from roverlink.generator.protos.schema import Fact

_Key = TypeVar("_Key")

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
    return one.enum == other.enum and set(_declared(one)) == set(_declared(other))


@dataclass(frozen=True, slots=True)
class _Agreement:
    """The number of fields or values of a removed and an added type (or of several types) that agree."""

    agreed: int
    weight: int
    """Like ``agreed``, but a member of a oneof counts twice: its type and name are specific to one message."""
    smaller: int
    """The number of fields or values of the type that has fewer."""
    larger: int

    @property
    def most(self) -> bool:
        """True if most fields of both types agree."""
        return self.larger > 0 and self.agreed * 3 >= self.smaller * 2 and self.agreed * 2 >= self.larger

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

    def take_same_names(self) -> None:
        """Pair the types that have the same full name in another file."""
        by_name = _grouped(self._added, lambda place: [place.name])
        ranked = [
            (basename(one.path) != basename(other.path), -self._agreement(one, other).ratio, one, other)
            for one in self._removed
            for other in by_name.get(one.name, ())
            if self._same_kind(one, other)
        ]
        for *_, one, other in sorted(ranked):
            self._take(one, other)

    def take_moved(self) -> None:
        """Pair the types that have the same name in another package or in another message."""
        by_name = _grouped(self._added, lambda place: [simple(place.name)])
        # Key: both files, and both packages or messages without the parts of the names that are the same.
        groups: dict[tuple[str, str, str, str], list[tuple[Place, Place]]] = {}
        for one in self._removed:
            for other in by_name.get(simple(one.name), ()):
                if self._same_kind(one, other):
                    groups.setdefault((one.path, other.path, *_scopes(one.name, other.name)), []).append((one, other))
        judged = [(_sum(self._agreement(*pair) for pair in pairs), key, pairs) for key, pairs in groups.items()]
        for agreement, key, pairs in sorted(judged, key=lambda each: (-each[0].ratio, -each[0].agreed, each[1])):
            if self._is_move(agreement, *key):
                for one, other in pairs:
                    self._take(one, other)

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
        for one, other in self._with_common_numbers():
            agreement = self._agreement(one, other)
            if agreement.most and (agreement.telling or self._is_tiny_rename(one, other, agreement)):
                far = (one.path != other.path, not alike(simple(one.name), simple(other.name)))
                ranked.append((-agreement.ratio, -agreement.agreed, *far, one, other))
        for *_, one, other in sorted(ranked):
            self._take(one, other)

    def _is_tiny_rename(self, one: Place, other: Place, agreement: _Agreement) -> bool:
        return one.path == other.path and agreement.ratio == 1 and alike(simple(one.name), simple(other.name))

    def _with_common_numbers(self) -> Iterable[tuple[Place, Place]]:
        """Yield the pairs of types with a common field: all pairs of a large commit would be too many to compare."""
        by_field = _grouped(self._added, lambda place: _keys(self._added[place]))
        for one, type in self._removed.items():
            others = {other for key in _keys(type) for other in by_field.get(key, ())}
            yield from ((one, other) for other in sorted(others))

    def _same_kind(self, one: Place, other: Place) -> bool:
        return self._removed[one].enum == self._added[other].enum

    def _agreement(self, one: Place, other: Place) -> _Agreement:
        return _agreement(self._removed[one], self._added[other])

    def _take(self, one: Place, other: Place) -> None:
        """Record that the removed type ``one`` goes on as ``other``, and so do the types inside it.

        Nothing is recorded if one of the two already has another partner.
        """
        if one not in self._removed or other not in self._added:
            return
        self.found[other] = one
        message = not self._removed.pop(one).enum
        del self._added[other]
        inside = [place for place in self._removed if place.path == one.path and _is_in(place.name, one.name)]
        for place in inside if message else ():
            follower = Place(other.path, other.name + place.name[len(one.name) :])
            if follower in self._added and place in self._removed and self._same_kind(place, follower):
                self._take(place, follower)


def _agreement(old: NumberedType, new: NumberedType) -> _Agreement:
    """Return how many fields or values of a removed and an added type have the same number and the same meaning."""
    ours, theirs = _declared(old), _declared(new)
    if old.enum != new.enum:
        agreeing: list[Fact] = []
    elif old.enum:
        named = {(number, name) for number, name in zip((fact.number for fact in theirs), _own_names(theirs))}
        whole = {(fact.number, fact.name) for fact in theirs}
        names = zip(ours, _own_names(ours))
        agreeing = [f for f, own in names if (f.number, own) in named or (f.number, f.name) in whole]
    else:
        by_number: dict[int, list[Fact]] = {}
        for fact in theirs:
            by_number.setdefault(fact.number, []).append(fact)
        agreeing = [fact for fact in ours if any(same_field(fact, one) for one in by_number.get(fact.number, ()))]
    sizes = sorted((len(ours), len(theirs)))
    return _Agreement(len(agreeing), sum(2 if fact.oneof else 1 for fact in agreeing), sizes[0], sizes[1])


def _sum(agreements: Iterable[_Agreement]) -> _Agreement:
    all = list(agreements)
    return _Agreement(
        sum(one.agreed for one in all),
        sum(one.weight for one in all),
        sum(one.smaller for one in all),
        sum(one.larger for one in all),
    )


def _declared(type: NumberedType) -> list[Fact]:
    return [fact for fact in type.facts if not fact.claimed]


def _own_names(values: list[Fact]) -> list[str]:
    """Return the names of an enum's values without the words that all of them begin with: ``NONE`` for ``GPS_NONE``."""
    names = [value.name.split("_") for value in values]
    common = 0
    while len(names) > 1 and all(len(name) > common + 1 and name[common] == names[0][common] for name in names):
        common += 1
    return ["_".join(name[common:]) for name in names]


def _keys(type: NumberedType) -> set[tuple[bool, int, str]]:
    """Return keys that two agreeing types have in common: kind and number, and for a field its type, if a scalar."""
    return {(type.enum, fact.number, simple(fact.type)) for fact in _declared(type)}


def _scopes(one: str, other: str) -> tuple[str, str]:
    """Return the beginnings of two full names that differ: ``a`` and ``b.C`` for ``a.Imu.Mode``, ``b.C.Imu.Mode``."""
    ours, theirs = one.split("."), other.split(".")
    while ours and theirs and ours[-1] == theirs[-1]:
        ours.pop()
        theirs.pop()
    return ".".join(ours), ".".join(theirs)


def _is_in(name: str, message: str) -> bool:
    return name.startswith(f"{message}.")


def _grouped(places: Iterable[Place], keys: Callable[[Place], Iterable[_Key]]) -> dict[_Key, list[Place]]:
    """Return the places by each of their keys."""
    found: dict[_Key, list[Place]] = {}
    for place in places:
        for key in keys(place):
            found.setdefault(key, []).append(place)
    return found
