"""Agreement of landmarks: those that stand where the survey says, and those that somebody has moved since.

The detections of landmarks during a drive give their places relative to each other, whatever the survey says. Two
landmarks agree if they stand to each other as in the survey. The largest set of landmarks that all agree is right; one
that was moved agrees with none of them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from itertools import combinations
from typing import TypeVar

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.planar_gaussian import Floats, PlanarGaussian, adjoint, squared_distance
from roverkit.gating import gate_limit

T = TypeVar("T")


def agreeing(
    seen: Mapping[T, PlanarPose],
    covariance: Callable[[T, T], Floats],
    surveyed: Mapping[T, PlanarGaussian],
    preferred: Collection[T],
) -> frozenset[T]:
    """Return the largest set of landmarks that agree with each other.

    ``seen`` has the places by the detections, in any frame, and ``covariance`` their joint covariance (3, 3) for two
    landmarks. Of sets of one size, the one with most of ``preferred`` is returned.
    """
    friends: dict[T, frozenset[T]] = {landmark: frozenset() for landmark in seen}
    for landmark, other in combinations(seen, 2):
        by_sight = seen[landmark].inverse() @ seen[other]
        carried = adjoint(by_sight.inverse())
        mixed = carried @ covariance(landmark, other)
        spread = covariance(other, other) + carried @ covariance(landmark, landmark) @ carried.T - mixed - mixed.T
        by_survey = surveyed[landmark].inverse() @ surveyed[other]
        if squared_distance(by_survey, PlanarGaussian(by_sight, spread)) < gate_limit(3):
            friends[landmark] |= {other}
            friends[other] |= {landmark}
    order = list(seen)
    return max(
        _cliques(frozenset(), frozenset(seen), frozenset(), friends),
        key=lambda found: (len(found), len(found & set(preferred)), [landmark in found for landmark in order]),
    )


def _cliques(
    chosen: frozenset[T], left: frozenset[T], done: frozenset[T], friends: Mapping[T, frozenset[T]]
) -> Iterator[frozenset[T]]:
    """Yield the largest sets of landmarks that agree: ``chosen`` with some of ``left``, and none of ``done``.

    Source: Bron and Kerbosch, Finding All Cliques of an Undirected Graph, 1973, with a pivot.
    """
    if not left and not done:
        yield chosen
        return
    pivot = max(left | done, key=lambda landmark: len(left & friends[landmark]))
    for landmark in left - friends[pivot]:
        yield from _cliques(chosen | {landmark}, left & friends[landmark], done & friends[landmark], friends)
        left, done = left - {landmark}, done | {landmark}
