"""Words of a name, and a comparison of words that decides if two names may have the same meaning."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable

from roverlink.generator.lint.names.name_units import measure

# In this order: the scale of `angle_x100`; an acronym, which ends before the last capital of `GPSInfo`; a word; a
# number.
_WORD = re.compile(r"X\d+|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_EMPTY = frozenset(
    {"a", "an", "and", "the", "of", "to", "in", "on", "is", "has", "value", "data", "info", "new", "old"}
)
_SHORTEST_STEM = 3


def words(name: str) -> list[str]:
    """Split a name in snake_case or CamelCase into words in lower case: ``GPSInfo`` -> ``["gps", "info"]``."""
    return [word.lower() for part in name.split("_") for word in _words_of_part(part)]


def _words_of_part(part: str) -> list[str]:
    # `x100` is a scale, `m2` and `s2` are powers of a unit; cut at the digit they would be a letter and a number.
    return [part] if re.fullmatch(r"[xX]\d+|[a-z]{1,3}[23]", part) else _WORD.findall(part)


def share_a_word(old: Iterable[str], new: Iterable[str]) -> bool:
    """Return True if the old and the new names of a field share a meaningful word.

    A field may have several names, such as its name and its JSON name. Units, numbers and words like `the` do not
    count. `temp` and `temperature` count as the same word, and so do `label` and `labels`. A unit in one name may be
    the quantity of the other name, as in `item_counts` and `counts`.
    """
    (old_subjects, old_words), (new_subjects, new_words) = _subjects(old), _subjects(new)
    return _any_same(old_subjects, new_words) or _any_same(new_subjects, old_words)


def _subjects(names: Iterable[str]) -> tuple[set[str], set[str]]:
    """Return the meaningful words of some names, and all words of these names.

    If no word is meaningful, the first set has all words without units.
    """
    split = [words(name) for name in names]
    found = {word for name in split for word in measure(name).words}
    telling = {word for word in found if not word.isdigit() and word not in _EMPTY}
    return telling or found, {word for name in split for word in name}


def _any_same(some: Iterable[str], others: Iterable[str]) -> bool:
    return any(_same(one, other) for one, other in itertools.product(some, others))


def _same(one: str, other: str) -> bool:
    shorter, longer = sorted((one, other), key=len)
    return one == other or (len(shorter) >= _SHORTEST_STEM and longer.startswith(shorter))
