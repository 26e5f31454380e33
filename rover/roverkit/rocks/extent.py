"""Extent of a segment of a depth image along a line and across it: what is seen, and how far the rock may go on.

Seen from above, a rock reaches at least as far back as the surface that is seen, and at most as far as the rays over
its upper edge, where they meet the ground.

An end of the line may be above the ground, and then the ray meets the ground behind it. The surface around an end says
how high it is: if the end is at the camera's side of the rock, or on its outline. Elsewhere, the surface hides an end
that is on the ground behind it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roverkit.rocks.ground import NOISE, Ground
from roverkit.rocks.segment import Segment
from roverkit.rocks.unmeasurable import Unmeasurable, UnmeasurableError
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.opencv import cv2

_REACH, _REACH_PX = 0.15, 5.0
"""Largest distance of the rock from an end of the line: as a fraction of the line's length, and in pixels."""
_AROUND, _AROUND_PX = 0.12, 6.0
"""Radius of the circle around an end whose surface says how high it is: as a fraction of the length, and in pixels."""
_LEAST_POINTS = 6  # in this circle, and of a rock
_HIDDEN = 0.25
"""Part of the line's length inside of the outline in which an end that the rock hides may be."""
_BEHIND = 1 / 3
"""Probability that a rock goes on behind its visible edge."""
_HEIGHTS = 9  # of an end that are tried
_HIGHEST = 0.9  # highest end, as a part of the camera's height
_DIRECTIONS = 18  # in which a rock may not be longer than the line
_RIM = 2.5
"""Rim of a rock in pixels that its segment lacks: half of the window over which heights are averaged, and holes."""
_SOME = 1500  # points that are used with each pair of heights
_ENDS_PX, _ENDS = 1.75, 0.0145
"""Standard deviation of a length, in pixels and as a fraction: the line's ends and the ground are not exact."""
_LEAST_LIKELY = 0.5
"""Least probability that the rock ends with the line: a line that rather does not fit is refused. The ends have the
heights that the surface around them shows."""
_SHORT = 0.35
"""Part of the line's length that may have no rock: at its ends, a rock may be too low to stand out of the ground."""
_LOW = 1.5
"""Times the least height of what stands out: a rock that is lower cannot be told from rough ground."""
_BORDER = 2  # pixels from the border of the image, where a rock is cut off
_OUTLIERS = 0.005  # part of the points that may be wrong on each side: flying pixels at the edges
_BINS = 24
"""Number of parts of the length in which the height across the line is looked at."""
_MIDDLE = 0.35  # distance from the line's middle, as a fraction of the length, up to which this is done
_RISE = 0.12  # part of the rock's height: a smaller rise is a rough surface
_GAP = 0.1  # part of the length: a larger gap is between two rocks


class Measured(NamedTuple):
    """Value with its standard deviation."""

    value: float
    sigma: float


@dataclass(frozen=True, slots=True, eq=False)
class Extent:
    """Size of a rock in metres, as seen from above, without an assumption about its shape."""

    length: Measured
    """Distance of the line's ends. Sigma is that of their heights and of the rim."""
    seen: Measured
    """Width that is seen: the least one. Sigma is that of the heights of the line's ends and of the rim."""
    limit: float
    """Largest width, if the depth is exact."""
    own: NDArray[np.bool_]
    """Mask (N,) of the segment's pixels; the other ones are of rocks that touch this one."""


def line_sigma(length: Floats | float, pixel: Floats | float) -> Floats:
    """Return the standard deviation of lengths in metres between ends at known heights; ``pixel`` is a pixel's size."""
    return np.asarray(np.hypot(_ENDS_PX * pixel, _ENDS * length))


