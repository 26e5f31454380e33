"""Detections without images: corners where they should be, and noise."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from roverkit.vision import LandmarkDetection, Pose, TargetId
from roverkit.vision.markers.marker_set import square
from roverkit.vision.poses.pnp import Corners, solve, square_poses
from roverkit.vision.poses.pose import predict, rotation_of

FACING = np.diag([1.0, -1.0, -1.0])
NOISE = 2e-5  # In the plane z = 1: a fiftieth of a pixel at a focal length of 1000


def detection(
    number: int, to_camera: Pose, rng: np.random.Generator, side: float = 0.15, *, shared: bool = False
) -> LandmarkDetection:
    """What a marker at a pose looks like."""
    points = square(side)
    rays, _ = predict(to_camera, points)
    seen = Corners(points, rays + rng.normal(0, NOISE, rays.shape), np.eye(8) * NOISE**2)
    (solutions,) = solve([seen], square_poses(points[None], seen.rays[None]))
    best = solutions[0]
    return LandmarkDetection(
        number, 0, seen.rays, best.pose, best.covariance, math.inf, 0.0, seen, tuple(solutions), shared
    )


def wall() -> dict[TargetId, Pose]:
    """Markers on a wall at x = 5 of the field, and on two posts, all facing -x."""
    toward_us = np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]])  # right is -y, up is z, out is -x
    places = {1: (5, 1.5, 1), 2: (5, -1.2, 0.6), 3: (4, 0.2, 0.4), 4: (3.2, 0.9, 0.3)}
    leaning = {1: 0.0, 2: 0.4, 3: -0.5, 4: 0.3}
    return {
        number: Pose(rotation_of(np.array([0, 0, leaning[number]])) @ toward_us, np.array(place, dtype=float))
        for number, place in places.items()
    }


def camera_on_field(rng: np.random.Generator) -> Pose:
    """A camera somewhere near the field's origin that looks along x: takes its points to the field."""
    ahead = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
    return Pose(rotation_of(rng.normal(0, 0.08, 3)) @ ahead, rng.uniform((-0.3, -0.5, 0.3), (0.8, 0.5, 0.7)))


def view(camera: Pose, places: Mapping[TargetId, Pose], rng: np.random.Generator) -> list[LandmarkDetection]:
    """All markers, seen from a camera."""
    return [detection(int(number), camera.inverse() @ place, rng) for number, place in places.items()]
