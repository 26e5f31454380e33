"""Names of an enum's values, without the words that the enum or most of its values have."""

from __future__ import annotations

from collections.abc import Collection

from roverlink.generator.lint.names.name_words import words
from roverlink.generator.lint.names.word_groups import base

_FEWEST = 3  # of three values or fewer, two may share a word by chance


def shared_words(enum: str, names: Collection[str]) -> frozenset[str]:
    """Return the words that say nothing in the names of an enum's values, in the form that names are compared in.

    In an enum ``GpsFix``, these are ``gps`` and ``fix`` of ``GPS_FIX_NONE``. ``enum`` is the name of the enum
    without its package.
    """
    # Protobuf's style guide asks for the enum's name as prefix of every value (`GPS_FIX_NONE`). Such a word would make
    # all values of an enum similar.
    found = set(map(base, words(enum)))
    counts: dict[str, int] = {}
    for name in set(names):
        for word in set(map(base, words(name))):
            counts[word] = counts.get(word, 0) + 1
    many = len(set(names))
    return frozenset(found | {word for word, count in counts.items() if many > _FEWEST and count * 2 > many})
