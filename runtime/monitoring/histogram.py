"""How long batches took, in buckets."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass

from roverlink.runtime.bridge.bridge import Handle
from roverlink.runtime.bridge.to_peer import Send
from roverlink.runtime.net import udp

BOUNDS_S = (1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.5)
"""Upper bounds of the buckets, in seconds; one more bucket has what took longer."""


@dataclass(frozen=True, slots=True)
class Latencies:
    """A histogram as it stood."""

    counts: Sequence[int]
    """Datagrams in each bucket of `BOUNDS_S`, and above the last."""
    sum_s: float

    @property
    def total(self) -> int:
        """All datagrams."""
        return sum(self.counts)

    def quantile(self, share: float) -> float | None:
        """The bound below which a share of the datagrams lies, in seconds.

        None where there are none, or where it lies above all bounds.
        """
        wanted, seen = share * self.total, 0
        for bound, count in zip(BOUNDS_S, self.counts):
            seen += count
            if seen >= wanted > 0:
                return bound
        return None


class LatencyProbe:
    """Measures a bridge's batches: from when they were read until they were published and forwarded."""

    def __init__(self) -> None:
        self._counts = [0] * (len(BOUNDS_S) + 1)
        self._sum_s = 0.0

    def receiving(self, handle: Handle) -> Handle:
        """Time a batch; each of its datagrams counts as long as the whole of it."""
        counts, now = self._counts, time.perf_counter

        def timed(batch: udp.Batch) -> None:
            start = now()
            handle(batch)
            took = now() - start
            counts[bisect_left(BOUNDS_S, took)] += len(batch)
            self._sum_s += took * len(batch)

        return timed

    def sending(self, peer: str, send: Send) -> Send:  # noqa: ARG002  # as an observer is asked
        """Leave the other way as it is."""
        return send

    @property
    def latencies(self) -> Latencies:
        """The histogram as it stands."""
        return Latencies(tuple(self._counts), self._sum_s)
