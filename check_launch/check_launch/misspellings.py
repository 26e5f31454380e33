"""Comparison of names, to tell a misspelling from another name."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def nearest(name: str, known: Iterable[str], least: float = 0.6) -> str:
    """Return the known name that is the most similar, with a similarity from ``least`` to 1; empty if there is none."""
    return next(iter(get_close_matches(name, list(known), 1, least)), "")


def did_you_mean(name: str, otherwise: str = "") -> str:
    """Return the help that names what was likely meant; ``otherwise`` if that is empty."""
    return f"did you mean '{name}'?" if name else otherwise


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
