"""Size of a rock with standard deviations, from a fitted ellipsoid and from the extent that is seen.

The ellipsoid is right for smooth rocks, and its misfit says how angular a rock is. The length of an angular rock is the
distance of the line's ends, and its width a weighted sum of the ellipsoid's, of what is seen, and of the largest one.

The numbers were fitted to 214 rendered rocks: ellipsoids, slabs and polyhedra, also some that touch another one.
"""

from __future__ import annotations

import math

from roverkit.rocks.ellipsoid import Ellipsoid
from roverkit.rocks.extent import Extent, Measured

_SMOOTH, _ANGULAR = 1.1, 1.4
"""Misfits up to which a rock is smooth, and from which it is angular."""
_LENGTH_PX, _LENGTH = 1.75, 0.0145
"""Standard deviation of the length, in pixels and as a fraction: the line's ends and the ground are not exact."""
_WIDTH_PX, _WIDTH = 2.0, 0.047
"""The same for the width."""
_ROUND = 0.985
"""Width of a smooth rock, as a fraction of the ellipsoid's."""
_FITTED, _SEEN, _LIMIT = 0.30, 0.49, 0.25
"""Weights of the ellipsoid's width, of what is seen and of the largest width, for angular rocks."""
_HIDDEN, _DISAGREEMENT = 0.18, 0.70
"""Standard deviation of this width: parts of what may be hidden, and of the ellipsoid's distance from the middle."""
_DIVIDED = 0.07  # standard deviation of a width, as a fraction, if another rock touches this one


def length_of(ellipsoid: Ellipsoid, extent: Extent, pixel: float) -> Measured:
    """Return the length in metres; ``pixel`` is the size of a pixel at the rock in metres."""
    angular = _angular(ellipsoid)
    length = (1 - angular) * ellipsoid.length + angular * extent.length.value
    return Measured(length, math.hypot(_LENGTH_PX * pixel, _LENGTH * length, angular * extent.length.sigma))


def width_of(ellipsoid: Ellipsoid, extent: Extent, length: float, pixel: float) -> Measured:
    """Return the width in metres of a rock with this length; ``pixel`` is the size of a pixel at the rock in metres."""
    angular, fitted, seen = _angular(ellipsoid), ellipsoid.width, extent.width[0]
    limit = min(extent.width[1], length)  # the line is the longest one across the rock
    width = (1 - angular) * _ROUND * fitted + angular * (_FITTED * fitted + _SEEN * seen + _LIMIT * limit)
    unsure = angular * math.hypot(_HIDDEN * (limit - seen), _DISAGREEMENT * (fitted - (seen + limit) / 2))
    divided = 0.0 if extent.alone else _DIVIDED * width
    return Measured(width, math.hypot(_WIDTH_PX * pixel, _WIDTH * width, unsure, divided))


def _angular(ellipsoid: Ellipsoid) -> float:
    """Return 0 for a smooth rock, 1 for an angular one, and a number between both for others."""
    return min(max((ellipsoid.misfit - _SMOOTH) / (_ANGULAR - _SMOOTH), 0.0), 1.0)
