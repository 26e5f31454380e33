"""Solver: computes a calibration from views, leaves out outliers, and estimates the uncertainty.

A view is the set of board corners found in one image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from roverlink.vision.calibration.adjustment import Estimate, Observation, adjust, information, linearise
from roverlink.vision.calibration.board import CalibrationBoard
from roverlink.vision.calibration.outliers import Choice, choose, measure
from roverlink.vision.calibration.refusal import check_count, check_coverage, check_sizes
from roverlink.vision.calibration.solution import COEFFICIENTS, Calibration, Fitted, Model
from roverlink.vision.calibration.start import residuals, rough_camera, rough_pose
from roverlink.vision.calibration.views import View
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.poses.pose import Pose

_ROUNDS = 10
_ROBUST_PASSES = 5
_ROUGHLY = 1e-3


def calibrate(views: Sequence[View], board: CalibrationBoard, model: Model = Model.PLUMB_BOB) -> Calibration:
    """Compute the camera's parameters and their uncertainty from views of a board; all images must have the same size.

    Raises `PoorViewsError` if too few views are usable, or if the views show too little of the image or too few tilts.
    """
    usable = [view for view in views if not view.flaw]
    check_sizes(usable)
    check_count(len(usable), len(views))
    estimate, choice = _without_outliers(usable, board, _start(usable, board, model))
    fitted = [
        Fitted(view, pose, residuals(view, board, estimate.camera, pose), mask, reason)
        for view, pose, mask, reason in zip(usable, estimate.poses, choice.masks, choice.dropped)
    ]
    kept = [one for one in fitted if not one.dropped]
    check_count(len(kept), len(views))
    check_coverage(kept, board, estimate.camera)
    squares = np.concatenate([one.residuals[one.used] for one in kept]) ** 2
    found = iter(fitted)
    return Calibration(
        camera=estimate.camera,
        model=model,
        covariance=_covariance(_observations(usable, board, estimate, choice), _part(estimate, choice)),
        rms=float(np.sqrt(squares.sum(axis=1).mean())),
        views=tuple(_unusable(view) if view.flaw else next(found) for view in views),
    )


def _start(views: Sequence[View], board: CalibrationBoard, model: Model) -> Estimate:
    """Return a first estimate of camera and poses from all corners; robust weights reduce the influence of outliers."""
    rough = rough_camera(views, board, fisheye=model is Model.EQUIDISTANT)
    camera = replace(rough, distortion=np.zeros(len(COEFFICIENTS[model])))
    estimate = Estimate(camera, tuple(rough_pose(view, board, rough)[0] for view in views))
    names = ("fx", "fy", "cx", "cy", *COEFFICIENTS[model])
    # First the parameters that matter most: from a rough start, k2 and k3 would explain what is still wrong with the
    # focal length, and the minimum nearby could be a wrong one.
    for free in (("fx", "fy", "k1"), names):
        chosen = np.array([name in free for name in names])
        for _ in range(_ROBUST_PASSES):
            weights = measure(views, board, estimate).robust_weights()
            estimate = adjust(_weighted(views, board, weights), estimate, chosen, _ROUGHLY)
    return estimate


def _without_outliers(views: Sequence[View], board: CalibrationBoard, estimate: Estimate) -> tuple[Estimate, Choice]:
    """Improve an estimate by leaving out outliers; return it with the selection of corners on which it is based.

    Selecting corners and adjusting the estimate alternate until the selection stays the same.
    """
    free = np.ones(4 + estimate.camera.distortion.size, dtype=bool)
    before: Choice | None = None
    for _ in range(_ROUNDS):
        choice = choose(measure(views, board, estimate))
        # Selecting and adjusting can alternate between two selections; `_ROUNDS` limits that.
        if choice.same(before):
            break
        check_count(len(choice.kept), len(views))
        part = adjust(_observations(views, board, estimate, choice), _part(estimate, choice), free)
        poses = list(estimate.poses)
        for place, pose in zip(choice.kept, part.poses):
            poses[place] = pose
        estimate = _with_dropped(views, board, Estimate(part.camera, tuple(poses)), choice)
        before = choice
    return estimate, choice


def _with_dropped(views: Sequence[View], board: CalibrationBoard, estimate: Estimate, choice: Choice) -> Estimate:
    """Return the estimate with new poses for the views that were left out, because they may fit in the next round.

    The camera's parameters stay unchanged.
    """
    fixed = np.zeros(4 + estimate.camera.distortion.size, dtype=bool)
    poses = list(estimate.poses)
    for place, reason in enumerate(choice.dropped):
        if reason:
            view = [views[place]]
            alone = Estimate(estimate.camera, (rough_pose(view[0], board, estimate.camera)[0],))
            weights = measure(view, board, alone).robust_weights()
            poses[place] = adjust(_weighted(view, board, weights), alone, fixed).poses[0]
    return Estimate(estimate.camera, tuple(poses))


def _part(estimate: Estimate, choice: Choice) -> Estimate:
    """Return the estimate with only the poses of the views that are used."""
    return Estimate(estimate.camera, tuple(estimate.poses[place] for place in choice.kept))


def _observations(
    views: Sequence[View], board: CalibrationBoard, estimate: Estimate, choice: Choice
) -> list[Observation]:
    """Return the corners that are used, grouped by view; views that were left out are missing."""
    weights = measure(views, board, estimate).weights(choice.masks)
    return _weighted([views[place] for place in choice.kept], board, [weights[place] for place in choice.kept])


def _weighted(views: Sequence[View], board: CalibrationBoard, weights: Sequence[Floats]) -> list[Observation]:
    return [Observation(board.points[view.ids], view.corners, weight) for view, weight in zip(views, weights)]


def _unusable(view: View) -> Fitted:
    nothing = np.full((view.ids.size, 2), np.nan)
    nowhere = Pose(np.eye(3), np.full(3, np.nan))
    return Fitted(view, nowhere, nothing, np.zeros(view.ids.size, dtype=bool), view.flaw)


def _covariance(observations: Sequence[Observation], estimate: Estimate) -> Floats:
    """Return the covariance (P, P) of the camera's parameters.

    Normally it follows from the standard deviations of the corners. But the errors inside one view are correlated,
    because the board may be bent, or the lens may differ from its model. So views may contradict each other more than
    the standard deviations explain. For combinations of parameters for which they do, the covariance follows from these
    contradictions. This is the sandwich estimator of Huber (1967) and White (1980), with views as clusters, and with
    the correction for few clusters.
    """
    said = [information(linearizations) for linearizations in linearise(observations, estimate)]
    normal = np.sum([matrix for matrix, _ in said], axis=0)
    scale = 1 / np.sqrt(normal.diagonal())
    # Scaled to a unit diagonal first: pixels and distortion coefficients differ by many orders of magnitude.
    root = np.linalg.inv(np.linalg.cholesky(normal * scale[:, None] * scale)) * scale  # root.T @ root: normal's inverse
    sides = np.stack([root @ side for _, side in said])
    # For each view, its own push on the parameters. If the standard deviations of the corners told everything, these
    # would add up to the identity in this basis; eigenvalues above 1 are what they do not tell.
    disagreement = sides.T @ sides * len(said) / max(len(said) - len(normal), 1)
    sizes, axes = np.linalg.eigh(disagreement)
    covariance: Floats = root.T @ (axes * np.maximum(sizes, 1)) @ axes.T @ root
    return covariance
