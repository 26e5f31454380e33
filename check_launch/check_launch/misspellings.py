"""Comparison of names, to tell a misspelling from another name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from difflib import SequenceMatcher, get_close_matches
from functools import lru_cache

_OF_MANY = re.compile(r"\d|(?<![A-Za-z])[xyz](?![A-Za-z])")
"""Part of a name that tells similar things apart: a digit, or the letter of an axis."""
_TIE = 0.03
"""Names whose similarities differ by less are equally likely."""
_SHORT = 8
"""Names with fewer letters may differ by one letter only to be a misspelling."""
_SHORT_WORD = 5
"""Words of a name with fewer letters may do so, too: `cmd_vel_raw` is not `cmd_vel_nav`."""
_BETWEEN_WORDS = re.compile(r"[^A-Za-z0-9]+")


def nearest(name: str, known: Iterable[str], least: float = 0.6) -> str:
    """Return the known name that is the most similar, with a similarity from ``least`` to 1; empty if there is none."""
    return next(iter(get_close_matches(name, list(known), 1, least)), "")


def all_nearest(name: str, known: Iterable[str], least: float = 0.6) -> list[str]:
    """Return the known names that are the most similar: several if nothing tells which one is meant."""
    found = get_close_matches(name, list(dict.fromkeys(known)), 5, least)
    ratios = [SequenceMatcher(None, other, name).ratio() for other in found]
    return sorted(other for other, ratio in zip(found, ratios, strict=True) if ratio > ratios[0] - _TIE)


def did_you_mean(names: str | Sequence[str], otherwise: str = "") -> str:
    """Return the help that names what was likely meant; ``otherwise`` if nothing is known."""
    several = [names] if isinstance(names, str) else names
    spelled = " or ".join(f"'{name}'" for name in several if name)
    return f"did you mean {spelled}?" if spelled else otherwise


@lru_cache(1 << 16)  # many launch files give the same parameters
def is_misspelling(name: str, other: str) -> bool:
    """Return true if a name is another one with a letter or two wrong."""
    if name == other or not is_near(name, other, 1 if min(len(name), len(other)) < _SHORT else 2):
        return False
    words, others = _BETWEEN_WORDS.split(name), _BETWEEN_WORDS.split(other)
    differing = [pair for pair in zip(words, others, strict=False) if pair[0] != pair[1]]
    is_of_short_word = len(words) == len(others) and len(differing) == 1 and min(map(len, differing[0])) < _SHORT_WORD
    return not is_of_short_word or is_near(name, other, 1)


def is_other_axis(name: str, other: str) -> bool:
    """Return true if names differ only in an axis or a number, such as `origin_y` and `origin_z`, or `ros2`."""
    return _OF_MANY.sub("", name) == _OF_MANY.sub("", other)


def misspelt(name: str, known: Iterable[str]) -> list[str]:
    """Return the known names of which a name is a misspelling; names with other numbers or axes are other names."""
    return sorted({other for other in known if is_misspelling(name, other) and not is_other_axis(name, other)})


def is_near(a: str, b: str, most: int) -> bool:
    """Return true if at most so many letters have to be inserted, removed or replaced, or swapped with the next one."""
    if abs(len(a) - len(b)) > most:
        return False
    before, row = [most + 1] * (len(b) + 1), list(range(len(b) + 1))
    for i in range(1, len(a) + 1):
        above, row = row, [i]
        for j in range(1, len(b) + 1):
            cost = min(above[j] + 1, row[-1] + 1, above[j - 1] + (a[i - 1] != b[j - 1]))
            if i > 1 and j > 1 and a[i - 1] == b[j - 2] and a[i - 2] == b[j - 1]:
                cost = min(cost, before[j - 2] + 1)
            row.append(cost)
        if min(row) > most:  # it grows only
            return False
        before = above
    return row[-1] <= most
