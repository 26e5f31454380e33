"""Length and width of a rock, from a depth image and a line across the rock.

The depth at the ends of a rock is the worst of the image: there, a stereo camera has holes, or sees the ground behind.
So the depth at the endpoints is not used. The plane of the ground is fitted to a ring around the line, and an ellipsoid
to what stands on it (module `ellipsoid`). Length and width are those of the ellipsoid.

A simpler computation needs no ellipsoid: the rays of the endpoints meet the ground at both ends, and the width is twice
the extent from there to the camera's side. If a rock is widest above the ground, then the rays meet the ground behind
its ends, and the width is wrong by 23 % in place of 3 % (`python -m rover.bench.vision --only rocks`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.rocks.ellipsoid import DepthPatch, fit_ellipsoid
from roverkit.rocks.ground import Ground, fit_ground
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
    width: float
    """Width in metres across the line, as seen from above."""
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
    pixels, distances = _around(ends, depth.shape)
    seen = depth[pixels[:, 1], pixels[:, 0]].astype(float)
    has_depth = np.isfinite(seen) & (seen > 0)
    span = float(np.linalg.norm(ends[1] - ends[0]))
    inside = distances <= _INNER * span
    for where, name in ((~inside, "around the line"), (inside, "at the line")):
        if (share := float(has_depth[where].mean()) if where.any() else 0.0) < LEAST_DEPTH:
            raise UnmeasurableError(
                Unmeasurable.LITTLE_DEPTH,
                f"only {share:.0%} of the pixels {name} have a depth, and {LEAST_DEPTH:.0%} are needed; look at the "
                "rock from another place or distance",
            )
    ground = _ground(*_some(camera, pixels, seen, has_depth & ~inside, _GROUND_POINTS))
    axes, ground_ends = _axes(ground, _directions(camera, ends))
    directions, depths = _some(camera, pixels, seen, has_depth & (distances <= _WIDEST * span), _ROCK_POINTS)
    patch = DepthPatch(
        float(np.linalg.norm(ground_ends[1] - ground_ends[0])),
        axes @ -ground_ends[0],
        directions @ axes.T,
        1 / depths,
    )
    size = fit_ellipsoid(patch)
    if size is None:
        raise UnmeasurableError(
            Unmeasurable.NO_ROCK,
            "nothing stands out of the ground at the line; draw it from one end of a rock to the other",
        )
    return RockSize(*size, ground, float(has_depth.mean()))


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


def _around(ends: Floats, shape: tuple[int, ...]) -> tuple[NDArray[np.intp], Floats]:
    """Return the pixels (N, 2) inside the ring's outer radius, and their distances (N,) from the line."""
    way = ends[1] - ends[0]
    outer = max(_OUTER * float(np.linalg.norm(way)), _LEAST_OUTER)
    low = np.maximum(np.floor(ends.min(axis=0) - outer), 0).astype(int)
    high = np.minimum(np.ceil(ends.max(axis=0) + outer), (shape[1] - 1, shape[0] - 1)).astype(int)
    x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    pixels = np.stack([x.ravel(), y.ravel()], axis=-1)
    along = np.clip((pixels - ends[0]) @ way / (way @ way), 0, 1)
    distances = np.linalg.norm(pixels - ends[0] - along[:, None] * way, axis=1)
    near = distances <= outer
    return pixels[near], distances[near]


def _some(
    camera: CameraParameters, pixels: NDArray[np.intp], seen: Floats, mask: NDArray[np.bool_], most: int
) -> tuple[Floats, Floats]:
    """Return directions (N, 3) and depths (N,) of the pixels in a mask: every n-th one, not many more than ``most``."""
    indices = np.flatnonzero(mask)
    indices = indices[:: max(len(indices) // most, 1)]
    directions = _directions(camera, pixels[indices])
    known = np.isfinite(directions).all(axis=1)  # the lens model may have no ray for a pixel
    return directions[known], seen[indices][known]


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