class _Lines(NamedTuple):
    """Lines that the line may be, as seen from above: one for each pair of heights of its ends."""

    ends: Floats
    """Ends (M, 2, 2) in metres, where the origin is below the camera."""
    weights: Floats
    """Probabilities (M,)."""

    @property
    def along(self) -> Floats:
        """Unit vectors (M, 2) from the first end to the last one."""
        ways = self.ends[:, 1] - self.ends[:, 0]
        return np.asarray(ways / np.maximum(self.lengths, 1e-9)[:, None])

    @property
    def across(self) -> Floats:
        """Unit vectors (M, 2) across the lines that point away from the camera."""
        turned = self.along[:, ::-1] * (1, -1)
        away = np.sign((turned * self.ends.mean(axis=1)).sum(axis=1))
        return np.asarray(turned * np.where(away == 0, 1, away)[:, None])

    @property
    def lengths(self) -> Floats:
        """Lengths (M,) in metres."""
        return np.asarray(np.linalg.norm(self.ends[:, 1] - self.ends[:, 0], axis=1))

    def away(self, ways: Floats) -> Floats:
        """Return the parts (M,) of unit vectors (M, 2) that point away from the camera or to it: 0 to 1."""
        middles = self.ends.mean(axis=1)
        return np.asarray(np.abs((ways * middles).sum(axis=1)) / np.maximum(np.linalg.norm(middles, axis=1), 1e-9))

    def mean(self, values: Floats) -> Measured:
        """Return the mean of values (M,), and their standard deviation."""
        mean = float(self.weights @ values)
        return Measured(mean, math.sqrt(float(self.weights @ (values - mean) ** 2)))

    def middle(self) -> _Lines:
        """Return the mean line alone."""
        return _Lines(np.tensordot(self.weights, self.ends, 1)[None], np.ones(1))


def extent_of(
    segment: Segment, ground: Ground, ends: Floats, rays: Floats, image: tuple[int, int], pixel: float
) -> Extent:
    """Return the extent of the rock at a line.

    ``ends`` (2, 2) are the pixels of the line's ends, ``rays`` (2, 3) their directions, ``image`` is (width, height),
    and ``pixel`` the size of a pixel at the rock in metres. Raises `UnmeasurableError` if the rock is low or cut off,
    or if the line does not fit it.
    """
    # It gives places as seen from above, from the place below the camera.
    plan = np.linalg.svd(ground.normal[None])[2][1:].T
    span = float(np.linalg.norm(ends[1] - ends[0]))
    points, shadow, farthest = (
        places @ plan for places in (segment.points, ground.meet(segment.directions), ground.meet(rays))
    )
    heights = segment.points @ ground.normal + ground.height

    def lines_of(own: NDArray[np.bool_]) -> _Lines:
        shown = [_surface_at(end, segment.pixels[own], heights[own], span) for end in ends]
        return _lines(farthest / ground.height, ground.height, shown)

    mean = lines_of(np.ones(len(points), bool)).middle()
    length, middle = float(mean.lengths[0]), mean.ends[0].mean(axis=0)
    x, y = (points - middle) @ mean.along[0], (points - middle) @ mean.across[0]
    near, far = _alone(y, heights, np.abs(x) < _MIDDLE * length, segment.lowest, length)
    own = (y >= near) & (y <= far)
    if np.count_nonzero(own) < _LEAST_POINTS or float(np.quantile(heights[own], 0.95)) < _LOW * segment.lowest:
        raise UnmeasurableError(
            Unmeasurable.NO_ROCK,
            f"nothing at the line is {100 * _LOW * segment.lowest:.1f} cm high, and here, lower things cannot be told "
            "from the ground; look from nearer",
        )
    if ((segment.pixels[own] < _BORDER) | (segment.pixels[own] >= np.array(image) - _BORDER)).any():
        raise UnmeasurableError(Unmeasurable.CUT_OFF, "the rock reaches the border of the image; show all of it")
    # A low end begins to stand out at a distance from the true end, which is at most twice this height.
    reach = max(_REACH * span, _REACH_PX, 2 * segment.lowest / pixel)
    for end in ends:
        if (nearest := float(np.min(np.linalg.norm(segment.pixels[own] - end, axis=1)))) > reach:
            raise _mismatch(f"the end ({end[0]:g}, {end[1]:g}) of the line is {nearest:.0f} px from the rock")
    # The edge has holes, and what is lower than the least height does not stand out. Noise of the depth widens a rock.
    rim = _RIM * pixel + segment.lowest / 2
    noise = NOISE * float(np.mean(segment.depth[own])) ** 2
    lines = _fitting(lines_of(own), points[own], shadow[own], span, rim, noise)
    fronts, backs = _ranges(points[own], lines.across)
    lacking = np.maximum(rim - noise * lines.away(lines.across), 0)
    wide = lines.mean(backs - fronts + 2 * lacking)
    across = lines.middle().across[0]
    behind = float(np.max(np.nan_to_num(shadow[own] @ across, nan=np.inf))) + rim
    hidden = min(behind, far + float(middle @ across)) - lines.mean(backs + lacking).value
    # The unseen rim is anything from nothing to twice its mean: at both sides, and where the height of an end is seen.
    long = lines.mean(lines.lengths)
    return Extent(
        Measured(long.value, math.hypot(long.sigma, rim / math.sqrt(3))),
        Measured(wide.value, math.hypot(wide.sigma, rim * math.sqrt(2 / 3))),
        wide.value + max(hidden, 0.0),
        own,
    )


