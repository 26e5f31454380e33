"""Extent of a segment of a depth image along a line and across it: what is seen, and how far the rock may go on.

Seen from above, a rock reaches at least as far back as the surface that is seen, and at most as far as the rays over
its upper edge, where they meet the ground. The same holds for the ends of the line: the depth around them says how high
they are at most, and so where they are at least.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.rocks.ground import Ground
from roverkit.rocks.segment import Segment
from roverkit.rocks.unmeasurable import Unmeasurable, UnmeasurableError
from roverkit.vision.camera.camera_model import Floats

_REACH, _REACH_PX = 0.15, 5.0
"""Largest distance of the rock from an end of the line: as a fraction of the line's length, and in pixels."""
_AT_END = 12  # pixels whose median depth is that of an end
_BEYOND = 0.12
"""Part of the line's length by which the rock may reach beyond an end of the line."""
_SHORT = 0.35
"""Part of the line's length that may have no rock: at its ends, a rock may be too low to stand out of the ground."""
_LOW = 1.5
"""Times the least height of what stands out: a rock that is lower cannot be told from rough ground."""
_BORDER = 2  # pixels from the border of the image, where a rock is cut off
_OUTLIERS = 0.005  # part of the points that may be wrong on each side: flying pixels at the edges
_BINS = 24
"""Number of parts of the length in which the height along and across the line is looked at."""
_MIDDLE = 0.35  # distance from the other axis, as a fraction of the length, up to which this is done
_RISE = 0.12  # part of the rock's height: a smaller rise is a rough surface
_GAP = 0.1  # part of the length: a larger gap is between two rocks


@dataclass(frozen=True, slots=True, eq=False)
class Extent:
    """Least and largest size of a rock in metres, as seen from above, if the depth is exact."""

    length: tuple[float, float]
    width: tuple[float, float]
    own: NDArray[np.bool_]
    """Mask (N,) of the segment's pixels; the other ones are of rocks that touch this one."""
    alone: bool
    """False if another rock touches this one in front of it or behind it, so that its width ends at a guessed place."""


def extent_of(segment: Segment, ground: Ground, ends: Floats, rays: Floats, image: tuple[int, int]) -> Extent:
    """Return the extent of the rock at a line.

    ``ends`` (2, 2) are the pixels of the line's ends, ``rays`` (2, 3) their directions, and ``image`` is (width,
    height). Raises `UnmeasurableError` if the rock is low or cut off, or if the line does not fit it.
    """
    farthest = ground.meet(rays)
    length, along = _between(ground, farthest)
    middle = farthest.mean(axis=0)
    across = np.cross(ground.normal, along)
    across *= np.sign(across @ middle)  # away from the camera
    points, shadow = segment.points - middle, ground.meet(segment.directions) - middle
    x, y, heights = points @ along, points @ across, points @ ground.normal
    left, right = _alone(x, heights, np.abs(y) < _MIDDLE * length, segment.lowest, length)
    near, far = _alone(y, heights, np.abs(x) < _MIDDLE * length, segment.lowest, length)
    own = (x >= left) & (x <= right) & (y >= near) & (y <= far)
    if not own.any() or float(np.quantile(heights[own], 0.95)) < _LOW * segment.lowest:
        raise UnmeasurableError(
            Unmeasurable.NO_ROCK,
            f"nothing at the line is {100 * _LOW * segment.lowest:.1f} cm high, and here, lower things cannot be told "
            "from the ground; look from nearer",
        )
    if ((segment.pixels[own] < _BORDER) | (segment.pixels[own] >= np.array(image) - _BORDER)).any():
        raise UnmeasurableError(Unmeasurable.CUT_OFF, "the rock reaches the border of the image; show all of it")
    # A low end begins to stand out at a distance from the true end, which is at most twice this height.
    low = 2 * segment.lowest * float(np.linalg.norm(ends[1] - ends[0])) / length
    reach = max(_REACH * float(np.linalg.norm(ends[1] - ends[0])), _REACH_PX, low)
    nearest = np.stack([ray * _depth_at(end, segment, reach) for end, ray in zip(ends, rays)])
    begin, end = (float(value) for value in np.quantile(x[own], (_OUTLIERS, 1 - _OUTLIERS)))
    front, back = (float(value) for value in np.quantile(y[own], (_OUTLIERS, 1 - _OUTLIERS)))
    _check(begin, end, back - front, length)
    behind = float(np.max(np.nan_to_num(shadow[own] @ across, nan=np.inf)))
    return Extent(
        (min(_between(ground, nearest)[0], length), length),
        (back - front, max(min(behind, far), back) - front),
        own,
        math.isinf(near) and math.isinf(far),
    )


