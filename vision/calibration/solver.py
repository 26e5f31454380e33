"""From views to a camera: adjusts, leaves out what does not fit, and says how sure the rest makes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vision.calibration.adjustment import Estimate, Observation, adjust, information, linearise
from vision.calibration.board import CharucoBoard
from vision.calibration.coverage import CELLS, Coverage, Traits, region_name, traits
from vision.calibration.solution import COEFFICIENTS, Calibration, Fitted, Model, PoorViewsError
from vision.calibration.start import residuals, rough_camera, rough_pose
from vision.calibration.views import FEWEST_CORNERS, View
from vision.camera import CameraParameters, Floats
from vision.pose import Pose

FEWEST_VIEWS = 10
FEWEST_CELLS = 0.6
"""Least part of the cells of the image that must have corners."""
FEWEST_TILTED = 3
OUTLIER = 3.5
"""Corners whose residuals exceed so many standard deviations are left out."""
STRANGE = 4.0
"""A view is left out whose residuals are so many times those of the others (medians)."""
ROUNDS = 10
_RAYLEIGH_MEDIAN = 1.1774
"""Median length of a vector of two normal components, in their standard deviations."""
_ROBUST_PASSES = 8
_HUBER = 1.345
"""Standard deviations from where on residuals count by their size, not its square (Huber, 1964)."""

Masks = tuple[NDArray[np.bool_], ...]


def calibrate(views: Sequence[View], board: CharucoBoard, model: Model = Model.PLUMB_BOB) -> Calibration:
    """The camera that saw these views, which are of one size.

    Raises `PoorViewsError` where the views that are usable are too few, or do not cover enough.
    """
    flaws = [view.flaw for view in views]
    usable = [view for view, flaw in zip(views, flaws) if not flaw]
    _check_sizes(usable)
    _check_count(len(usable), len(views))
    estimate = _start(usable, board, model)
    estimate, used, dropped = _without_outliers(usable, board, estimate)
    fitted = _fitted(usable, board, estimate, used, dropped)
    kept = [one for one in fitted if not one.dropped]
    _check_count(len(kept), len(views))
    _check_coverage(kept, board, estimate.camera)
    found = iter(fitted)
    everything = tuple(next(found) if not flaw else _unusable(view, flaw) for view, flaw in zip(views, flaws))
    squares = np.concatenate([one.residuals[one.used] for one in kept]) ** 2
    return Calibration(
        camera=estimate.camera,
        model=model,
        covariance=_covariance(kept, board, estimate.camera),
        rms=float(np.sqrt(squares.sum(axis=1).mean())),
        views=everything,
    )


def _start(views: Sequence[View], board: CharucoBoard, model: Model) -> Estimate:
    """An estimate of all parameters from all corners, those that stand out counting less."""
    fisheye = model is Model.EQUIDISTANT
    rough = rough_camera(views, board, fisheye=fisheye)
    camera = replace(rough, distortion=np.zeros(len(COEFFICIENTS[model])))
    estimate = Estimate(camera, tuple(rough_pose(view, board, rough)[0] for view in views))
    names = ("fx", "fy", "cx", "cy", *COEFFICIENTS[model])
    for free in (("fx", "fy", "k1"), names):
        chosen = np.array([name in free for name in names])
        for _ in range(_ROBUST_PASSES):
            estimate = adjust(_observations(views, board, _huber(views, board, estimate)), estimate, chosen)
    return estimate


def _huber(views: Sequence[View], board: CharucoBoard, estimate: Estimate) -> list[Floats]:
    lengths = _lengths(views, board, estimate)
    limit = _HUBER * _sigma(lengths)
    return [np.nan_to_num(np.minimum(1, limit / np.maximum(one, 1e-12))) for one in lengths]


def _without_outliers(
    views: Sequence[View], board: CharucoBoard, estimate: Estimate
) -> tuple[Estimate, Masks, tuple[str, ...]]:
    """Adjust to the corners that fit, until these stay the same: which are used, and why views are dropped."""
    free = np.ones(4 + estimate.camera.distortion.size, dtype=bool)
    before: Masks | None = None
    for _ in range(ROUNDS):
        lengths = _lengths(views, board, estimate)
        dropped = _strange(lengths)
        sigma = _sigma([one for one, reason in zip(lengths, dropped) if not reason])
        masks = tuple(one < OUTLIER * sigma for one in lengths)  # nan is no less
        dropped = tuple(reason or _emptied(mask) for reason, mask in zip(dropped, masks))
        masks = tuple(mask & (not reason) for mask, reason in zip(masks, dropped))
        if before is not None and all((now == then).all() for now, then in zip(masks, before)):
            break
        before = masks
        kept = [place for place, reason in enumerate(dropped) if not reason]
        _check_count(len(kept), len(views))
        part = Estimate(estimate.camera, tuple(estimate.poses[place] for place in kept))
        weights = [masks[place].astype(float) for place in kept]
        part = adjust(_observations([views[place] for place in kept], board, weights), part, free)
        poses = list(estimate.poses)
        for place, pose in zip(kept, part.poses):
            poses[place] = pose
        estimate = _with_dropped(views, board, Estimate(part.camera, tuple(poses)), dropped)
    return estimate, masks, dropped


def _with_dropped(views: Sequence[View], board: CharucoBoard, estimate: Estimate, dropped: Sequence[str]) -> Estimate:
    """The poses of dropped views, too, by the camera that the others gave: they may turn out to fit."""
    fixed = np.zeros(4 + estimate.camera.distortion.size, dtype=bool)
    poses = list(estimate.poses)
    for place, reason in enumerate(dropped):
        if reason:
            alone = Estimate(estimate.camera, (rough_pose(views[place], board, estimate.camera)[0],))
            weights = _huber([views[place]], board, alone)
            poses[place] = adjust(_observations([views[place]], board, weights), alone, fixed).poses[0]
    return Estimate(estimate.camera, tuple(poses))


def _strange(lengths: Sequence[Floats]) -> tuple[str, ...]:
    """For each view, why it does not fit the others; empty where it does."""
    medians = np.array([np.median(np.nan_to_num(one, nan=np.inf)) for one in lengths])
    typical = float(np.median(medians))
    return tuple(
        (
            f"its corners are off by {median:.2g} px, those of the others by {typical:.2g} px: "
            "the picture is blurred, or the board was moving or bent"
            if median > STRANGE * typical
            else ""
        )
        for median in medians
    )


def _emptied(mask: NDArray[np.bool_]) -> str:
    left = int(mask.sum())
    return f"only {left} of its {mask.size} corners fit the other views" if left < FEWEST_CORNERS else ""


def _sigma(lengths: Sequence[Floats]) -> float:
    """The standard deviation of a coordinate's residual, from the median of all lengths."""
    return float(np.nanmedian(np.concatenate(lengths))) / _RAYLEIGH_MEDIAN


