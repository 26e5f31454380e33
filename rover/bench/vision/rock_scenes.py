"""Renderer of rocks on an inclined ground, as the depth camera of a D435i sees them, with known lengths and widths.

A rock is an ellipsoid whose radius is multiplied by smooth noise. The stereo camera's errors are modelled: noise that
grows with the square of the distance and that neighbouring pixels share, foreground that is a pixel too wide, steps of
a millimetre, holes at edges and beside near objects (where one of the two imagers sees nothing), and holes in patches.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from roverkit.vision import CameraParameters
from roverkit.vision.images.rendering import Floats, Lens

from rover.bench.vision.contestants import camera_of

Depth = NDArray[np.floating[Any]]
Line = tuple[int, int, int, int]

LENS = Lens(np.array([[615.0, 0, 318.4], [0, 615.6, 242.1], [0, 0, 1]]), (0.0,), (640, 480))
"""Colour camera of a D435i, to which the driver aligns the depth; it publishes no distortion."""
DISPARITY_NOISE = 0.08
"""Standard deviation of the disparity in pixels; the data sheet's test of flat targets allows 0.1."""
FOCAL_BASELINE = 382 * 0.05
"""Focal length in pixels times baseline in metres of the depth camera, at 640x480."""
CLICK = 0.5
"""Standard deviation in pixels of the line's endpoints, before they are rounded to whole pixels."""
_WAVES = 8
_STEPS, _BISECTIONS = 64, 18
_MARGIN = 1.35  # of the sphere around the scaled rock, in which its surface is searched
_DIRECTIONS = 40_000
_EDGE = 0.03  # step between neighbouring pixels that is an edge, as a fraction of the depth
_PATCHES = 0.04  # share of the image that holes in patches take


@dataclass(frozen=True, slots=True)
class Rock:
    """Rock on a plane: semi-axes along, across and up in metres, and the height of its centre over the plane."""

    axes: Floats
    lift: float = 0.0
    waves: Floats | None = None
    """Waves of the smooth noise (N, 5): their vectors, phases and heights; None for an exact ellipsoid."""

    def radius(self, directions: Floats) -> Floats:
        """Return the radius in each unit direction (..., 3), where the axes have the length 1."""
        radius = np.ones(directions.shape[:-1])
        if self.waves is not None:
            radius = radius + (np.sin(directions @ self.waves[:, :3].T + self.waves[:, 3]) @ self.waves[:, 4])
        return radius

    def outside(self, points: Floats) -> Floats:
        """Return a positive number for points (..., 3) outside of the rock, in its own frame."""
        scaled = (points - (0, 0, self.lift)) / self.axes
        distance = np.linalg.norm(scaled, axis=-1)
        return np.asarray(distance - self.radius(scaled / np.maximum(distance, 1e-9)[..., None]))

    def surface(self) -> Floats:
        """Return points (N, 3) of the surface above the ground, in the rock's frame."""
        index = np.arange(_DIRECTIONS) + 0.5
        up = 1 - 2 * index / _DIRECTIONS
        turn = np.pi * (1 + 5**0.5) * index
        level = np.sqrt(1 - up * up)
        directions = np.stack([level * np.cos(turn), level * np.sin(turn), up], axis=-1)
        points = directions * self.radius(directions)[:, None] * self.axes + (0, 0, self.lift)
        return np.asarray(points[points[:, 2] >= 0])


@dataclass(frozen=True, slots=True)
class RockScene:
    """Depth image of a rock, the line that an operator draws across it, and the truth."""

    depth: Depth
    """Depth (H, W) in metres as the camera measures it; NaN where it is missing."""
    exact: Depth
    """Depth without errors; NaN where no ground is seen."""
    line: Line
    """Endpoints x1, y1, x2, y2 of the line from one end of the rock to the other one, in pixels."""
    length: float
    """Length of the rock in metres: distance of the ends, seen from above."""
    width: float
    """Width of the rock in metres, perpendicular to the line, seen from above."""
    ground: tuple[Floats, float]
    """Normal of the ground, which points to the camera, and the camera's height over the ground."""


