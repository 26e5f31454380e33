"""Renderer of rocks on an inclined ground, as the depth camera of a D435i sees them, with known lengths and widths.

A rock is an ellipsoid whose radius is multiplied by smooth noise, or a polyhedron: a slab, or what flat cuts leave of
an ellipsoid. Another rock may touch it. The stereo camera's errors are modelled: noise that
grows with the square of the distance and that neighbouring pixels share, foreground that is a pixel too wide, steps of
a millimetre, holes at edges and beside near objects (where one of the two imagers sees nothing), and holes in patches.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Protocol

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


class Rock(Protocol):
    """Rock on a plane, in its own frame: x along, y across and z up, from its centre on the ground, in metres."""

    def ends(self) -> Floats:
        """Return the two points (2, 3) of the surface that are farthest apart along the rock, as seen from above."""

    def surface(self) -> Floats:
        """Return points (N, 3) of the surface above the ground, with all that are outermost as seen from above."""

    def depths(self, origin: Floats, rays: Floats) -> Floats:
        """Return the factors (N,) of rays (N, 3) from an origin (3,) where they meet the rock; NaN if they do not."""


@dataclass(frozen=True, slots=True)
class SmoothRock:
    """Rock like an ellipsoid: semi-axes along, across and up in metres, and the height of its centre over the plane."""

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

    def ends(self) -> Floats:
        """Return the ends along the axis x."""
        surface = self.surface()
        return surface[[int(np.argmin(surface[:, 0])), int(np.argmax(surface[:, 0]))]]

    def surface(self) -> Floats:
        """Return evenly distributed points."""
        index = np.arange(_DIRECTIONS) + 0.5
        up = 1 - 2 * index / _DIRECTIONS
        turn = np.pi * (1 + 5**0.5) * index
        level = np.sqrt(1 - up * up)
        directions = np.stack([level * np.cos(turn), level * np.sin(turn), up], axis=-1)
        points = directions * self.radius(directions)[:, None] * self.axes + (0, 0, self.lift)
        return np.asarray(points[points[:, 2] >= 0])

    def depths(self, origin: Floats, rays: Floats) -> Floats:
        """Return where rays enter the rock, by steps through a sphere that contains the scaled rock, and bisection."""
        found = np.full(len(rays), np.nan)
        scaled_origin, scaled = (origin - (0, 0, self.lift)) / self.axes, rays / self.axes
        a, b = (scaled**2).sum(axis=-1), scaled @ scaled_origin
        inside = b * b - a * (scaled_origin @ scaled_origin - _MARGIN**2)
        hit = np.flatnonzero(inside > 0)
        root = np.sqrt(inside[hit])
        near, far = (-b[hit] - root) / a[hit], (-b[hit] + root) / a[hit]
        steps = near + np.linspace(0, 1, _STEPS)[:, None] * (far - near)
        outside = self.outside(origin + steps[..., None] * rays[hit]) > 0
        first = (~outside).argmax(axis=0)
        met = np.flatnonzero((~outside).any(axis=0) & (first > 0))
        before, after, ways = steps[first[met] - 1, met], steps[first[met], met], rays[hit][met]
        for _ in range(_BISECTIONS):
            middle = (before + after) / 2
            out = self.outside(origin + middle[:, None] * ways) > 0
            before, after = np.where(out, middle, before), np.where(out, after, middle)
        found[hit[met]] = after
        return found


@dataclass(frozen=True, slots=True)
class Polyhedron:
    """Rock with flat faces: the points p above the ground with ``normals @ p <= distances``."""

    normals: Floats
    distances: Floats

    def ends(self) -> Floats:
        """Return the two corners that are farthest apart, as seen from above."""
        corners = self.surface()
        apart = np.linalg.norm(corners[:, None, :2] - corners[None, :, :2], axis=-1)
        return corners[list(np.unravel_index(int(np.argmax(apart)), apart.shape))]

    def surface(self) -> Floats:
        """Return the corners: where three planes meet, and no other one cuts the point off."""
        normals, distances = np.vstack([self.normals, (0, 0, -1)]), np.append(self.distances, 0)
        triples = np.array(list(combinations(range(len(normals)), 3)))
        triples = triples[np.abs(np.linalg.det(normals[triples])) > 1e-6]
        corners = np.linalg.solve(normals[triples], distances[triples][..., None])[..., 0]
        return np.asarray(corners[(corners @ normals.T <= distances + 1e-9).all(axis=1)])

    def depths(self, origin: Floats, rays: Floats) -> Floats:
        """Return where rays enter the last one of the half-spaces, if they have left none of them before."""
        outside, slopes = self.normals @ origin - self.distances, rays @ self.normals.T
        factors = -outside / np.where(np.abs(slopes) < 1e-12, 1e-12, slopes)
        enters = np.where(slopes < 0, factors, -np.inf).max(axis=1)
        leaves = np.where(slopes > 0, factors, np.inf).min(axis=1)
        return np.where((enters < leaves) & (enters > 0), enters, np.nan)


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
    count: int,
    seed: int,
    *,
    bumps: float = 0.0,
    lift: float = 0.0,
    turn: tuple[float, float] = (0, 60),
    faces: int = 0,
    slab: bool = False,
    touched: bool = False,
) -> Iterator[RockScene]:
    """Yield scenes with random rocks, cameras and grounds.

    The radius of the ellipsoids is multiplied by smooth noise with the standard deviation `bumps`. The centre of a rock
    is above the ground by `lift` times its vertical semi-axis. `turn` has the smallest and the largest angle in degrees
    between the rock's long axis and the horizontal of the image. With `faces`, a rock is a polyhedron with so many
    random faces, some of which are below the ground; a `slab` is flat, and has an upper side. With `touched`, another
    polyhedron lies beside the rock.
    """
    made = 0
    for number in range(20 * count):
        if made == count:
            return
        rng = np.random.default_rng([seed, number])
        along = rng.uniform(0.06, 0.2)
        across = along * rng.uniform(0.5, 0.95)
        up = across * (rng.uniform(0.2, 0.35) if slab else rng.uniform(0.5, 1.1))
        axes = np.array([along, across, up])
        rock = _polyhedron(rng, axes, faces, slab=slab) if faces else _smooth(rng, axes, lift * up, bumps)
        others: list[tuple[Rock, Floats]] = []
        if touched:
            other = _polyhedron(rng, 0.8 * axes[[0, 1, 1]], faces or 30)
            apart = float(np.ptp(rock.surface()[:, 1]) + np.ptp(other.surface()[:, 1])) / 2
            others.append((other, rng.choice([-1, 1]) * np.array([0.0, apart, 0.0])))
        scene = _scene(rng, rock, turn, others)
        if scene is not None:
            made += 1
            yield scene
    raise AssertionError("too few random scenes have the whole rock in the image")


def _smooth(rng: np.random.Generator, axes: Floats, lift: float, bumps: float) -> SmoothRock:
    if not bumps:
        return SmoothRock(axes, lift)
    vectors = rng.normal(size=(_WAVES, 3))
    vectors *= (rng.uniform(1.5, 5, _WAVES) / np.linalg.norm(vectors, axis=1))[:, None]
    heights = rng.uniform(0.3, 1, _WAVES)
    heights *= bumps * np.sqrt(2) / np.linalg.norm(heights)  # the mean square of a sine is a half
    return SmoothRock(axes, lift, np.column_stack([vectors, rng.uniform(0, 2 * np.pi, _WAVES), heights]))


def _polyhedron(rng: np.random.Generator, axes: Floats, faces: int, *, slab: bool = False) -> Polyhedron:
    """Return what cuts at random places leave of an ellipsoid with semi-axes (3,)."""
    normals = rng.normal(size=(faces, 3))
    if slab:
        normals[:, 2] *= 0.3
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    distances = np.linalg.norm(normals * axes, axis=1) * rng.uniform(0.8, 1, faces)
    box = np.vstack([np.eye(3), -np.eye(3)])  # without it, few cuts can leave something endless
    return Polyhedron(np.vstack([normals, box]), np.append(distances, [*axes, *axes]))


def _scene(
    rng: np.random.Generator, rock: Rock, turn: tuple[float, float], others: Sequence[tuple[Rock, Floats]]
) -> RockScene | None:
    """Return a scene with a random camera, or None if the rock reaches out of the image."""
    distance = rng.uniform(0.6, 2.0)
    down, roll = np.radians(rng.uniform(22, 60)), np.radians(rng.uniform(-12, 12))
    # The direction to the rock, and the ground's normal: away from gravity by the slope that `roll` and `down` include.
    middle = np.append(rng.uniform(-0.25, 0.25, 2), 1.0)
    centre = distance * middle / np.linalg.norm(middle)
    normal = np.array([np.sin(roll) * np.cos(down), -np.cos(roll) * np.cos(down), -np.sin(down)])
    return render(rock, centre, normal, np.radians(rng.choice([-1, 1]) * rng.uniform(*turn)), rng, others)


def render(
    rock: Rock,
    centre: Floats,
    normal: Floats,
    turn: float,
    rng: np.random.Generator,
    others: Sequence[tuple[Rock, Floats]] = (),
) -> RockScene | None:
    """Return the scene of a rock on the ground, or None if the rock reaches out of the image.

    `centre` is the rock's centre on the ground in the optical frame, `normal` the ground's normal, and `turn` the angle
    in radians by which the rock is turned about it, from the image's horizontal. `others` are other rocks, each with
    its place (3,) in the rock's frame.
    """
    right = np.cross(np.cross(normal, (1.0, 0, 0)), normal)
    right /= np.linalg.norm(right)
    behind = np.cross(normal, right)
    axes = np.stack(
        [np.cos(turn) * right + np.sin(turn) * behind, np.cos(turn) * behind - np.sin(turn) * right, normal]
    )
    surface, both = rock.surface(), rock.ends()
    between = (both[1] - both[0])[:2]
    length = float(np.linalg.norm(between))
    side = surface[:, :2] @ (np.array([-between[1], between[0]]) / length)
    seen = camera().project(surface @ axes + centre)
    if not ((seen > 4) & (seen < np.array(LENS.size) - 5)).all():
        return None
    pixels = np.rint(camera().project(both @ axes + centre) + rng.normal(0, CLICK, (2, 2))).astype(int)
    exact = _exact(((rock, np.zeros(3)), *others), centre, axes)
    x1, y1, x2, y2 = pixels.ravel().tolist()
    width = float(np.ptp(side))
    return RockScene(measured(exact, rng), exact, (x1, y1, x2, y2), length, width, (normal, -float(normal @ centre)))


def _exact(rocks: Sequence[tuple[Rock, Floats]], centre: Floats, axes: Floats) -> Depth:
    """Return the depth of ground and rocks, without errors."""
    width, height = LENS.size
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    pixels = np.stack([x.ravel(), y.ravel()], axis=-1).astype(float)
    rays = np.append(camera().undistort(pixels), np.ones((len(pixels), 1)), axis=1)
    slope = rays @ axes[2]
    depth = np.where(slope < 0, float(axes[2] @ centre) / np.minimum(slope, -1e-9), np.nan)
    depth[~(depth < 10)] = np.nan
    for rock, place in rocks:
        depth = np.fmin(depth, rock.depths(-centre @ axes.T - place, rays @ axes.T))
    return np.asarray(depth.reshape(height, width))


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
