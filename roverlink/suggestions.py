"""Suggestions for an unknown name: the known names that are the most similar. The compiler and the runtime use them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_NAMED = 30  # most names that a suggestion lists
_MOST_NEAREST = 3  # names that are suggested for one unknown name


def nearest(word: str, known: Iterable[str], otherwise: str | None = None) -> str:
    """Return a hint for an error about an unknown word, such as ``did you mean 'imu_info'?``.

    If no known word is similar, the hint is ``otherwise``. Without it, the hint lists the known words, at most 30:
    ``known: gps_info, imu_info``.
    """
    choices = list(dict.fromkeys(known))
    found = difflib.get_close_matches(word, choices, 1)
    if found:
        return f"did you mean {found[0]!r}?"
    if otherwise is not None:
        return otherwise
    more = len(choices) - _NAMED
    return f"known: {', '.join(choices[:_NAMED])}{f' and {more} more' if more > 0 else ''}"


def nearest_names(name: str, known: Iterable[str]) -> list[str]:
    """Return up to three known full names whose last parts are the most similar to the last part of ``name``."""
    by_last_part: dict[str, list[str]] = {}
    for full_name in sorted(known):
        by_last_part.setdefault(_last_part(full_name), []).append(full_name)
    found = difflib.get_close_matches(_last_part(name), by_last_part, _MOST_NEAREST)
    return [full_name for last_part in found for full_name in by_last_part[last_part]][:_MOST_NEAREST]


def _last_part(name: str) -> str:
    return name.rpartition(".")[2].casefold()
