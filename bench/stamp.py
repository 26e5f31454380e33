"""The moment of sending, as every datagram and sample of the bench carries it: two floats, exact for 20 bits each.

The same as `Stamp` in cyclone.hpp. Counted from 1, since a proto3 field that is 0 is left out of the datagram, and a
stamp is read at a fixed place.
"""

import struct

FLOAT = struct.Struct("<f")
BITS = 20
MASK = (1 << BITS) - 1


def stamp(ns: int) -> tuple[float, float]:
    """The high and the low part of a time in nanoseconds, modulo 18 minutes."""
    return float((ns >> BITS & MASK) + 1), float((ns & MASK) + 1)


def age_ns(high: float, low: float, now_ns: int) -> int:
    """How long ago the stamped moment was, in nanoseconds."""
    then = (int(high) - 1 << BITS) + int(low) - 1
    return (now_ns - then) & ((1 << 2 * BITS) - 1)


def ages_us(ages_ns: list[int]) -> dict[str, float]:
    """The median and the 99th percentile in microseconds, by the names they have in the tools' answers."""
    if not ages_ns:
        return {}
    ordered = sorted(ages_ns)
    last = len(ordered) - 1
    return {"p50_us": ordered[last // 2] / 1e3, "p99_us": ordered[last * 99 // 100] / 1e3}
