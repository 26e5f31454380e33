"""Histogram of the time that a bridge needs for a batch of datagrams."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from roverlink.runtime.net import udp

BOUNDS_S = (1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.5)
"""Upper bounds of the buckets in seconds; one more bucket holds longer times."""


Handle = Callable[[udp.Batch], None]
"""Function that handles a batch of datagrams."""


@dataclass(frozen=True, slots=True)
class Latencies:
    """Histogram at one moment: the numbers of datagrams, by the time that the bridge needed for their batch."""

    counts: Sequence[int]
    """Number of datagrams in each bucket of `BOUNDS_S`, and in the bucket above the last bound."""
    sum_s: float
    """Sum of the times of all datagrams, in seconds."""

    def __add__(self, other: Latencies) -> Latencies:
        """Return the histogram of the datagrams of both."""
        return Latencies([*map(sum, zip(self.counts, other.counts))], self.sum_s + other.sum_s)

    @property
    def total(self) -> int:
        """Number of datagrams in all buckets."""
        return sum(self.counts)

    def quantile(self, share: float) -> float | None:
        """Return the time in seconds that a share (0 to 1) of the datagrams did not exceed.

        The time is the smallest suitable bound in `BOUNDS_S`. Returns None if there are no datagrams, or if no bound is
        large enough.
        """
        wanted, seen = share * self.total, 0
        for bound, count in zip(BOUNDS_S, self.counts):
            seen += count
            # `wanted > 0` leaves out an empty histogram, for which every bound would be right.
            if seen >= wanted > 0:
                return bound
        return None


class HandlingTimes:
    """Measured times from the reading of a batch until the batch is published and forwarded."""

    def __init__(self) -> None:
        self._counts = [0] * (len(BOUNDS_S) + 1)
        self._sum_s = 0.0

    def timed(self, handle: Handle) -> Handle:
        """Wrap ``handle`` to measure the time of each batch. The time counts once for each datagram of the batch."""
        counts, now = self._counts, time.perf_counter

        def timed(batch: udp.Batch) -> None:
            start = now()
            handle(batch)
            took = now() - start
            # No lock: only the receiving thread writes, and a reader may see a count that is one batch old.
            counts[bisect_left(BOUNDS_S, took)] += len(batch)
            self._sum_s += took * len(batch)

        return timed

    @property
    def latencies(self) -> Latencies:
        """Histogram of all batches since the start."""
        return Latencies(tuple(self._counts), self._sum_s)
