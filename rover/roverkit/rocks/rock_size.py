"""Size of a rock with standard deviations, from a fitted ellipsoid and from the extent that is seen.

The ellipsoid is right for smooth rocks, and its misfit says how angular a rock is. Of an angular rock, the extent says
more. An end of the line that is high may be anywhere between the surface and the ground behind it, so the length is a
little smaller than that of the ellipsoid. The width is about a fifth larger than what is seen, but not larger than what
the rays over the upper edge allow. Both widths have a sigma, and the result is their weighted mean.

The numbers were fitted to 80 rendered rocks: ellipsoids, irregular rocks, slabs and polyhedra.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from roverkit.rocks.ellipsoid import Ellipsoid
from roverkit.rocks.extent import Extent

_SMOOTH, _ANGULAR = 1.1, 1.4
"""Misfits up to which a rock is smooth, and from which it is angular."""
_CLICK_PX = 1.5
"""Standard deviation of the length in pixels that comes from the ends of the line."""
_FIT = 0.015  # standard deviation of an ellipsoid's length, as a fraction of it
_FACES = 0.055  # its growth with the misfit
_BACK, _GAP_SIGMA, _WIDE_GAP = 0.25, 0.3, 0.15
"""Parts of the gap between least and largest length: the expected place of the end, and its standard deviation.

The first one counts for gaps that are wide, as a fraction of the length; at a narrow gap, the end is on the ground.
"""
_HIDDEN, _TRIMMED = 1.2, 1.06
"""Width over the width that is seen, and the largest one over its limit: the foot of a rock does not stand out."""
_SEEN_SIGMA, _SHADOW_SIGMA = 0.08, 0.18
"""Standard deviations of this width: as a fraction of what is seen, and of the gap to the limit."""
_DIVIDED = 0.15  # standard deviation of both widths, as a fraction, if another rock touches this one
_ROUND, _WIDTH_FIT, _WIDTH_FACES = 0.03, 0.03, 0.15
"""Correction of an ellipsoid's width at angular rocks, its standard deviation, and the growth with the misfit."""
_DISAGREEMENT = 0.45  # part of the difference of both widths that counts as a standard deviation


class Measured(NamedTuple):
    """Value with its standard deviation."""

    value: float
    sigma: float


def length_of(ellipsoid: Ellipsoid, extent: Extent, pixel: float) -> Measured:
    """Return the length in metres; ``pixel`` is the size of a pixel at the rock in metres."""
    angular = _angular(ellipsoid)
    gap = extent.length[1] - extent.length[0]
    length = ellipsoid.length - _BACK * angular * gap * min(gap / (_WIDE_GAP * ellipsoid.length), 1.0)
    faces = _FACES * max(ellipsoid.misfit - 1, 0.0)
    return Measured(length, math.hypot(_CLICK_PX * pixel, length * _FIT, length * faces, _GAP_SIGMA * angular * gap))


def width_of(ellipsoid: Ellipsoid, extent: Extent, pixel: float) -> Measured:
    """Return the width in metres; ``pixel`` is the size of a pixel at the rock in metres."""
    seen, limit = extent.width
    angular = _angular(ellipsoid)
    one = Measured(
        min(_HIDDEN * seen, _TRIMMED * limit),
        # The back of a smooth rock is rounder, and more of it is hidden.
        (2 - angular) * math.hypot(_SEEN_SIGMA * seen, _SHADOW_SIGMA * min(limit - seen, seen)),
    )
    fitted = ellipsoid.width
    spread = fitted * (_WIDTH_FIT + _WIDTH_FACES * max(ellipsoid.misfit - 1, 0.0))
    other = Measured(fitted * (1 + _ROUND * angular), spread)
    weight = other.sigma**2 / (one.sigma**2 + other.sigma**2)
    disagreement = 2 * math.sqrt(weight * (1 - weight)) * abs(one.value - other.value)
    width = weight * one.value + (1 - weight) * other.value
    divided = 0.0 if extent.alone else _DIVIDED * width
    return Measured(width, math.hypot(one.sigma * math.sqrt(weight), _DISAGREEMENT * disagreement, pixel, divided))


def _angular(ellipsoid: Ellipsoid) -> float:
    """Return 0 for a smooth rock, 1 for an angular one, and a number between both for others."""
    return min(max((ellipsoid.misfit - _SMOOTH) / (_ANGULAR - _SMOOTH), 0.0), 1.0)
