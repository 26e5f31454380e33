"""Comparison of names, to tell a misspelling from another name."""

from __future__ import annotations


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
