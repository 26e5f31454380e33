"""Bundle adjustment: fits the camera's parameters, the shape of the board, and its pose in each view to the corners.

A view is the set of board corners found in one image. Each view has its own pose of the board; the camera and the shape
are shared by all views. The poses are eliminated by the Schur complement before the shared parameters are solved for
(Triggs et al., "Bundle adjustment - a modern synthesis", 2000). In the shapes of arrays, P is the number of shared
parameters (fx fy cx cy, the distortion coefficients, then the shape), and N the number of corners.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.board_shape import NUMBERS
from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.camera.parameter_derivatives import by_parameters
from roverkit.vision.poses.pose import Pose, predict

# OpenCV's calibrateCamera minimizes the same sum. This module exists because calibrateCamera takes neither weights nor
# masks: leaving out a corner, or trusting a blurred view less, would need a new list of points and a new start. It also
# keeps the derivatives to itself, from which the uncertainty is computed (`solver`).
#
# The unknowns are the camera (8 to 12 numbers), the shape (4), and 6 numbers for each view. The normal matrix of 20
# views would be 136 x 136, but views do not touch each other: each one is eliminated by itself, and only the shared
# part is left.
CONVERGED = 1e-10
_STEPS = 100
_LEAST_DAMPED, _MOST_DAMPED = 1e-9, 1e9  # range of Levenberg and Marquardt's damping factor


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """Observed corners of one image."""

    points: Floats
    """Places (N, 3) on the board that was meant, in metres."""
    displacements: Floats
    """Displacements (N, 3, 4) of the points for each value of a shape of 1, see `board_shape`."""
    pixels: Floats
    """Positions (N, 2) in the image."""
    weights: Floats
    """Weights (N,)."""

    def shaped(self, shape: Floats) -> Floats:
        """Return the places (N, 3) on a board with a shape (4,)."""
        shaped: Floats = self.points + self.displacements @ shape
        return shaped


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """Estimated camera parameters, pose of the board in each image (board to camera), and shape (4,) of the board."""

    camera: CameraParameters
    poses: tuple[Pose, ...]
    shape: Floats

    @property
    def shared(self) -> int:
        """Number of parameters that all views share."""
        return 4 + self.camera.distortion.size + self.shape.size


@dataclass(frozen=True, slots=True, eq=False)
class Linearization:
    """Residuals of one view at an estimate, with the derivatives of the predicted pixels.

    All rows are multiplied by the square roots of the corners' weights. Corners of weight 0 are left out.
    """

    residuals: Floats
    """Observed minus predicted pixels (2N,): x and y of the first corner, then of the second, and so on."""
    by_shared: Floats
    """Derivative (2N, P) of the predicted pixels with respect to the shared parameters."""
    by_pose: Floats
    """Derivative (2N, 6) of the predicted pixels with respect to the board's pose in this view."""


def adjust(
    observations: Sequence[Observation], estimate: Estimate, free: NDArray[np.bool_], tolerance: float = CONVERGED
) -> Estimate:
    """Return the camera, the shape and the poses with the smallest sum of squared residuals, starting at `estimate`.

    `free` (P,) marks the shared parameters that may change; all poses may change. The Levenberg-Marquardt algorithm
    finds the nearest minimum. It stops when the sum changes by less than the fraction `tolerance`.
    """
    views = linearise(observations, estimate)
    damping, cost = 1e-3, _cost(views)
    for _ in range(_STEPS):
        moved = _step(views, estimate, free, damping)
        moved_slopes = linearise(observations, moved) if moved else []
        moved_cost = _cost(moved_slopes) if moved else math.inf
        if moved is None or not moved_cost <= cost:  # true for NaN too
            if damping > _MOST_DAMPED:
                break
            damping *= 10
            continue
        gain, cost, views, estimate = cost - moved_cost, moved_cost, moved_slopes, moved
        damping = max(damping / 10, _LEAST_DAMPED)
        if gain <= tolerance * cost:
            break
    return estimate


