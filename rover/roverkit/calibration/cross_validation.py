"""Choice of the lens model by cross-validation: each model predicts views from which it was not computed.

More coefficients always fit the given views better. They predict other views better only if the lens needs them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from roverkit.calibration.adjustment import Estimate, adjust
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.board_shape import shaped_points
from roverkit.calibration.outliers import Choice
from roverkit.calibration.robust_fit import fit, observations_of, part_of, posed
from roverkit.calibration.solution import Model, PoorViewsError
from roverkit.calibration.start import residuals
from roverkit.calibration.verdict import BetterModel
from roverkit.calibration.views import View
from roverkit.vision.camera.camera_model import CameraParameters, Floats

FOLDS = 4
"""Number of groups of views; each group is predicted from the others."""
BETTER = 0.9
"""Largest ratio of a model's error to that of the model in use at which the model counts as better."""
_ORDER = (Model.PLUMB_BOB, Model.EQUIDISTANT, Model.RATIONAL)
"""Models, the simplest first."""
_ALIKE = 1.03
"""Ratio of two errors below which the simpler model is preferred."""
_CAP = 10.0
"""Largest residual that counts, as a multiple of the typical one, so that outliers do not decide."""


def better_model(
    views: Sequence[View], board: CalibrationBoard, model: Model, estimate: Estimate, choice: Choice
) -> BetterModel | None:
    """Return a lens model that predicts usable views clearly better than `model`; None if there is none.

    `estimate` and `choice` are the fit of `model` to the views.
    """
    fits = {model: (estimate, choice)}
    for other in _ORDER:
        if other is not model:
            try:
                fits[other] = fit(views, board, other)
            except PoorViewsError:
                continue  # this model does not fit the views at all
    lengths = {candidate: _prediction(views, board, *found) for candidate, found in fits.items()}
    cap = _CAP * min(float(np.median(length)) for length in lengths.values())
    errors = {candidate: float(np.sqrt(np.mean(np.minimum(found, cap) ** 2))) for candidate, found in lengths.items()}
    best = min(errors.values())
    chosen = next(candidate for candidate in _ORDER if candidate in errors and errors[candidate] <= _ALIKE * best)
    if chosen is model or errors[chosen] > BETTER * errors[model]:
        return None
    places = np.concatenate([view.corners for view in views])
    difference = _difference(estimate.camera, fits[chosen][0].camera, places)
    return BetterModel(chosen.value, errors[chosen], errors[model], difference)


def _prediction(views: Sequence[View], board: CalibrationBoard, estimate: Estimate, choice: Choice) -> Floats:
    """Return the lengths (N,) of the residuals of all corners, each predicted without the views of its group."""
    lengths = []
    for fold in range(FOLDS):
        dropped = [
            reason or ("held back" if index % FOLDS == fold else "") for index, reason in enumerate(choice.dropped)
        ]
        masks = [mask & (not reason) for mask, reason in zip(choice.masks, dropped)]
        rest = Choice(tuple(masks), tuple(dropped))
        observations = observations_of(views, board, estimate, rest)
        free = np.ones(estimate.shared, dtype=bool)
        trained = adjust(observations, part_of(estimate, rest), free)
        points = shaped_points(board, trained.shape)
        for view in views[fold::FOLDS]:
            pose = posed(view, board, replace(trained, poses=()))
            lengths.append(np.linalg.norm(residuals(view, points, trained.camera, pose), axis=1))
    finite: Floats = np.nan_to_num(np.concatenate(lengths), nan=np.inf)
    return finite


def _difference(camera: CameraParameters, other: CameraParameters, places: Floats) -> float:
    """Return the distance in pixels between two cameras' directions of `places` (N, 2), after the best rotation."""
    mine, theirs = camera.undistort(places), other.undistort(places)
    known = np.isfinite(mine).all(axis=1) & np.isfinite(theirs).all(axis=1)
    here, there = _directions(mine[known]), _directions(theirs[known])
    left, _, right = np.linalg.svd(here.T @ there)  # best rotation between two sets of directions (Kabsch, 1976)
    turned = there @ (left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right).T
    seen = camera.project(turned)
    return float(np.sqrt(np.nanmean(np.sum((seen - places[known]) ** 2, axis=1))))


def _directions(rays: Floats) -> Floats:
    lifted = np.column_stack([rays, np.ones(len(rays))])
    directions: Floats = lifted / np.linalg.norm(lifted, axis=1)[:, None]
    return directions
