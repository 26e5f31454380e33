"""World with objects: what all worlds have in common, and the scene that a camera sees of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.objects.detected_objects import Box
from roverkit.objects.scenes.rendered_camera import FAR, Canvas, ImagingConditions
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverkit.vision.poses.pose import Pose

_VISIBLE = 0.3
"""Least part of an object's pixels that must be visible; others have no box."""
_SMALLEST = 9
"""Least width and height of a box in pixels."""
_TILE = 1024  # side of the drawing of the ground in pixels, which is repeated
_TILE_M = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class SceneObject:
    """Object with its truth."""

    number: int
    """Number of the object in its world, from 1."""
    class_name: str
    box: Box
    """Box around its visible pixels."""
    position: Floats
    """Middle (3,) of the side that faces the camera, in the optical frame, in metres."""


@dataclass(frozen=True, slots=True, eq=False)
class RenderedScene:
    """Image with its truth."""

    image: Image
    """BGR image (480, 640, 3)."""
    depth: NDArray[np.float32]
    """Depth (480, 640) in metres; NaN for the sky."""
    objects: tuple[SceneObject, ...]
    camera: Pose
    """Transform from the optical frame to the world: x ahead, y to the left, z up (REP 103)."""


def looking(eye: Floats, target: Floats) -> Pose:
    """Return the pose of a camera without roll that looks at a point of the world."""
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0.0, 0, 1])
    right /= np.linalg.norm(right)
    return Pose(np.column_stack([right, np.cross(ahead, right), ahead]), eye)


def smooth(rng: np.random.Generator, shape: tuple[int, int], cells: int) -> Floats:
    """Return noise (H, W) that is smooth over cells, with mean 0 and standard deviation 1; it can be repeated."""
    small = rng.normal(size=(cells, cells)).astype(np.float32)
    wrapped = np.pad(small, 2, mode="wrap")
    scale = shape[1] / cells
    large = cv2.resize(wrapped, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)
    cut = round(2 * scale)
    noise: Floats = large[cut : cut + shape[0], cut : cut + shape[1]]
    return noise / max(float(noise.std()), 1e-6)


class World(ABC):
    """Objects and their surroundings."""

    def __init__(self, rng: np.random.Generator) -> None:
        red = rng.uniform(60, 210)
        green = red * rng.uniform(0.6, 1.02)
        self.ground = np.array([green * rng.uniform(0.55, 1.0), green, red])  # from grey to sand and red
        coarse, fine = smooth(rng, (_TILE, _TILE), 24), smooth(rng, (_TILE, _TILE), 256)
        grain = rng.normal(size=(_TILE, _TILE))
        shade = 1 + rng.uniform(0.03, 0.12) * coarse + rng.uniform(0.02, 0.1) * fine + rng.uniform(0.01, 0.08) * grain
        self._tile = np.clip(self.ground * shade[..., None], 0, 255).astype(np.float32)
        self._sky = rng.uniform(120, 240) * np.array([1.0, 0.95, 0.9]) * rng.uniform(0.9, 1.1, 3)

    def _draw_ground(self, canvas: Canvas) -> None:
        depth = canvas.meet(np.zeros(3), np.array([0.0, 0, 1]))
        places = canvas.pose.translation + depth[..., None] * canvas.rays
        scaled = np.nan_to_num(places[..., :2] / _TILE_M * _TILE).astype(np.float32)
        colours = cv2.remap(self._tile, scaled[..., 0], scaled[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
        haze = np.nan_to_num(np.clip(depth / FAR, 0, 1), nan=1.0)[..., None] ** 2
        canvas.image[:] = (1 - haze) * colours + haze * np.where(np.isnan(depth)[..., None], self._sky, self.ground)
        canvas.depth[:] = depth

    @abstractmethod
    def _draw(self, canvas: Canvas, conditions: ImagingConditions) -> None:
        """Draw the objects, the far ones first."""

    @abstractmethod
    def _objects(self) -> list[tuple[str, Floats]]:
        """Return the class of each object, and the middle (3,) of its front."""

    def place(self, rng: np.random.Generator) -> Pose:
        """Return a random pose of the camera from which objects can be seen."""
        eye, target = self.way(rng)[0]
        return looking(eye, target)

    @abstractmethod
    def way(self, rng: np.random.Generator) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Return the places of the camera, and the points at which it looks, at the begin and the end of a drive."""

    def seen_from(self, pose: Pose, rng: np.random.Generator, conditions: ImagingConditions) -> RenderedScene:
        """Return the scene as a camera sees it."""
        canvas = Canvas(pose)
        self._draw_ground(canvas)
        self._draw(canvas, conditions)
        found = []
        for number, (name, front) in enumerate(self._objects(), 1):
            rows, columns = np.nonzero(canvas.numbers == number)
            if rows.size < _VISIBLE * canvas.whole.get(number, np.inf):
                continue
            left, top, right, bottom = columns.min(), rows.min(), columns.max() + 1, rows.max() + 1
            if min(right - left, bottom - top) >= _SMALLEST:
                box = Box(float(left), float(top), float(right - left), float(bottom - top))
                found.append(SceneObject(number, name, box, canvas.seen(front)))
        return RenderedScene(conditions.apply(canvas.image, rng), canvas.depth, tuple(found), pose)
