"""Length and width of a rock, from a depth image and a line across the rock.

The depth at the ends of a rock is the worst of the image: there, a stereo camera has holes, or sees the ground behind.
So the depth at the endpoints is not used. The plane of the ground is fitted to a ring around the line. What stands on
it must begin and end with the line (modules `segment` and `extent`). An ellipsoid is fitted to it (module `ellipsoid`),
and the size follows from both (module `rock_size`).

A simpler computation needs no ellipsoid: the rays of the endpoints meet the ground at both ends, and the width is twice
the extent from there to the camera's side. If a rock is widest above the ground, then the rays meet the ground behind
its ends, and the width is wrong by 23 % in place of 3 % (`python -m rover.bench.vision --only rocks`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.rocks.ellipsoid import EllipsoidPatch, fit_ellipsoid
from roverkit.rocks.extent import extent_of
from roverkit.rocks.ground import Ground, fit_ground
from roverkit.rocks.rock_size import length_of, width_of
from roverkit.rocks.segment import DepthPatch, find_segment
from roverkit.rocks.unmeasurable import Unmeasurable, UnmeasurableError
from roverkit.vision.camera.camera_model import CameraParameters, Floats

Line = tuple[float, float, float, float]
"""Endpoints x1, y1, x2, y2 of a line in pixels of the image."""

SHORTEST = 10.0
"""Shortest line in pixels."""
LEAST_DEPTH = 0.3
"""Least share of the pixels that must have a depth: in the ring around the line, and inside it."""
_INNER, _OUTER = 0.45, 1.0
"""Radii of the ring around the line, as fractions of the line's length."""
_WIDEST = 0.9
"""Largest distance from the line of pixels to which the rock is fitted, as a fraction of the line's length."""
_SURROUNDINGS = 1.5
"""Distance from the line of the pixels that are looked at, as a fraction of its length: a rock may be longer."""
_LEAST_OUTER = 24.0
"""Least outer radius of the ring in pixels."""
_GROUND_POINTS, _ROCK_POINTS = 6000, 5000
"""Numbers of pixels that are used: every n-th one, if there are more."""
_LEAST_SHARE = 0.5
"""Least share of the points in the ring that must lie on the plane."""
_FLATTEST = float(np.sin(np.radians(6)))
"""Sine of the smallest angle between the ground and a ray. There, an error of 0.1 degrees changes a distance by 2 %."""


@dataclass(frozen=True, slots=True, eq=False)
class RockSize:
    """Size of a rock, and what it rests on."""

    length: float
    """Length in metres along the line, as seen from above."""
    length_sigma: float
    """Standard deviation of the length in metres."""
    width: float
    """Width in metres across the line, as seen from above."""
    width_sigma: float
    """Standard deviation of the width in metres."""
    ground: Ground
    """Plane of the ground, in the camera's optical frame."""
    valid: float
    """Share of the pixels around the line that have a depth."""


def measure(depth: NDArray[np.floating[Any]], camera: CameraParameters, line: Line) -> RockSize:
    """Return the size of the rock across which a line is drawn.

    ``depth`` (H, W) is in metres; where it is missing, it is NaN, infinite or 0. ``camera`` has the parameters of the
    image in which the line is drawn, and to which the depth is aligned. Raises `UnmeasurableError` with the reason if
    the size cannot be measured.
    """
    ends = _checked(line, depth.shape, camera)
    patch = _around(ends, depth, camera)
    span = float(np.linalg.norm(ends[1] - ends[0]))
    has_depth = patch.depth > 0
    inside = patch.distances <= _INNER * span
    ring = ~inside & (patch.distances <= max(_OUTER * span, _LEAST_OUTER))
    for where, name in ((ring, "around the line"), (inside, "at the line")):
        if (share := float(has_depth[where].mean()) if where.any() else 0.0) < LEAST_DEPTH:
            raise UnmeasurableError(
                Unmeasurable.LITTLE_DEPTH,
                f"only {share:.0%} of the pixels {name} have a depth, and {LEAST_DEPTH:.0%} are needed; look at the "
                "rock from another place or distance",
            )
    ground = _ground(*_some(patch, has_depth & ring, _GROUND_POINTS))
    rays = _directions(camera, ends)
    axes, ground_ends = _axes(ground, rays)
    segment = find_segment(patch, ground, ring, span)
    if segment is None:
        raise _no_rock()
    pixel = float(np.linalg.norm(ground_ends.mean(axis=0)) / camera.focal.mean())
    extent = extent_of(segment, ground, ends, rays, depth.shape[::-1], pixel)
    others = np.zeros(len(has_depth), bool)
    others[np.flatnonzero(segment.inside)[~extent.own]] = True
    directions, depths = _some(patch, has_depth & ~others & (patch.distances <= _WIDEST * span), _ROCK_POINTS)
    ellipsoid = fit_ellipsoid(
        EllipsoidPatch(
            float(np.linalg.norm(ground_ends[1] - ground_ends[0])),
            axes @ -ground_ends[0],
            directions @ axes.T,
            1 / depths,
        )
    )
    if ellipsoid is None:
        raise _no_rock()
    length = length_of(ellipsoid, extent, pixel)
    width = width_of(ellipsoid, extent, length.value, pixel)
    near = patch.distances <= max(_OUTER * span, _LEAST_OUTER)
    return RockSize(*length, *width, ground, float(has_depth[near].mean()))


