"""Time of sending, as every datagram and sample of the benchmarks carries it: two floats of 20 exact bits each.

It equals `Stamp` in cyclone.hpp. Both floats count from 1, because a proto3 field with the value 0 is left out of the
datagram, while the stamp is read at a fixed offset.
"""

import struct

FLOAT = struct.Struct("<f")
BITS = 20
MASK = (1 << BITS) - 1


def stamp(ns: int) -> tuple[float, float]:
    """Return the high and the low part of a time in nanoseconds, modulo 18 minutes."""
    return float((ns >> BITS & MASK) + 1), float((ns & MASK) + 1)


def age_ns(high: float, low: float, now_ns: int) -> int:
    """Return the age of a stamp in nanoseconds."""
    then = (int(high) - 1 << BITS) + int(low) - 1
    return (now_ns - then) & ((1 << 2 * BITS) - 1)


def ages_us(ages_ns: list[int]) -> dict[str, float]:
    """Return the median and the 99th percentile in microseconds, by their names in the tools' answers."""
    if not ages_ns:
        return {}
    ordered = sorted(ages_ns)
    last = len(ordered) - 1
    return {"p50_us": ordered[last // 2] / 1e3, "p99_us": ordered[last * 99 // 100] / 1e3}
