"""Words of a name."""

from __future__ import annotations

import re

# In this order: the scale of `angle_x100`; an acronym, which ends before the last capital of `GPSInfo`; a word; a
# number.
_WORD = re.compile(r"X\d+|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
# The scale of `angle_x100`, and the power of a unit; cut at the digit, they would be a word and a number.
_WHOLE = re.compile(r"[xX]\d+|(m|mm|cm|km|s|ms|mps)[23]")


def words(name: str) -> list[str]:
    """Split a name in snake_case or CamelCase into words in lower case: ``GPSInfo`` -> ``["gps", "info"]``."""
    return [word.lower() for part in name.split("_") for word in _words_of_part(part)]


def _words_of_part(part: str) -> list[str]:
    return [part] if _WHOLE.fullmatch(part) else _WORD.findall(part)
