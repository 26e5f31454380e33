"""Fit of the camera, the shape of the board and its poses to views, without the outliers.

A view is the set of board corners found in one image.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from roverkit.calibration.adjustment import Estimate, Observation, adjust
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.board_shape import NUMBERS, displacements
from roverkit.calibration.outliers import Choice, choose, measure
from roverkit.calibration.refusal import check_count
from roverkit.calibration.solution import COEFFICIENTS, Model
from roverkit.calibration.start import rough_camera, rough_pose
from roverkit.calibration.views import View
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.poses.pose import Pose

_ROUNDS = 10
_SHAPE = "shape"
_ROBUST_PASSES = 5
_ROUGHLY = 1e-3


def fit(views: Sequence[View], board: CalibrationBoard, model: Model) -> tuple[Estimate, Choice]:
    """Return the estimate that fits usable views best, and the selection of corners on which it is based.

    Raises `PoorViewsError` if too few views fit each other.
    """
    return _without_outliers(views, board, _start(views, board, model))


def _start(views: Sequence[View], board: CalibrationBoard, model: Model) -> Estimate:
    """Return a first estimate of camera and poses from all corners; robust weights reduce the influence of outliers."""
    rough = rough_camera(views, board, fisheye=model is Model.EQUIDISTANT)
    camera = replace(rough, distortion=np.zeros(len(COEFFICIENTS[model])))
    estimate = Estimate(camera, tuple(rough_pose(view, board, rough)[0] for view in views), np.zeros(NUMBERS))
    names = ("fx", "fy", "cx", "cy", *COEFFICIENTS[model], *[_SHAPE] * NUMBERS)
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
    free = np.ones(estimate.shared, dtype=bool)
    before: Choice | None = None
    for _ in range(_ROUNDS):
        choice = choose(measure(views, board, estimate))
        # Selecting and adjusting can alternate between two selections; `_ROUNDS` limits that.
        if choice.same(before):
            break
        check_count(len(choice.kept), len(views))
        part = adjust(observations_of(views, board, estimate, choice), part_of(estimate, choice), free)
        poses = list(estimate.poses)
        for place, pose in zip(choice.kept, part.poses):
            poses[place] = pose
        estimate = _with_dropped(views, board, replace(part, poses=tuple(poses)), choice)
        before = choice
    return estimate, choice


def _with_dropped(views: Sequence[View], board: CalibrationBoard, estimate: Estimate, choice: Choice) -> Estimate:
    """Return the estimate with new poses for the views that were left out, because they may fit in the next round.

    The camera's parameters stay unchanged.
    """
    poses = list(estimate.poses)
    for place, reason in enumerate(choice.dropped):
        if reason:
            poses[place] = posed(views[place], board, estimate)
    return replace(estimate, poses=tuple(poses))


def posed(view: View, board: CalibrationBoard, estimate: Estimate) -> Pose:
    """Return the pose of the board in a view, with the camera and the shape of an estimate."""
    alone = replace(estimate, poses=(rough_pose(view, board, estimate.camera)[0],))
    weights = measure([view], board, alone).robust_weights()
    fixed = np.zeros(estimate.shared, dtype=bool)
    return adjust(_weighted([view], board, weights), alone, fixed).poses[0]


def part_of(estimate: Estimate, choice: Choice) -> Estimate:
    """Return the estimate with only the poses of the views that are used."""
    return replace(estimate, poses=tuple(estimate.poses[place] for place in choice.kept))


def observations_of(
    views: Sequence[View], board: CalibrationBoard, estimate: Estimate, choice: Choice
) -> list[Observation]:
    """Return the corners that are used, grouped by view; views that were left out are missing."""
    weights = measure(views, board, estimate).weights(choice.masks)
    return _weighted([views[place] for place in choice.kept], board, [weights[place] for place in choice.kept])


def _weighted(views: Sequence[View], board: CalibrationBoard, weights: Sequence[Floats]) -> list[Observation]:
    points = board.points
    moved = displacements(board, points)
    return [
        Observation(points[view.ids], moved[view.ids], view.corners, weight) for view, weight in zip(views, weights)
    ]
