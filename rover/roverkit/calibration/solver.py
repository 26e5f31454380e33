"""Solver: computes a calibration from views, estimates its uncertainty, and judges it.

A view is the set of board corners found in one image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from roverkit.calibration.adjustment import Estimate, Observation, information, linearise
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.board_shape import NUMBERS, shaped_points
from roverkit.calibration.evidence import gather
from roverkit.calibration.refusal import check_count, check_coverage, check_sizes
from roverkit.calibration.robust_fit import fit, observations_of, part_of
from roverkit.calibration.solution import Calibration, Fitted, Model
from roverkit.calibration.start import residuals
from roverkit.calibration.verdict import judge
from roverkit.calibration.views import View
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.poses.pose import Pose


def calibrate(views: Sequence[View], board: CalibrationBoard, model: Model = Model.PLUMB_BOB) -> Calibration:
    """Compute the camera's parameters and their uncertainty from views of a board; all images must have the same size.

    Raises `PoorViewsError` if too few views are usable, or if the views show too little of the image or too few tilts.
    """
    usable = [view for view in views if not view.flaw]
    check_sizes(usable)
    check_count(len(usable), len(views))
    estimate, choice = fit(usable, board, model)
    points = shaped_points(board, estimate.shape)
    fitted = [
        Fitted(view, pose, residuals(view, points, estimate.camera, pose), mask, reason)
        for view, pose, mask, reason in zip(usable, estimate.poses, choice.masks, choice.dropped)
    ]
    kept = [result for result in fitted if not result.dropped]
    check_count(len(kept), len(views))
    coverage = check_coverage(kept, board, estimate.camera)
    squares = np.concatenate([result.residuals[result.used] for result in kept]) ** 2
    found = iter(fitted)
    covariance = _covariance(observations_of(usable, board, estimate, choice), part_of(estimate, choice))
    calibration = Calibration(
        camera=estimate.camera,
        model=model,
        covariance=covariance[:-NUMBERS, :-NUMBERS],
        rms=float(np.sqrt(squares.sum(axis=1).mean())),
        views=tuple(_unusable(view) if view.flaw else next(found) for view in views),
        shape=estimate.shape,
        shape_covariance=covariance[-NUMBERS:, -NUMBERS:],
    )
    return replace(calibration, judgement=judge(gather(calibration, usable, board, estimate, choice, coverage)))


def _unusable(view: View) -> Fitted:
    nothing = np.full((view.ids.size, 2), np.nan)
    nowhere = Pose(np.eye(3), np.full(3, np.nan))
    return Fitted(view, nowhere, nothing, np.zeros(view.ids.size, dtype=bool), view.flaw)


def _covariance(observations: Sequence[Observation], estimate: Estimate) -> Floats:
    """Return the covariance (P, P) of the parameters that all views share.

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
    # The correction for few clusters is at most 2. It grows without limit as the number of views comes near that of the
    # parameters: with 12 views, the stated uncertainty was two to three times the error.
    disagreement = sides.T @ sides * len(said) / (len(said) - min(len(normal), len(said) / 2))
    sizes, axes = np.linalg.eigh(disagreement)
    covariance: Floats = root.T @ (axes * np.maximum(sizes, 1)) @ axes.T @ root
    return covariance
