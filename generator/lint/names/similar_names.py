"""Comparison of two names by their words: decides if both may name the same thing.

Two names are similar if they have the same words in any spelling style, form (plural, usual short form) or order, or
if one name only has a qualifier more. They are doubtful if the words are synonyms, nearly have the same letters, or if
the additional word may change the quantity. They are different in all other cases, and whenever two words are
opposites, such as `left` and `right`, or differ in a number.

Names that seem to be different are compared once more with compound words split: `filepath` becomes `file path`. A
split is a guess, so that such names are doubtful at best.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from enum import Enum
from functools import lru_cache
from itertools import product
from posixpath import commonprefix
from typing import NamedTuple

from roverlink.generator.lint.names.name_units import is_unit, measure
from roverlink.generator.lint.names.name_words import written_words
from roverlink.generator.lint.names.word_groups import (
    CHANGE_THE_QUANTITY,
    DIRECTED,
    FILLERS,
    NEGATIONS,
    PLACEHOLDERS,
    are_synonyms,
    base,
    is_known,
    negates,
    sides,
    split,
)

_SHORTEST_MISSPELT = 5  # `mode` and `made` differ by one letter as well
_LETTERS_PER_MISTAKE = 4
_SHORTEST_STEM = 3
_LONG_STEM = 7  # `substitute` and `substitution`, but not `position` and `positive`
_WORDS_OF_ONE_THING = 3  # `front_wheel_speed` and `front_arm_speed` are two things
_RENAMES = re.compile(r"\b(renam|typo|(mis)?spell)", re.IGNORECASE)
_LETTERS_OF_ONE_SERIES = 3
_LETTERS_OF_TYPES = {"f": "float", "d": "double"}  # as in `Vector3f`


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
    shown: str
    """The word in texts for users; see `Written`."""


@lru_cache(maxsize=1 << 16)
def compare_names(
    old: str, new: str, shared: frozenset[str] = frozenset(), beside: frozenset[str] = frozenset()
) -> Comparison:
    """Compare two names. The result does not depend on which of them is the older one.

    ``shared`` are words that say nothing, because all names that could stand here have them. ``beside`` are the words
    of the names beside these, of which compound words may be made. Units are not compared; see the module
    ``name_units``.
    """
    if old == new:
        return Comparison(Likeness.SAME)
    whole = _words(old), _words(new)
    telling = [_without(shared, name) for name in whole]
    # A name of shared words only may have lost a word: `ERROR_OF_SENSOR` and `ERROR`.
    before, after = telling if all(telling) else whole
    found = _compare(before, after)
    if found.likeness is not Likeness.DIFFERENT:
        return found
    divided = [_divided(name, beside.union(word.written for word in (*before, *after))) for name in (before, after)]
    again = _compare(*divided)
    if again.likeness in (Likeness.DIFFERENT, Likeness.OPPOSITE):
        return again if again.likeness is Likeness.OPPOSITE else found
    compounds = [word for word in (*before, *after) if word not in (*divided[0], *divided[1])]
    return Comparison(Likeness.DOUBTFUL, f"{_quoted(compounds)} may be made of several words")


def _divided(name: Sequence[_Word], beside: frozenset[str]) -> tuple[_Word, ...]:
    """Return the words of a name with compound words split."""
    parts = ((part, word) for word in name for part in split(word.written, beside))
    return tuple(word if part == word.written else _Word(base(part), part, part) for part, word in parts)


def _compare(before: Sequence[_Word], after: Sequence[_Word]) -> Comparison:
    if reason := _opposites(before, after) or _turned_around(before, after):
        return Comparison(Likeness.OPPOSITE, reason)
    if _letters(before) == _letters(after):
        return Comparison(Likeness.SIMILAR)
    return _compare_words(*_subjects(before, after))


@lru_cache(maxsize=1 << 16)
def is_telling(name: str, shared: frozenset[str] = frozenset()) -> bool:
    """Return True if two things hardly have this name by chance: False for ``x``, ``value`` and ``data_2``."""
    return any(
        len(word.base) > 1 and not word.base.isdigit() and word.base not in FILLERS
        for word in _without(shared, _words(name))
    )


def is_called_a_rename(text: str, owner: str, old: str, new: str, shared: frozenset[str]) -> bool:
    """Return True if the subject of a commit says that it renames, with a word of one of two names or of their owner.

    A word that both names have does not count. ``owner`` is the full name of their message or enum. ``shared`` are
    words that say nothing; see `compare_names`.
    """
    of_types = [word_bases(part) for part in owner.split(".") if not part.islower()]  # packages are in small letters
    renamed = frozenset[str]().union((word_bases(old) ^ word_bases(new)) - shared, *of_types) - FILLERS
    return _RENAMES.search(text) is not None and any(
        one == other or _has_same_stem(one, other) for one, other in product(word_bases(text), renamed)
    )


@lru_cache(maxsize=1 << 16)
def word_bases(name: str) -> frozenset[str]:
    """Return the words of a name, in the form in which words are compared."""
    return frozenset(word.base for word in _words(name))


@lru_cache(maxsize=1 << 16)
def _words(name: str) -> tuple[_Word, ...]:
    return tuple(_Word(base(word), word, shown) for word, shown in written_words(name))


def _without(shared: frozenset[str], name: Sequence[_Word]) -> tuple[_Word, ...]:
    """Return the words of a name that not all names have."""
    # Words such as `left` say something even if most of the names have them.
    return tuple(word for word in name if word.base not in shared or sides(word.base))


def _letters(name: Sequence[_Word]) -> str:
    # `1_1` and `11` are not the same.
    return "".join(f"_{word.base}_" if word.base.isdigit() else word.base for word in name)


def _opposites(before: Sequence[_Word], after: Sequence[_Word]) -> str:
    """Return why two names are opposites; empty if they are not."""
    rests = _remaining(before, after), _remaining(after, before)
    for group in sorted({group for word in before for group in sides(word.base)}):
        old, new = _in_group(before, group), _in_group(after, group)
        only_old = [word for side, word in old.items() if side not in new]
        only_new = [word for side, word in new.items() if side not in old]
        if only_old and only_new and not _are_units([*only_old, *only_new], rests):
            others = [[word for word in rest if group not in sides(word.base)] for rest in rests]
            # `3` and `5` are no reason to tell `M5STACK` from `HELTEC_V3`.
            return _different(*rests) if all(others) else _not_the_same(only_old[0], only_new[0])
        if [*old] != [*new] and not only_old and not only_new:
            return f"{' and '.join(repr(word.written) for word in old.values())} changed places"
    return ""


def _remaining(name: Sequence[_Word], other: Sequence[_Word]) -> list[_Word]:
    """Return the words of a name that the other name does not have."""
    bases = {word.base for word in other}
    return [word for word in name if word.base not in bases]


def _are_units(words: Sequence[_Word], rests: Sequence[Sequence[_Word]]) -> bool:
    """Return True if words on two sides are perhaps units, and not sides: in `reach_m` and `time_s`.

    `sensor_a` and `sensor_b` differ only in their letters, and these are sides. `z` and `m` of `altitude_z` and
    `absolute_altitude_m` are far from each other in the alphabet.
    """
    units = [is_unit(word.written) for word in words]
    if all(units) or not any(units) or any(len(word.base) > 1 for word in words):
        return all(units)
    letters = [ord(word.base) for word in words]
    return any(len(rest) > 1 for rest in rests) and max(letters) - min(letters) > _LETTERS_OF_ONE_SERIES


def _not_the_same(*words: _Word) -> str:
    kinds = [_LETTERS_OF_TYPES.get(word.base, "") for word in words]
    shown = (f"{word.shown!r} ({kind})" if all(kinds) else repr(word.written) for word, kind in zip(words, kinds))
    return f"{' and '.join(shown)} are not the same"


def _different(old: Sequence[_Word], new: Sequence[_Word]) -> str:
    return f"{_quoted(old)} and {_quoted(new)} are different words"


def _in_group(name: Sequence[_Word], group: str) -> dict[int | str, _Word]:
    return {sides(word.base)[group]: word for word in name if group in sides(word.base)}


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
        empty = any(map(_is_empty, (old, new)))
        # A word in the middle of a long name may be another word for the same: `range_test_plugin_enabled` and
        # `range_test_module_enabled`. The last word says which quantity it is.
        one_of_many = len(old) == len(new) == 1 and count > _WORDS_OF_ONE_THING and heads.isdisjoint([*old, *new])
        likeness = Likeness.DOUBTFUL if empty or one_of_many else Likeness.DIFFERENT
        return Comparison(likeness, _different(old, new))
    added = [*old, *new]
    if negated := [word for word in added if word.base in NEGATIONS]:
        return Comparison(Likeness.OPPOSITE, f"only one of the names has {_quoted(negated)}")
    changing = [word for word in added if sides(word.base) or word.base in CHANGE_THE_QUANTITY]
    if changing:
        doubts.insert(0, f"only one of the names has {_quoted(changing)}")
    return Comparison(Likeness.DOUBTFUL, doubts[0]) if doubts else Comparison(Likeness.SIMILAR)


def _is_empty(name: Sequence[_Word]) -> bool:
    """Return True if the words say nothing, as in `value` and `reserved_2`; a number alone says something."""
    said = [word.base for word in name if not word.base.isdigit()]
    return bool(said) and FILLERS.union(PLACEHOLDERS).issuperset(said)


def _quoted(some: Sequence[_Word]) -> str:
    return repr(" ".join(dict.fromkeys(word.shown for word in some)))


def _pair_off(old: list[_Word], new: list[_Word]) -> Iterator[str]:
    """Remove the words that have a counterpart in the other name, and yield the reasons for doubts about the pairs."""
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
    if reason := _together(old, new) or _together(new, old):
        old.clear()
        new.clear()
        yield reason


def _together(short: Sequence[_Word], long: Sequence[_Word]) -> str:
    """Return why some words may together be other words: `uid` is `user_id`; empty if they are not."""
    if not short or len(short) > len(long) or len(long) == 1:
        return ""
    words = [word.written for word in long]
    one, other = "".join(word.written for word in short), "".join(words)
    if one == other or _is_misspelt(one, other):
        return f"{_quoted(short)} and {_quoted(long)} nearly have the same letters"
    if words[0] in NEGATIONS and negates(one, "".join(words[1:])):
        return f"{_quoted(short)} and {_quoted(long)} often mean the same"
    if len(short) == 1 and not is_known(one) and _abbreviates(one, words):
        return f"{_quoted(short)} may be short for {_quoted(long)}"
    return ""


def _abbreviates(short: str, words: Sequence[str]) -> bool:
    """Return True if a word consists of the beginnings of some words: `uid` of `user` and `id`."""
    if not words:
        return not short
    first, *rest = words
    return any(
        first.startswith(short[:count]) and _abbreviates(short[count:], rest) for count in range(1, len(short) + 1)
    )


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
    common = len(commonprefix([one, other]))
    return (stems[0] == stems[1] and len(stems[0]) >= _SHORTEST_STEM) or (
        common >= _LONG_STEM and common * 3 >= max(len(one), len(other)) * 2
    )


def _is_shortened(one: str, other: str) -> bool:
    """Return True if one word begins with the other one, or if one word is the other one without vowels."""
    shorter, longer = sorted((one, other), key=len)
    if len(shorter) < _SHORTEST_STEM or shorter[0] != longer[0]:
        return False
    rest = iter(longer)
    return longer.startswith(shorter) or (
        set("aeiou").isdisjoint(shorter[1:]) and all(letter in rest for letter in shorter)
    )