def _between(ground: Ground, ends: Floats) -> tuple[float, Floats]:
    """Return the distance of two points (2, 3) as seen from above, and the direction (3,) from one to the other."""
    way = ends[1] - ends[0]
    way = way - ground.normal * (way @ ground.normal)
    length = float(np.linalg.norm(way))
    return length, way / max(length, 1e-9)


def _depth_at(end: Floats, segment: Segment, reach: float) -> float:
    """Return the depth of the rock at an end of the line. Raises `UnmeasurableError` if the rock is not there."""
    apart = np.linalg.norm(segment.pixels - end, axis=1)
    near = np.argsort(apart)[:_AT_END]
    near = near[apart[near] <= reach]
    if not near.size:
        x, y = end
        raise _mismatch(f"the end ({x:g}, {y:g}) of the line is {float(np.min(apart)):.0f} px from the rock")
    return float(np.median(segment.depth[near]))


def _check(begin: float, end: float, width: float, length: float) -> None:
    """Raise `UnmeasurableError` if a rock does not begin and end, in metres from the line's middle, with the line.

    The line is the longest one across the rock, so the rock is not wider.
    """
    beyond, short = max(-begin, end) - length / 2, length - (end - begin)
    if beyond > _BEYOND * length:
        raise _mismatch(f"the rock goes on for {100 * beyond:.0f} cm beyond the line")
    if short > _SHORT * length:
        raise _mismatch(f"the line is {100 * short:.0f} cm longer than the rock")
    if width > length:
        raise _mismatch(f"what stands at the line is {100 * width:.0f} cm wide, more than the line is long")


def _mismatch(what: str) -> UnmeasurableError:
    return UnmeasurableError(Unmeasurable.LINE_MISMATCH, f"{what}; draw the line from one end of one rock to the other")


def _alone(
    places: Floats, heights: Floats, looked_at: NDArray[np.bool_], least_rise: float, length: float
) -> tuple[float, float]:
    """Return the interval of places, in metres from the line's middle, that one rock has.

    Rocks are nearly convex: the height of one rock along an axis never falls and rises again, and its surface has no
    gap. The interval ends there, and is infinite where no other rock touches this one.
    """
    size = length / _BINS
    bins, tops = np.round(places[looked_at] / size).astype(int), heights[looked_at]
    top = {int(one): float(np.quantile(tops[bins == one], 0.9)) for one in np.unique(bins)}
    core = [one for one in top if abs(one) <= _BINS // 4]
    if not core:
        return -math.inf, math.inf
    peak = max(core, key=lambda one: top[one])
    highest = max(top.values())
    limits = []
    for way in (-1, 1):
        limit, lowest, last = way * math.inf, peak, peak
        for place in sorted((one for one in top if (one - peak) * way > 0), reverse=way < 0):
            if abs(place - last) * size > _GAP * length:
                limit = (place + last) / 2 * size
                break
            if top[place] > top[lowest] + max(least_rise, _RISE * highest):
                limit = lowest * size
                break
            lowest, last = min(lowest, place, key=lambda one: top[one]), place
        limits.append(limit)
    return limits[0], limits[1]