def camera() -> CameraParameters:
    """Return roverlink's parameters of the camera."""
    return camera_of(Lens(LENS.matrix, (), LENS.size))


def scenes(
    count: int, seed: int, *, bumps: float = 0.0, lift: float = 0.0, turn: tuple[float, float] = (0, 60)
) -> Iterator[RockScene]:
    """Yield scenes with random rocks, cameras and grounds.

    The radius of the ellipsoids is multiplied by smooth noise with the standard deviation `bumps`. The centre of a rock
    is above the ground by `lift` times its vertical semi-axis. `turn` has the smallest and the largest angle in degrees
    between the rock's long axis and the horizontal of the image.
    """
    made = 0
    for number in range(20 * count):
        if made == count:
            return
        scene = _scene(np.random.default_rng([seed, number]), bumps, lift, turn)
        if scene is not None:
            made += 1
            yield scene
    raise AssertionError("too few random scenes have the whole rock in the image")


def _scene(rng: np.random.Generator, bumps: float, lift: float, turn: tuple[float, float]) -> RockScene | None:
    """Return a random scene, or None if the rock reaches out of the image."""
    along = rng.uniform(0.06, 0.2)
    across = along * rng.uniform(0.5, 0.95)
    up = across * rng.uniform(0.5, 1.1)
    waves = None
    if bumps:
        vectors = rng.normal(size=(_WAVES, 3))
        vectors *= (rng.uniform(1.5, 5, _WAVES) / np.linalg.norm(vectors, axis=1))[:, None]
        heights = rng.uniform(0.3, 1, _WAVES)
        heights *= bumps * np.sqrt(2) / np.linalg.norm(heights)  # the mean square of a sine is a half
        waves = np.column_stack([vectors, rng.uniform(0, 2 * np.pi, _WAVES), heights])
    rock = Rock(np.array([along, across, up]), lift * up, waves)
    distance = rng.uniform(0.6, 2.0)
    down, roll = np.radians(rng.uniform(22, 60)), np.radians(rng.uniform(-12, 12))
    # The direction to the rock, and the ground's normal: away from gravity by the slope that `roll` and `down` include.
    middle = np.append(rng.uniform(-0.25, 0.25, 2), 1.0)
    centre = distance * middle / np.linalg.norm(middle)
    normal = np.array([np.sin(roll) * np.cos(down), -np.cos(roll) * np.cos(down), -np.sin(down)])
    return render(rock, centre, normal, np.radians(rng.choice([-1, 1]) * rng.uniform(*turn)), rng)


def render(rock: Rock, centre: Floats, normal: Floats, turn: float, rng: np.random.Generator) -> RockScene | None:
    """Return the scene of a rock on the ground, or None if the rock reaches out of the image.

    `centre` is the rock's centre on the ground in the optical frame, `normal` the ground's normal, and `turn` the angle
    in radians by which the rock is turned about it, from the image's horizontal.
    """
    right = np.cross(np.cross(normal, (1.0, 0, 0)), normal)
    right /= np.linalg.norm(right)
    behind = np.cross(normal, right)
    axes = np.stack(
        [np.cos(turn) * right + np.sin(turn) * behind, np.cos(turn) * behind - np.sin(turn) * right, normal]
    )
    surface = rock.surface()
    first, last = surface[int(np.argmin(surface[:, 0]))], surface[int(np.argmax(surface[:, 0]))]
    between = (last - first)[:2]
    length = float(np.linalg.norm(between))
    side = surface[:, :2] @ (np.array([-between[1], between[0]]) / length)
    ends = np.stack([first, last]) @ axes + centre
    seen = camera().project(surface @ axes + centre)
    if not ((seen > 4) & (seen < np.array(LENS.size) - 5)).all():
        return None
    pixels = np.rint(camera().project(ends) + rng.normal(0, CLICK, (2, 2))).astype(int)
    exact = _exact(rock, centre, axes)
    x1, y1, x2, y2 = pixels.ravel().tolist()
    width = float(np.ptp(side))
    return RockScene(measured(exact, rng), exact, (x1, y1, x2, y2), length, width, (normal, -float(normal @ centre)))


