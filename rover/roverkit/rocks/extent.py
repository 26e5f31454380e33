"""Extent of a segment of a depth image along a line and across it: what is seen, and how far the rock may go on.

Seen from above, a rock reaches at least as far back as the surface that is seen, and at most as far as the rays over
its upper edge, where they meet the ground.

An end of the line may be above the ground, and then the ray meets the ground behind it. The surface around an end says
how high it is: if the end is at the camera's side of the rock, or on its outline. Elsewhere, the surface hides an end
that is on the ground behind it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roverkit.rocks.ground import Ground
from roverkit.rocks.segment import Segment
from roverkit.rocks.unmeasurable import Unmeasurable, UnmeasurableError
from roverkit.vision.camera.camera_model import Floats

_REACH, _REACH_PX = 0.15, 5.0
"""Largest distance of the rock from an end of the line: as a fraction of the line's length, and in pixels."""
_AROUND, _AROUND_PX = 0.12, 6.0
"""Radius of the circle around an end whose surface says how high it is: as a fraction of the length, and in pixels."""
_LEAST_POINTS = 6  # in this circle
_ON_OUTLINE, _INSIDE = 0.2, 0.5
"""Shares of the circle that the rock takes, up to which the end is on its outline, and from which it is hidden."""
_VISIBLE, _HIDDEN = 0.7, 0.1
"""Standard deviations of the length: as fractions of what the height of a visible and of a hidden end changes."""
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
_SURELY_TWO = 0.5  # part of the rise that is enough if what stands at the line is too wide for one rock
_GAP = 0.1  # part of the length: a larger gap is between two rocks


class Measured(NamedTuple):
    """Value with its standard deviation."""

    value: float
    sigma: float


@dataclass(frozen=True, slots=True, eq=False)
class Extent:
    """Size of a rock in metres, as seen from above, without an assumption about its shape."""

    length: Measured
    """Distance of the line's ends; sigma is that of their heights alone."""
    width: tuple[float, float]
    """Least and largest width, if the depth is exact."""
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
    for rise in (1.0, _SURELY_TWO):
        near, far = _alone(y, heights, np.abs(x) < _MIDDLE * length, segment.lowest, length, rise)
        own = (x >= left) & (x <= right) & (y >= near) & (y <= far)
        front, back = _range(y[own])
        if back - front <= length:
            break
    if not own.any() or float(np.quantile(heights[own], 0.95)) < _LOW * segment.lowest:
        raise UnmeasurableError(
            Unmeasurable.NO_ROCK,
            f"nothing at the line is {100 * _LOW * segment.lowest:.1f} cm high, and here, lower things cannot be told "
            "from the ground; look from nearer",
        )
    if ((segment.pixels[own] < _BORDER) | (segment.pixels[own] >= np.array(image) - _BORDER)).any():
        raise UnmeasurableError(Unmeasurable.CUT_OFF, "the rock reaches the border of the image; show all of it")
    span = float(np.linalg.norm(ends[1] - ends[0]))
    # A low end begins to stand out at a distance from the true end, which is at most twice this height.
    reach = max(_REACH * span, _REACH_PX, 2 * segment.lowest * span / length)
    shown = [_surface_at(end, segment.pixels[own], heights[own], span, reach) for end in ends]
    _check(*_range(x[own]), back - front, length)
    behind = float(np.max(np.nan_to_num(shadow[own] @ across, nan=np.inf)))
    return Extent(
        _length(ground, farthest, np.array(shown)),
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


def _surface_at(
    end: Floats, pixels: NDArray[np.intp], heights: Floats, span: float, reach: float
) -> tuple[float, float]:
    """Return the height in metres of the rock's surface at an end, and the share of a circle around it that shows rock.

    The height is that of a plane through the heights (N,) at the rock's pixels (N, 2) in the circle. Raises
    `UnmeasurableError` if the rock is not there.
    """
    apart = np.linalg.norm(pixels - end, axis=1)
    if (nearest := float(np.min(apart))) > reach:
        x, y = end
        raise _mismatch(f"the end ({x:g}, {y:g}) of the line is {nearest:.0f} px from the rock")
    radius = max(_AROUND * span, _AROUND_PX)
    near = apart < radius
    count = int(np.count_nonzero(near))
    if count < _LEAST_POINTS:
        return 0.0, 0.0
    weights = np.exp(-((apart[near] / radius) ** 2))[:, None]
    plane = np.append(pixels[near] - end, np.ones((count, 1)), axis=1)
    coefficients, *_ = np.linalg.lstsq(plane * weights, heights[near] * weights[:, 0], rcond=None)
    return max(float(coefficients[2]), 0.0), count / (math.pi * radius**2)


def _length(ground: Ground, farthest: Floats, shown: Floats) -> Measured:
    """Return the distance of the line's ends.

    ``farthest`` (2, 3) is where their rays meet the ground, and ``shown`` has the height at each, and the share of rock
    around it.
    """
    heights, shares = shown.T
    longest, _ = _between(ground, farthest)
    lifted = farthest * (1 - heights / ground.height)[:, None]  # towards the camera
    one_lifted = np.stack([lifted[0], farthest[1]]), np.stack([farthest[0], lifted[1]])
    effects = np.array([_between(ground, ends)[0] for ends in one_lifted]) - longest
    # To lift an end at the camera's side makes the line longer.
    visible = np.where(effects > 0, 1.0, np.clip((_INSIDE - shares) / (_INSIDE - _ON_OUTLINE), 0, 1))
    length, _ = _between(ground, farthest + visible[:, None] * (lifted - farthest))
    return Measured(length, float(np.linalg.norm(effects * np.hypot(_VISIBLE * visible, _HIDDEN * (1 - visible)))))


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


def _range(places: Floats) -> tuple[float, float]:
    """Return the least and the largest place without outliers; NaN if there is none."""
    if not places.size:
        return math.nan, math.nan
    least, largest = np.quantile(places, (_OUTLIERS, 1 - _OUTLIERS))
    return float(least), float(largest)


def _alone(
    places: Floats, heights: Floats, looked_at: NDArray[np.bool_], least_rise: float, length: float, part: float = 1.0
) -> tuple[float, float]:
    """Return the interval of places, in metres from the line's middle, that one rock has.

    Rocks are nearly convex: the height of one rock along an axis never falls and rises again, and its surface has no
    gap. The interval ends there, and is infinite where no other rock touches this one. A rise counts from
    ``least_rise`` in metres, or from a part of the highest place, both times ``part``.
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
            if top[place] > top[lowest] + part * max(least_rise, _RISE * highest):
                limit = lowest * size
                break
            lowest, last = min(lowest, place, key=lambda one: top[one]), place
        limits.append(limit)
    return limits[0], limits[1]
