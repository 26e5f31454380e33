"""Words of a name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

# In this order: the scale of `angle_x100`; an acronym, which ends before the last capital of `GPSInfo`; a word; a
# number.
_WORD = re.compile(r"X\d+|[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
# The scale of `angle_x100`, and the power of a unit; cut at the digit, they would be a word and a number.
_WHOLE = re.compile(r"[xX]\d+|(m|mm|cm|km|s|ms|mps)[23]")
_PART = re.compile("[^_]+")
# Letters and digits that people read as one: `P2SH`, `Vector3d`, `utf8`.
_CODE = re.compile(r"[A-Z]*\d[A-Z\d]*(?![a-z])|[A-Z]?[a-z]*\d[a-z\d]*")


class Written(NamedTuple):
    """A word of a name: in lower case, and as users recognise it."""

    word: str
    shown: str
    """The word, or the code as the name writes it if the word is a part of one: ``P2SH`` for ``sh``."""


@lru_cache(maxsize=1 << 16)
def words(name: str) -> tuple[str, ...]:
    """Split a name in snake_case or CamelCase into words in lower case: ``GPSInfo`` -> ``("gps", "info")``."""
    return tuple(written.word for written in written_words(name))


def written_words(name: str) -> Iterator[Written]:
    """Yield the words of a name, each with the text that shows it to users."""
    for part in _PART.findall(name):
        if _WHOLE.fullmatch(part):
            yield Written(part.lower(), part)
            continue
        codes = [code.span() for code in _CODE.finditer(part)]
        for word in _WORD.finditer(part):
            code = next((code for code in codes if code[0] <= word.start() and word.end() <= code[1]), None)
            yield Written(word[0].lower(), part[slice(*code)] if code and code != word.span() else word[0].lower())
