"""Size of a rock with standard deviations, from a fitted ellipsoid and from the extent that is seen.

Each gives a length and a width, and both are weighted by their variances. If the lengths disagree by more than these,
one of them is wrong, and the standard deviation grows with the disagreement (R. T. Birge, Physical Review 40, 1932).
Neither sees the back of the rock, so the errors of the widths are not independent: the rock has one of two shapes, and
the variance is that of this mixture.
"""

from __future__ import annotations

import math

from roverkit.rocks.ellipsoid import Ellipsoid
from roverkit.rocks.extent import Extent, Measured, line_sigma

_WIDTH_PX, _WIDTH = 2.0, 0.047
"""Standard deviation of the width of a smooth rock, in pixels and as a fraction."""
_UNLIKE = 0.05
"""Standard deviation of an ellipsoid's size, as a fraction, for each unit of `Ellipsoid.unlike`."""
_ROUND = 0.985
"""Width of a smooth rock, as a fraction of the ellipsoid's."""


def length_of(ellipsoid: Ellipsoid, extent: Extent, pixel: float) -> Measured:
    """Return the length in metres; ``pixel`` is the size of a pixel at the rock in metres."""
    exact = float(line_sigma(extent.length.value, pixel))
    fitted = Measured(ellipsoid.length, math.hypot(exact, _UNLIKE * ellipsoid.unlike * ellipsoid.length))
    lifted = Measured(extent.length.value, math.hypot(extent.length.sigma, exact))
    return _combined(fitted, lifted, independent=True)


def width_of(ellipsoid: Ellipsoid, extent: Extent, length: float, pixel: float) -> Measured:
    """Return the width in metres of a rock with this length; ``pixel`` is the size of a pixel at the rock in metres.

    If another rock touches this one, its width may be as large as its length, because it is not known where one rock
    ends. Behind its visible edge, the rock takes a share of what may be hidden. A small share is likelier: the density
    falls linearly to 0 at the whole, so its mean is 1/3 and its variance 1/18.
    """
    least = extent.seen.value
    hidden = max((extent.limit if extent.own.all() else max(extent.limit, length)) - least, 0.0)
    exact = math.hypot(_WIDTH_PX * pixel, _WIDTH * least)
    seen = Measured(least + hidden / 3, math.hypot(exact, extent.seen.sigma, hidden / math.sqrt(18)))
    width = _ROUND * ellipsoid.width
    fitted = Measured(width, math.hypot(exact, _UNLIKE * ellipsoid.unlike * width))
    return _combined(fitted, seen, independent=False)


def _combined(first: Measured, second: Measured, *, independent: bool) -> Measured:
    """Return the mean of two measurements of the same, weighted by their variances."""
    both = math.hypot(first.sigma, second.sigma)
    weight = (second.sigma / both) ** 2
    spread = ((first.value - second.value) / both) ** 2
    # The variance of a mixture is p s^2 + q t^2 + p q (x - y)^2, where p = t^2 / (s^2 + t^2) and q = 1 - p.
    factor = max(spread, 1.0) if independent else 2 + spread
    sigma = first.sigma * second.sigma / both * math.sqrt(factor)
    return Measured(weight * first.value + (1 - weight) * second.value, sigma)
