"""Comparison of two names by their words: decides if both may name the same thing.

Two names are similar if they have the same words in any spelling style, form (plural, usual short form) or order, or
if one name only has a qualifier more. They are doubtful if the words are synonyms, nearly have the same letters, or if
the additional word may change the quantity. They are different in all other cases, and whenever two words are
opposites, such as `left` and `right`, or differ in a number.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from functools import lru_cache
from itertools import product
from typing import NamedTuple

from roverlink.generator.lint.names.name_units import is_unit, measure
from roverlink.generator.lint.names.name_words import words
from roverlink.generator.lint.names.word_groups import (
    CHANGE_THE_QUANTITY,
    DIRECTED,
    FILLERS,
    NEGATIONS,
    are_synonyms,
    base,
    sides,
)

_SHORTEST_MISSPELT = 5  # `mode` and `made` differ by one letter as well
_LETTERS_PER_MISTAKE = 4
_SHORTEST_STEM = 3
_WORDS_OF_ONE_THING = 3  # `front_wheel_speed` and `front_arm_speed` are two things


class Likeness(Enum):
    """Result of the comparison of two names."""

    SAME = "the same name"
    SIMILAR = "another spelling, form, order or qualifier"
    DOUBTFUL = "names that may or may not mean the same"
    DIFFERENT = "names of different things"
    OPPOSITE = "names of things that must not be mixed up, such as left and right"


class Comparison(NamedTuple):
    """Result of the comparison of two names, with the reason as a clause; empty for the same and for similar names."""

    likeness: Likeness
    reason: str = ""


class _Word(NamedTuple):
    base: str
    """The form of the word that is compared."""
    written: str


@lru_cache(maxsize=1 << 16)
def compare_names(old: str, new: str, shared: frozenset[str] = frozenset()) -> Comparison:
    """Compare two names. The result does not depend on which of them is the older one.

    ``shared`` are words that say nothing, because all names that could stand here have them. Units are not compared;
    see the module ``name_units``.
    """
    if old == new:
        return Comparison(Likeness.SAME)
    before, after = _words(old, shared), _words(new, shared)
    if reason := _opposites(before, after) or _turned_around(before, after):
        return Comparison(Likeness.OPPOSITE, reason)
    if _letters(before) == _letters(after):
        return Comparison(Likeness.SIMILAR)
    return _compare_words(*_subjects(before, after))


def is_telling(name: str, shared: frozenset[str] = frozenset()) -> bool:
    """Return True if two things hardly have this name by chance: False for ``x``, ``value`` and ``data_2``."""
    return any(
        len(word.base) > 1 and not word.base.isdigit() and word.base not in FILLERS for word in _words(name, shared)
    )


@lru_cache(maxsize=1 << 16)
def _words(name: str, shared: frozenset[str]) -> tuple[_Word, ...]:
    split = tuple(_Word(base(word), word) for word in words(name))
    # Words such as `left` say something even if most of the names have them.
    return tuple(word for word in split if word.base not in shared or sides(word.base)) or split


def _letters(name: Sequence[_Word]) -> str:
    # `1_1` and `11` are not the same.
    return "".join(f"_{word.base}_" if word.base.isdigit() else word.base for word in name)


def _opposites(before: Sequence[_Word], after: Sequence[_Word]) -> str:
    """Return why two names are opposites; empty if they are not."""
    groups = {group for word in before for group in sides(word.base)}
    for group in sorted(groups):
        old, new = _in_group(before, group), _in_group(after, group)
        only_old = [word for side, word in old.items() if side not in new]
        only_new = [word for side, word in new.items() if side not in old]
        # `reach_m` and `time_s` end with units, and `sensor_a` and `sensor_b` do not.
        if only_old and only_new and not all(map(is_unit, (*only_old, *only_new))):
            return f"{only_old[0]!r} and {only_new[0]!r} are not the same"
        if [*old] != [*new] and not only_old and not only_new:
            return f"{' and '.join(map(repr, old.values()))} changed places"
    return ""


def _in_group(name: Sequence[_Word], group: str) -> dict[int | str, str]:
    found = [(sides(word.base)[group], word.written) for word in name if group in sides(word.base)]
    return dict(found)


def _turned_around(before: Sequence[_Word], after: Sequence[_Word]) -> str:
    """Return why `a_to_b` is not `b_to_a`; empty if the names contain no such words, or have the same order."""
    old, new = [word.base for word in before], [word.base for word in after]
    directed = not DIRECTED.isdisjoint(old) and not DIRECTED.isdisjoint(new)
    turned = [word for word in old if word in new] != [word for word in new if word in old]
    return "the words stand in another order" if directed and turned else ""


def _subjects(before: Sequence[_Word], after: Sequence[_Word]) -> tuple[list[_Word], list[_Word]]:
    """Return the words of two names that say what is meant: without units, fillers, and words like `delta`."""
    old, new = _measured(before), _measured(after)
    # The unit of one name may be the quantity of the other one: `item_counts` and `counts`.
    old, new = (
        old + [word for word in before if word not in old and word.base in {other.base for other in new}],
        new + [word for word in after if word not in new and word.base in {other.base for other in old}],
    )
    telling = [[word for word in name if word.base not in FILLERS] for name in (old, new)]
    return (telling[0], telling[1]) if all(telling) else (old, new)


def _measured(name: Sequence[_Word]) -> list[_Word]:
    measured = measure([word.written for word in name]).words
    return [word for word in name if word.written in measured]


def _compare_words(old: list[_Word], new: list[_Word]) -> Comparison:
    count, heads = len(old), {old[-1], new[-1]}
    doubts = list(_pair_off(old, new))
    if old and new:
        # A name such as `value` may stand for everything.
        empty = any(all(word.base in FILLERS for word in name) for name in (old, new))
        # A word in the middle of a long name may be another word for the same: `range_test_plugin_enabled` and
        # `range_test_module_enabled`. The last word says which quantity it is.
        one_of_many = len(old) == len(new) == 1 and count > _WORDS_OF_ONE_THING and heads.isdisjoint([*old, *new])
        likeness = Likeness.DOUBTFUL if empty or one_of_many else Likeness.DIFFERENT
        return Comparison(likeness, f"{_quoted(old)} and {_quoted(new)} are different words")
    added = [*old, *new]
    if negated := [word for word in added if word.base in NEGATIONS]:
        return Comparison(Likeness.OPPOSITE, f"only one of the names has {_quoted(negated)}")
    changing = [word for word in added if sides(word.base) or word.base in CHANGE_THE_QUANTITY]
    if changing:
        doubts.insert(0, f"only one of the names has {_quoted(changing)}")
    return Comparison(Likeness.DOUBTFUL, doubts[0]) if doubts else Comparison(Likeness.SIMILAR)


def _quoted(some: Sequence[_Word]) -> str:
    return repr(" ".join(word.written for word in some))


def _pair_off(old: list[_Word], new: list[_Word]) -> Iterator[str]:
    """Remove each word that has a counterpart in the other name, and yield the reasons for doubts about the pairs."""
    tests: list[tuple[Callable[[str, str], bool], str]] = [
        (str.__eq__, ""),
        (are_synonyms, "{} and {} often mean the same, but not always"),
        (_has_same_stem, "{} and {} may be forms of the same word"),
        (_is_misspelt, "{} and {} nearly have the same letters: it may be a correction"),
        (_is_shortened, "one of {} and {} may be short for the other"),
    ]
    for alike, doubt in tests:
        # Sorted without regard to the side, so that the pairs are the same in both directions.
        for one, other in sorted(product(old, new), key=sorted):
            if one in old and other in new and alike(one.base, other.base):
                old.remove(one)
                new.remove(other)
                if doubt:
                    yield doubt.format(repr(one.written), repr(other.written))


def _is_misspelt(one: str, other: str) -> bool:
    """Return True if the words differ by few letters in relation to their length, and begin with the same letter."""
    # Mistakes are rare in the first letter, but other words often differ in it: `light` and `right`.
    shorter, longer = sorted((one, other), key=len)
    allowed = len(longer) // _LETTERS_PER_MISTAKE
    return len(shorter) >= _SHORTEST_MISSPELT and one[0] == other[0] and _distance(one, other) <= allowed


def _distance(one: str, other: str) -> int:
    """Return how many letters have to be added, dropped, replaced or exchanged with the next to get the other word."""
    before: list[int] = []
    last = list(range(len(other) + 1))
    for row, letter in enumerate(one, 1):
        current = [row]
        for column, against in enumerate(other, 1):
            cheapest = min(last[column] + 1, current[-1] + 1, last[column - 1] + (letter != against))
            if row > 1 and column > 1 and letter == other[column - 2] and against == one[row - 2]:
                cheapest = min(cheapest, before[column - 2] + 1)
            current.append(cheapest)
        before, last = last, current
    return last[-1]


def _has_same_stem(one: str, other: str) -> bool:
    """Return True if only the endings differ, as in ``drive`` and ``driving``, but also in ``rate`` and ``rating``."""
    stems = [re.sub("(e|ed|ing)$", "", word) for word in (one, other)]
    return stems[0] == stems[1] and len(stems[0]) > _SHORTEST_STEM


def _is_shortened(one: str, other: str) -> bool:
    """Return True if one word begins with the other one, or if one word is the other one without vowels."""
    shorter, longer = sorted((one, other), key=len)
    if len(shorter) < _SHORTEST_STEM or shorter[0] != longer[0]:
        return False
    rest = iter(longer)
    return longer.startswith(shorter) or (
        set("aeiou").isdisjoint(shorter[1:]) and all(letter in rest for letter in shorter)
    )
