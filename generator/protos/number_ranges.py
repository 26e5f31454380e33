"""Ranges of field numbers or enum numbers. Both ends belong to the range."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roverlink.generator.ir.protobuf_facts import LARGEST_FIELD_NUMBER
from roverlink.generator.protos.parser import LARGEST_ENUM_NUMBER

Range = tuple[int, int]

_LARGEST = (LARGEST_FIELD_NUMBER, LARGEST_ENUM_NUMBER)


def covers(ranges: Iterable[Range], number: int) -> bool:
    """Return True if a number is in one of the ranges."""
    return any(first <= number <= last for first, last in ranges)


def missing(wanted: Range, ranges: Iterable[Range]) -> Iterator[Range]:
    """Yield the parts of the range ``wanted`` that none of the other ranges covers.

    >>> list(missing((1, 9), [(3, 4), (8, 20)]))
    [(1, 2), (5, 7)]
    """
    start, end = wanted
    for first, last in sorted(ranges):
        if last < start:
            continue
        if first > end:
            break
        if first > start:
            yield start, first - 1
        start = last + 1
    if start <= end:
        yield start, end


def spelled(ranges: Iterable[Range]) -> str:
    """Return ranges as a ``reserved`` statement of a .proto file writes them: ``4, 8 to max``."""
    return ", ".join(_spelled(*numbers) for numbers in ranges)


def _spelled(first: int, last: int) -> str:
    if first == last:
        return str(first)
    return f"{first} to {'max' if last in _LARGEST else last}"