def _exact(rock: Rock, centre: Floats, axes: Floats) -> Depth:
    """Return the depth of ground and rock, without errors."""
    width, height = LENS.size
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    rays = np.append(camera().undistort(np.stack([x, y], axis=-1).astype(float)), np.ones((height, width, 1)), axis=-1)
    slope = rays @ axes[2]
    depth = np.where(slope < 0, float(axes[2] @ centre) / np.minimum(slope, -1e-9), np.nan)
    depth[~(depth < 10)] = np.nan
    # The rock in its own frame, and scaled so that a sphere of the radius `_MARGIN` contains it.
    origin, directions = (-centre @ axes.T), rays @ axes.T
    scaled_origin, scaled = (origin - (0, 0, rock.lift)) / rock.axes, directions / rock.axes
    a, b = (scaled**2).sum(axis=-1), scaled @ scaled_origin
    inside = b * b - a * (scaled_origin @ scaled_origin - _MARGIN**2)
    hit = inside > 0
    root = np.sqrt(inside[hit])
    near, far = (-b[hit] - root) / a[hit], (-b[hit] + root) / a[hit]
    steps = near + np.linspace(0, 1, _STEPS)[:, None] * (far - near)
    outside = rock.outside(origin + steps[..., None] * directions[hit]) > 0
    first = (~outside).argmax(axis=0)
    met = (~outside).any(axis=0) & (first > 0)
    columns = np.flatnonzero(met)
    before, after, ways = steps[first[met] - 1, columns], steps[first[met], columns], directions[hit][met]
    for _ in range(_BISECTIONS):
        middle = (before + after) / 2
        out = rock.outside(origin + middle[:, None] * ways) > 0
        before, after = np.where(out, middle, before), np.where(out, after, middle)
    mask = np.zeros((height, width), bool)
    mask[hit] = met
    depth[mask] = np.fmin(depth[mask], after)
    return np.asarray(depth)


def measured(exact: Depth, rng: np.random.Generator) -> Depth:
    """Return a depth image as a D435i measures it: with noise, holes and steps of a millimetre."""
    deep = np.where(np.isnan(exact), 1e3, exact).astype(np.float32)
    near = cv2.erode(deep, np.ones((3, 3), np.uint8))  # the foreground is a pixel too wide on each side
    noise = cv2.GaussianBlur(rng.normal(size=exact.shape).astype(np.float32), (0, 0), 1.2)
    noise *= DISPARITY_NOISE / float(noise.std())
    disparity = FOCAL_BASELINE / near + noise
    step = cv2.dilate(deep, np.ones((3, 3), np.uint8)) - near > _EDGE * near
    holes = cv2.dilate(step.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    holes |= _shadow(near)
    patches = cv2.GaussianBlur(rng.normal(size=exact.shape).astype(np.float32), (0, 0), 4)
    holes |= patches > np.quantile(patches, 1 - _PATCHES)
    depth = np.rint(1000 * FOCAL_BASELINE / np.maximum(disparity, 0.1)) / 1000
    depth[holes | (deep > 100) | (depth > 10) | (depth < 0.2)] = np.nan
    return np.asarray(depth)


def _shadow(depth: Depth) -> NDArray[np.bool_]:
    """Return where near objects hide the ground from the right imager: at the left of them."""
    # The depth's own image is 382 px to the colour's 615; a pixel of disparity covers more pixels of the colour image.
    shift = FOCAL_BASELINE / depth * (LENS.matrix[0, 0] / 382)
    hidden = np.zeros(depth.shape, bool)
    reach = np.full(len(depth), -np.inf)
    for column in range(depth.shape[1] - 1, -1, -1):
        # Where the right imager sees this pixel, by columns; what lies at the right of it must not be seen there too.
        place = column - shift[:, column]
        hidden[:, column] = place > -reach + 0.5
        reach = np.maximum(reach, -place)
    return hidden