def _surface_at(end: Floats, pixels: NDArray[np.intp], heights: Floats, span: float) -> tuple[float, float, float]:
    """Return the height in metres of the rock's surface at an end, its standard deviation, and if the end is visible.

    The height is that of a plane through the heights (N,) at the rock's pixels (N, 2) in a circle around the end. A
    visible end is on the outline, which is convex, and a hidden one anywhere inside of it. The last number is the
    probability that it is visible.
    """
    apart = np.linalg.norm(pixels - end, axis=1)
    radius = max(_AROUND * span, _AROUND_PX)
    outline = cv2.convexHull(pixels.astype(np.float32))
    inside = max(cv2.pointPolygonTest(outline, end.tolist(), True), 0.0)
    on_outline = math.exp(-((inside / _RIM) ** 2) / 2) / (math.sqrt(2 * math.pi) * _RIM)
    visible = on_outline / (on_outline + 1 / (_HIDDEN * span))
    # An end beside the rock has the height of the rock's nearest pixels.
    near = apart <= max(radius, float(np.max(np.sort(apart)[:_LEAST_POINTS])))
    weights = np.exp(-((apart[near] / float(np.max(apart[near]))) ** 2))[:, None]
    plane = np.append(pixels[near] - end, np.ones((len(weights), 1)), axis=1)
    coefficients, *_ = np.linalg.lstsq(plane * weights, heights[near] * weights[:, 0], rcond=None)
    residuals = (heights[near] - plane @ coefficients) * weights[:, 0]
    sigma = math.hypot(
        math.sqrt(float((residuals**2).sum() / (weights**2).sum())), _RIM * float(np.linalg.norm(coefficients[:2]))
    )
    return float(np.clip(coefficients[2], 0, float(np.max(heights[near])))), sigma, visible


def _lines(rays: Floats, height: float, shown: Sequence[tuple[float, float, float]]) -> _Lines:
    """Return the lines between all heights that the ends may have.

    ``rays`` (2, 2) are where the rays of the ends meet the ground, as seen from above, divided by the camera's
    ``height``, and ``shown`` has the height of the surface at each end, its deviation, and if the end is visible.
    """
    places, weights = [], []
    for ray, other, (surface, sigma, visible) in zip(rays, rays[::-1], shown, strict=True):
        heights = np.linspace(0, min(surface + 2 * sigma, _HIGHEST * height), _HEIGHTS)
        # At the camera's side of the rock, nothing hides an end.
        visible = 1.0 if ray @ (other - ray) > 0 else (1 - _BEHIND) * visible
        on_surface = np.exp(-(((heights - surface) / max(sigma, heights[1], 1e-6)) ** 2) / 2)
        # A hidden end is on the ground, or anywhere between ground and surface; both are equally likely.
        hidden = (heights <= surface).astype(float)
        hidden[0] += hidden.sum()
        weights.append(visible * on_surface / on_surface.sum() + (1 - visible) * hidden / hidden.sum())
        places.append(ray * (height - heights)[:, None])
    first, last = places
    pairs = np.stack(np.broadcast_arrays(first[:, None], last[None]), axis=2)
    return _Lines(pairs.reshape(-1, 2, 2), np.outer(*weights).ravel())


