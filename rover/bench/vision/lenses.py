"""Stated accuracy and judgement of calibrations: several lenses, bent boards, moving boards, and other lens models."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from textwrap import shorten
from typing import Any

import cv2
import numpy as np
from roverkit.calibration import BoardDetector, Judgement, Model, PoorViewsError, View, calibrate
from roverkit.vision import CameraParameters
from roverkit.vision.images.rendering import Floats, Lens, project

from bench.result import Group, SectionResult, Table
from rover.bench.vision.boards import BOARD, board_views, on_print, random_pose
from rover.bench.vision.calibration import PLAIN, SEED, VIEWS, projection_differences
from rover.bench.vision.contestants import OURS
from rover.bench.vision.scenes import lens

_WIDTH, _HEIGHT = 640, 480
CAMERAS = {
    Model.PLUMB_BOB: lens(_WIDTH, _HEIGHT),
    Model.RATIONAL: Lens(
        np.array([[330.0, 0, 323.3], [0, 331.3, 236.4], [0, 0, 1]]),
        (0.9, 0.3, 1e-3, -1e-3, 0.02, 1.2, 0.5, 0.05),
        (_WIDTH, _HEIGHT),
    ),
    Model.EQUIDISTANT: Lens(
        np.array([[267.0, 0, 322.3], [0, 267.8, 237.4], [0, 0, 1]]),
        (0.02, -0.008, 0.003, -0.0008),
        (_WIDTH, _HEIGHT),
        True,
    ),
}
"""Lens that follows each model: 38, 88 and 137 degrees from left to right."""
CAMERA = lens(1280, 720)
"""Camera of the bent and of the moving boards."""
BENDS = (0.0, 0.00025, 0.0005, 0.001, 0.002, 0.004, 0.008)
"""Heights in metres of a board of 264 mm that is bent to a cylinder."""
MOTIONS = (0.2, 0.5, 1.0, 4.0)
"""Standard deviation in pixels, along both axes, of the motion from the first to the last row."""
COMPUTED = 40
"""Number of views in the table without images; so many cover the whole image."""
NOISE = 0.03
"""Standard deviation in pixels of the corners in that table."""
_QUANTILE = 1.96  # 97.5 % quantile of the normal distribution
_SHORT = 32  # characters of a doubt in a table
_FEWEST = 12  # corners of a view in that table
_FLAGS: Any = cv2 if hasattr(cv2, "CALIB_RECOMPUTE_EXTRINSIC") else cv2.fisheye  # cv2.fisheye in OpenCV 4
_FISHEYE = _FLAGS.CALIB_USE_INTRINSIC_GUESS | _FLAGS.CALIB_RECOMPUTE_EXTRINSIC | _FLAGS.CALIB_FIX_SKEW


@dataclass(frozen=True, slots=True)
class Run:
    """Result of one calibration of a contestant, compared with the truth."""

    lens: str
    contestant: str
    inside: tuple[bool, ...]
    """For fx fy cx cy, whether the true value is in the stated 95 % interval; empty if no interval is stated."""
    fx: float
    """Error in percent."""
    projection: float
    """Distance in pixels between equal rays of the true and the calibrated camera: root mean square at the corners."""


def measure(runs: int, say: Callable[[str], None]) -> SectionResult:
    """Measure `runs` calibrations of each lens from rendered images, and judge calibrations of computed corners."""
    found = list(measure_runs(runs, say))
    tables = [
        Table(
            f"Intervals, {VIEWS} rendered views of {_WIDTH}x{_HEIGHT}, {runs} runs",
            ("truth in the stated 95 % interval, %", "fx", "fy", "cx", "cy", "projection px\nmedian", "largest"),
            [Group(model.value, list(_interval_rows(found, model))) for model in CAMERAS],
            [f"{PLAIN}: calibrateCameraExtended or fisheye.calibrate, with the corners that roverlink has fitted."],
        ),
        Table(
            f"Judgement, {COMPUTED} views, corners computed with noise of {NOISE} px",
            ("", "judgement", f"fx %\n{OURS}", PLAIN, f"projection px\n{OURS}", PLAIN),
            [
                Group("a bent board", [_judged(f"{1000 * bend:g} mm", bent(bend)) for bend in BENDS]),
                Group("motion during readout", [_judged(f"{size:g} px", moving(size)) for size in MOTIONS]),
                *(
                    Group(f"a lens that follows {model.value}", list(_models(truth)))
                    for model, truth in CAMERAS.items()
                ),
            ],
            ["Projection: distance between equal rays of the true and the found camera at the corners (RMS)."],
        ),
    ]
    return SectionResult(tables, (), {"lenses": [asdict(result) for result in found]})


def measure_runs(runs: int, say: Callable[[str], None] = lambda _: None) -> Iterator[Run]:
    """Yield the results of both contestants for rendered views of each lens."""
    detector = BoardDetector(BOARD)
    for model, camera in CAMERAS.items():
        for run in range(runs):
            views = [detector.find(view.frame, view.name) for view in board_views(camera, SEED + run, VIEWS)]
            found = calibrate(views, BOARD, model)
            yield _run(camera, views, model, OURS, found.camera, found.deviations[:4])
            yield _run(camera, views, model, PLAIN, *plain(views, model))
            say(f"lens {model.value}: {run + 1} of {runs} runs")


def plain(views: Sequence[View], model: Model) -> tuple[CameraParameters, Floats | None]:
    """Calibrate with OpenCV; return the camera and the standard deviations of fx fy cx cy if OpenCV states them."""
    usable = [view for view in views if not view.flaw]
    size = usable[0].size
    if model is Model.EQUIDISTANT:
        # (1, N, 3) and (1, N, 2), because OpenCV 5.0 rejects (N, 1, 3).
        objects = [BOARD.points[view.ids][None] for view in usable]
        images = [view.corners[None] for view in usable]
        start = np.array([[0.4 * size[0], 0, size[0] / 2], [0, 0.4 * size[0], size[1] / 2], [0, 0, 1]])
        _, matrix, distortion, *_ = cv2.fisheye.calibrate(objects, images, size, start, np.zeros(4), flags=_FISHEYE)
        return CameraParameters(matrix, distortion, size, fisheye=True), None
    objects = [BOARD.points[view.ids].astype(np.float32) for view in usable]
    images = [view.corners.astype(np.float32) for view in usable]
    rational = model is Model.RATIONAL
    flags = cv2.CALIB_RATIONAL_MODEL if rational else 0
    _, matrix, distortion, _, _, deviations, *_ = cv2.calibrateCameraExtended(
        objects, images, size, None, None, flags=flags
    )
    return CameraParameters(matrix, np.ravel(distortion)[: 8 if rational else 5], size), np.ravel(deviations)[:4]


def bent(bend: float) -> list[View]:
    """Return views of a board that is a cylinder of the given height in metres."""
    points = BOARD.points
    points[:, 2] += bend * (2 * points[:, 0] / BOARD.size[0] - 1) ** 2
    return _views(CAMERA, points)


def moving(size: float) -> list[View]:
    """Return views in which the board moves by about `size` pixels while the image is read out."""
    return _views(CAMERA, BOARD.points, size)


def _views(camera: Lens, points: Floats, motion: float = 0.0) -> list[View]:
    rng = np.random.default_rng(SEED)
    views: list[View] = []
    while len(views) < COMPUTED:
        _, pose = random_pose(camera, rng)
        pixels = project(camera, pose, on_print(points))
        pixels += np.outer(pixels[:, 1] / camera.size[1] - 0.5, rng.normal(0, motion, 2))
        pixels += rng.normal(0, NOISE, pixels.shape)
        seen = ((pixels > 2) & (pixels < np.array(camera.size) - 3)).all(axis=1)
        if seen.sum() >= _FEWEST:
            sigmas = np.full(seen.sum(), NOISE)
            views.append(View(f"view {len(views)}", np.flatnonzero(seen), pixels[seen], sigmas, camera.size))
    return views


def _run(
    truth: Lens,
    views: Sequence[View],
    model: Model,
    contestant: str,
    camera: CameraParameters,
    deviations: Floats | None = None,
) -> Run:
    (fx, _, cx), (_, fy, cy), _ = truth.matrix.tolist()
    error = np.concatenate([camera.focal, camera.centre]) - (fx, fy, cx, cy)
    inside = () if deviations is None else tuple((np.abs(error) <= _QUANTILE * deviations).tolist())
    distances = projection_differences(camera, truth, np.concatenate([view.corners for view in views]))
    return Run(model.value, contestant, inside, float(100 * error[0] / fx), float(np.sqrt(np.mean(distances**2))))


def _interval_rows(runs: Sequence[Run], model: Model) -> Iterator[tuple[str, ...]]:
    for name in (OURS, PLAIN):
        chosen = [run for run in runs if run.lens == model.value and run.contestant == name]
        inside = [f"{100 * share:.0f}" for share in np.mean([one.inside for one in chosen], axis=0)] or [""] * 4
        errors = [one.projection for one in chosen]
        yield name, *inside, f"{np.median(errors):.3f}", f"{max(errors):.3f}"


def _models(truth: Lens) -> Iterator[tuple[str, ...]]:
    views = _views(truth, BOARD.points)
    for model in CAMERAS:
        yield _judged(f"--model {model.value}", views, truth, model)


def _judged(name: str, views: Sequence[View], truth: Lens = CAMERA, model: Model = Model.PLUMB_BOB) -> tuple[str, ...]:
    theirs = _run(truth, views, model, PLAIN, *plain(views, model))
    try:
        found = calibrate(views, BOARD, model)
    except PoorViewsError:
        return name, "refused", "", f"{theirs.fx:.2f}", "", f"{theirs.projection:.2f}"
    ours = _run(truth, views, model, OURS, found.camera)
    errors = ours.fx, theirs.fx, ours.projection, theirs.projection
    return name, _words(found.judgement), *(f"{error:.2f}" for error in errors)


def _words(judgement: Judgement) -> str:
    """Return the verdict, with the first words of each doubt."""
    doubts = (shorten(doubt.text, _SHORT, placeholder="...") for doubt in judgement.doubts)
    return "\n".join([judgement.verdict.value, *doubts])