def linearise(observations: Sequence[Observation], estimate: Estimate) -> list[Linearization]:
    """Return, for each view, the residuals at an estimate and the derivatives of the predicted pixels.

    The derivatives are with respect to the shared parameters and to the board's pose in the view.
    """
    predicted = [
        predict(pose, observation.shaped(estimate.shape)) for observation, pose in zip(observations, estimate.poses)
    ]
    rays, by_pose = (np.concatenate(parts) for parts in zip(*predicted))  # one call for all views is faster
    # A shape moves points on the board, as a translation of the board would.
    by_shape = np.concatenate(
        [
            by_one[:, :, :3] @ pose.rotation @ observation.displacements
            for (_, by_one), pose, observation in zip(predicted, estimate.poses, observations)
        ]
    )
    pixels, slope = estimate.camera.distort_with_derivative(rays)
    roots = np.sqrt(np.concatenate([observation.weights for observation in observations]))[:, None]
    residuals = roots * (np.concatenate([observation.pixels for observation in observations]) - pixels)
    by_camera = by_parameters(estimate.camera, rays)
    by_shared = roots[:, :, None] * np.concatenate([by_camera, slope @ by_shape], axis=2)
    by_pose = roots[:, :, None] * (slope @ by_pose)
    counted = roots[:, 0] > 0  # corners of weight 0 may be NaN
    ends = np.cumsum([len(observation.weights) for observation in observations])
    return [
        Linearization(
            residuals[start:end][counted[start:end]].ravel(),
            by_shared[start:end][counted[start:end]].reshape(-1, by_shared.shape[2]),
            by_pose[start:end][counted[start:end]].reshape(-1, 6),
        )
        for start, end in zip([0, *ends], ends)
    ]


def information(view: Linearization) -> tuple[Floats, Floats]:
    """Return the normal equations of one view for the shared parameters alone: matrix (P, P) and right side (P,).

    The board's pose in the view, which is unknown too, is eliminated from the equations.
    """
    # A least squares solution of the derivatives themselves. The Schur complement of the normal matrices is the same on
    # paper, but squares the condition number, and the result is inverted.
    free_of_pose = view.by_shared - view.by_pose @ np.linalg.lstsq(view.by_pose, view.by_shared, rcond=None)[0]
    return free_of_pose.T @ free_of_pose, free_of_pose.T @ view.residuals


def moved_camera(camera: CameraParameters, change: Floats) -> CameraParameters:
    """Return a camera whose parameters fx fy cx cy and distortion are those of `camera` plus `change` (P,)."""
    matrix = camera.matrix.copy()
    matrix[[0, 1, 0, 1], [0, 1, 2, 2]] += change[:4]
    return replace(camera, matrix=matrix, distortion=camera.distortion + change[4:])


def _cost(views: Sequence[Linearization]) -> float:
    return float(sum(view.residuals @ view.residuals for view in views))


def _step(
    views: Sequence[Linearization], estimate: Estimate, free: NDArray[np.bool_], damping: float
) -> Estimate | None:
    """Return the estimate after one damped Gauss-Newton step; None if the step leads to an impossible camera."""
    count = int(free.sum())
    normal, right = np.zeros((count, count)), np.zeros(count)
    eliminated = []
    for view in views:
        by_shared = view.by_shared[:, free]
        by_both = view.by_pose.T @ by_shared
        own = view.by_pose.T @ view.by_pose
        # Marquardt's damping: scale the diagonal, so that steps do not depend on the units of the parameters.
        own.flat[::7] *= 1 + damping
        solved = np.linalg.solve(own, np.column_stack([by_both, view.by_pose.T @ view.residuals]))
        diagonal = by_shared.T @ by_shared
        diagonal.flat[:: count + 1] *= 1 + damping
        normal += diagonal - by_both.T @ solved[:, :-1]
        right += by_shared.T @ view.residuals - by_both.T @ solved[:, -1]
        eliminated.append(solved)
    # A focal length is about 1000 and k3 about 0.1: scaled to a unit diagonal, rounding affects both alike.
    scale = 1 / np.sqrt(normal.diagonal())
    change = np.zeros(free.size)
    change[free] = scale * np.linalg.solve(normal * scale[:, None] * scale, scale * right)
    matrix = estimate.camera.matrix
    if not np.isfinite(change).all() or min(matrix[0, 0] + change[0], matrix[1, 1] + change[1]) <= 0:
        return None
    poses = tuple(
        pose.moved(solved[:, -1] - solved[:, :-1] @ change[free]) for pose, solved in zip(estimate.poses, eliminated)
    )
    return Estimate(moved_camera(estimate.camera, change[:-NUMBERS]), poses, estimate.shape + change[-NUMBERS:])