def _ranges(points: Floats, ways: Floats) -> tuple[Floats, Floats]:
    """Return the least and the largest places (M,) of points (N, 2) along unit vectors (M, 2), without outliers."""
    some = points[:: max(len(points) // _SOME, 1)]
    least, largest = np.quantile(some @ ways.T, (_OUTLIERS, 1 - _OUTLIERS), axis=0)
    return least, largest


def _fitting(lines: _Lines, points: Floats, shadow: Floats, span: float, rim: float, noise: float) -> _Lines:
    """Return lines with the weights that they have if a rock with these points (N, 2) begins and ends with the line.

    Raises `UnmeasurableError` if it does so with none of them. The line is the longest one across the rock, so the
    rock is not longer in any direction. Behind the points, the rock may hide the ground as far as their
    ``shadow`` (N, 2). ``noise`` is the standard deviation of a depth in metres.
    """
    lengths = lines.lengths
    begins, ends = _ranges(points, lines.along)
    places = (lines.ends * lines.along[:, None]).sum(axis=2)
    sigma = np.hypot(line_sigma(lengths, lengths / span), noise * lines.away(lines.along))
    turns = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    ways = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    longest = float(np.max(np.subtract(*_ranges(points, ways)[::-1])))
    hidden = _ranges(shadow[np.isfinite(shadow).all(axis=1)], lines.along)
    short = lengths - (np.maximum(ends, hidden[1]) - np.minimum(begins, hidden[0]) + 2 * rim)
    off = np.maximum(np.stack([places[:, 0] - begins, ends - places[:, 1], longest - lengths]), 0)
    likely = np.exp(-((off / sigma) ** 2).sum(axis=0) / 2)
    weights = lines.weights * likely * (short <= _SHORT * lengths)
    if (total := float(weights.sum())) >= _LEAST_LIKELY:
        return _Lines(lines.ends, weights / total)
    first, last, other, less = np.stack([*off, short]) @ lines.weights
    most, what = max(
        (max(first, last), "the rock goes on for {:.0f} cm beyond the line"),
        (other, "what stands at the line is {:.0f} cm longer in another direction than the line"),
        (less, "the line is {:.0f} cm longer than the rock"),
    )
    raise _mismatch(what.format(100 * most))


def _mismatch(what: str) -> UnmeasurableError:
    return UnmeasurableError(Unmeasurable.LINE_MISMATCH, f"{what}; draw the line from one end of one rock to the other")


def _alone(
    places: Floats, heights: Floats, looked_at: NDArray[np.bool_], least_rise: float, length: float
) -> tuple[float, float]:
    """Return the interval of places, in metres from the line's middle, that one rock has.

    Rocks are nearly convex: the height of one rock along an axis never falls and rises again, and its surface has no
    gap. The interval ends there, and is infinite where no other rock touches this one. A rise counts from
    ``least_rise`` in metres, or from a part of the highest place.
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
        limit, summit, lowest, last = way * math.inf, peak, peak, peak
        for place in sorted((one for one in top if (one - peak) * way > 0), reverse=way < 0):
            if abs(place - last) * size > _GAP * length:
                limit = (place + last) / 2 * size
                break
            if min(top[place], top[summit]) > top[lowest] + max(least_rise, _RISE * highest):
                limit = lowest * size
                break
            if top[place] > top[summit]:
                summit = lowest = place
            lowest, last = min(lowest, place, key=lambda one: top[one]), place
        limits.append(limit)
    return limits[0], limits[1]