def _lengths(views: Sequence[View], board: CharucoBoard, estimate: Estimate) -> list[Floats]:
    return [
        np.linalg.norm(residuals(view, board, estimate.camera, pose), axis=1)
        for view, pose in zip(views, estimate.poses)
    ]


def _observations(views: Sequence[View], board: CharucoBoard, weights: Sequence[Floats]) -> list[Observation]:
    return [Observation(board.points[view.ids], view.corners, weight) for view, weight in zip(views, weights)]


def _fitted(
    views: Sequence[View], board: CharucoBoard, estimate: Estimate, used: Masks, dropped: Sequence[str]
) -> list[Fitted]:
    return [
        Fitted(view, pose, residuals(view, board, estimate.camera, pose), mask, reason)
        for view, pose, mask, reason in zip(views, estimate.poses, used, dropped)
    ]


def _unusable(view: View, flaw: str) -> Fitted:
    nothing = np.full((view.ids.size, 2), np.nan)
    return Fitted(view, Pose(np.eye(3), np.full(3, np.nan)), nothing, np.zeros(view.ids.size, dtype=bool), flaw)


def _covariance(kept: Sequence[Fitted], board: CharucoBoard, camera: CameraParameters) -> Floats:
    """The covariance (P, P) of the camera's parameters.

    The corners of a view err together: by blur, by the print, by what the model of the lens leaves out. So the noise
    is taken from how the views disagree, not the corners: the sandwich of Huber (1967) and White (1980) with views as
    clusters, and its correction for few of them.
    """
    observations = _observations([one.view for one in kept], board, [one.used.astype(float) for one in kept])
    estimate = Estimate(camera, tuple(one.pose for one in kept))
    said = [information(slopes) for slopes in linearise(observations, estimate)]
    normal = np.sum([matrix for matrix, _ in said], axis=0)
    scale = 1 / np.sqrt(normal.diagonal())
    inverse = np.linalg.inv(normal * scale[:, None] * scale) * scale[:, None] * scale
    middle = np.sum([np.outer(side, side) for _, side in said], axis=0)
    covariance: Floats = inverse @ middle @ inverse * len(kept) / (len(kept) - 1)
    return covariance


def _check_sizes(views: Sequence[View]) -> None:
    sizes = sorted({view.size for view in views})
    if len(sizes) > 1:
        named = ", ".join(f"{width}x{height}" for width, height in sizes)
        raise PoorViewsError((f"the images are of several sizes: {named}; calibrate one at a time",))


def _check_count(usable: int, given: int) -> None:
    if usable < FEWEST_VIEWS:
        raise PoorViewsError((f"{usable} of {given} views are usable, and {FEWEST_VIEWS} are needed",))


def _check_coverage(kept: Sequence[Fitted], board: CharucoBoard, camera: CameraParameters) -> None:
    """Whether the views that are left show enough of the image, and enough tilts."""
    coverage, shown = Coverage(), [_traits(one, board, camera) for one in kept]
    for one in shown:
        coverage.add(one)
    reasons = []
    empty = [need.name for need in coverage.needs() if need.kind == "region" and not need.have]
    count = CELLS[0] * CELLS[1]
    if len(empty) > (1 - FEWEST_CELLS) * count:
        where = ", ".join(dict.fromkeys(empty))
        reasons.append(f"{len(empty)} of {count} parts of the image have no corners: {where}")
    tilted = sum(bool(one.tilts) for one in shown)
    if tilted < FEWEST_TILTED:
        reasons.append(
            f"the board is tilted in {tilted} views, and {FEWEST_TILTED} are needed: facing the camera, its distance "
            "cannot be told from the focal length"
        )
    if reasons:
        raise PoorViewsError(tuple(reasons))


def _traits(one: Fitted, board: CharucoBoard, camera: CameraParameters) -> Traits:
    return traits(one.view, one.pose, camera.project(one.pose.apply(board.outline)))


__all__ = ["FEWEST_VIEWS", "calibrate", "region_name"]