def _no_rock() -> UnmeasurableError:
    return UnmeasurableError(
        Unmeasurable.NO_ROCK,
        "nothing stands out of the ground at the line; draw it from one end of a rock to the other",
    )


def _checked(line: Line, shape: tuple[int, ...], camera: CameraParameters) -> Floats:
    """Return the endpoints (2, 2) of a line. Raises `UnmeasurableError` if they cannot be measured in such an image."""
    height, width = shape
    if camera.size not in (None, (width, height)):
        raise UnmeasurableError(
            Unmeasurable.NOT_ALIGNED,
            f"the depth image has {width}x{height} pixels, but the camera {'{}x{}'.format(*camera.size)}; use the "
            "depth that is aligned to the camera's image",
        )
    ends = np.array(line, dtype=float).reshape(2, 2)
    if not ((ends >= 0) & (ends <= (width - 1, height - 1))).all():  # false for NaN, too
        raise UnmeasurableError(
            Unmeasurable.OUTSIDE_IMAGE, f"the line {_text(line)} is not inside the image of {width}x{height} pixels"
        )
    if (span := float(np.linalg.norm(ends[1] - ends[0]))) < SHORTEST:
        raise UnmeasurableError(
            Unmeasurable.SHORT_LINE,
            f"the line {_text(line)} is {span:.1f} px long; at least {SHORTEST:g} px are needed",
        )
    return ends


def _text(line: Line) -> str:
    x1, y1, x2, y2 = line
    return f"from ({x1:g}, {y1:g}) to ({x2:g}, {y2:g})"


def _around(ends: Floats, depth: NDArray[np.floating[Any]], camera: CameraParameters) -> DepthPatch:
    """Return the part of a depth image around a line."""
    way = ends[1] - ends[0]
    outer = max(_SURROUNDINGS * float(np.linalg.norm(way)), _LEAST_OUTER)
    low = np.maximum(np.floor(ends.min(axis=0) - outer), 0).astype(int)
    high = np.minimum(np.ceil(ends.max(axis=0) + outer), (depth.shape[1] - 1, depth.shape[0] - 1)).astype(int)
    x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    pixels = np.stack([x.ravel(), y.ravel()], axis=-1)
    along = (pixels - ends[0]) @ way / (way @ way)
    distances = np.linalg.norm(pixels - ends[0] - np.clip(along, 0, 1)[:, None] * way, axis=1)
    seen = depth[pixels[:, 1], pixels[:, 0]].astype(float)
    directions = _directions(camera, pixels)
    known = np.isfinite(seen) & (seen > 0) & np.isfinite(directions).all(axis=1)  # the lens model may have no ray
    return DepthPatch((x.shape[0], x.shape[1]), pixels, directions, np.where(known, seen, 0.0), distances, along)


def _some(patch: DepthPatch, mask: NDArray[np.bool_], most: int) -> tuple[Floats, Floats]:
    """Return directions (N, 3) and depths (N,) of the pixels in a mask: every n-th one, not many more than ``most``."""
    indices = np.flatnonzero(mask)
    indices = indices[:: max(len(indices) // most, 1)]
    return patch.directions[indices], patch.depth[indices]


def _directions(camera: CameraParameters, pixels: Floats | NDArray[np.intp]) -> Floats:
    """Return the points (N, 3) in the plane z = 1 that the camera sees at pixels (N, 2)."""
    return np.append(camera.undistort(np.asarray(pixels, dtype=float)), np.ones((len(pixels), 1)), axis=1)


def _ground(directions: Floats, depth: Floats) -> Ground:
    """Return the ground. Raises `UnmeasurableError` if there is none."""
    ground = fit_ground(directions, depth)
    if ground is None or ground.share < _LEAST_SHARE:
        share = (
            f"only {ground.share:.0%} of the points around the line are on one plane" if ground else "no plane found"
        )
        raise UnmeasurableError(
            Unmeasurable.NO_PLANE, f"{share}; the ground around the rock must be even, and most of it visible"
        )
    return ground


def _axes(ground: Ground, directions: Floats) -> tuple[Floats, Floats]:
    """Return the axes (3, 3) of the line's frame as rows, and the line's ends (2, 3) on the ground.

    Raises `UnmeasurableError` if the rays of the ends do not meet the ground at an angle that is large enough.
    """
    slopes = -(directions @ ground.normal) / np.linalg.norm(directions, axis=1)
    if not (slopes >= _FLATTEST).all():
        raise UnmeasurableError(
            Unmeasurable.NO_PLANE,
            "the line reaches the horizon of the ground, or nearly so; look at the rock from nearer or from above",
        )
    ends = ground.meet(directions)
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    return np.stack([along, np.cross(ground.normal, along), ground.normal]), ends
