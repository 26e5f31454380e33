"""Accuracy of calibrations compared with plain OpenCV, and correctness of their stated uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass

import cv2
import numpy as np

from bench.result import Group, SectionResult, Table
from bench.vision.accuracy import nees_band
from bench.vision.boards import BOARD, BoardView, board_views, corrupted
from bench.vision.contestants import OURS
from bench.vision.scenes import lens
from roverlink.vision import CameraParameters
from roverlink.vision.calibration import BoardDetector, calibrate
from roverlink.vision.frames.frame import size_of
from roverlink.vision.images.rendering import Floats, Lens

SIZE = (1280, 720)
SMALL = (640, 480)
"""Image size of the many runs for the intervals."""
VIEWS = 20
BAD = 7
"""Index of the corrupted view."""
SEED = 11
PLAIN = "OpenCV"
COLUMNS = (
    "worst of all runs",
    "RMS\npx",
    "fx\n%",
    "cx\npx",
    "cy\npx",
    "projection\nmean px",
    "projection\nmax px",
    "bad view\nnamed %",
)
GOAL = ("goal", "0.10", "0.1", "0.5", "0.5", "0.15", "0.4", "100")
_QUANTILE = 1.96  # 97.5 % quantile of the normal distribution


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of a contestant: camera, standard deviations of its parameters, RMS, and views left out."""

    camera: CameraParameters
    deviations: Floats
    covariance: Floats | None
    rms: float
    dropped: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Miss:
    """Error of one calibration."""

    contestant: str
    run: int
    bad_views: int
    rms: float
    fx: float
    """In percent of the true value; the other errors are in pixels."""
    cx: float
    cy: float
    projection_mean: float
    projection_max: float
    named: bool
    """True if exactly the bad views were left out."""
    inside: tuple[bool, ...]
    """For each parameter, whether the true value is in the stated 95 % interval."""
    nees: float | None


Contestant = Callable[[Sequence[BoardView]], Outcome]


def measure(runs: int, interval_runs: int, say: Callable[[str], None]) -> SectionResult:
    """Measure `runs` calibrations of `VIEWS` views, and `interval_runs` smaller ones for the intervals."""
    misses = list(measure_runs(SIZE, runs, say))
    small = list(measure_runs(SMALL, interval_runs, say, corrupt=False))
    accuracy = Table(
        f"Calibration, {VIEWS} views of {SIZE[0]}x{SIZE[1]}, {runs} runs",
        COLUMNS,
        [
            Group("all views good", [*_rows(misses, 0), (*GOAL[:-1], "")]),
            Group("one view taken while the camera shook", [*_rows(misses, 1), GOAL]),
        ],
        ["Projection: distance between the pixels of equal rays over the image, after the best rotation."],
    )
    low, high = nees_band(interval_runs, len(small[0].inside))
    intervals = Table(
        f"Intervals, {VIEWS} views of {SMALL[0]}x{SMALL[1]}, {interval_runs} runs",
        ("truth in the stated 95 % interval, %", "fx", "fy", "cx", "cy", "k1 k2 p1 p2 k3", "NEES", "its 95 %\nband"),
        [Group("", [*_interval_rows(small, f"{low:.1f} - {high:.1f}"), ("goal", *["90"] * 5, "", "")])],
        [
            "NEES: squared error of all parameters in units of their covariance: 9 on average if that is exact, less "
            "if it is cautious."
        ],
    )
    data = {"calibrations": [asdict(one) for one in misses], "intervals": [asdict(one) for one in small]}
    return SectionResult([accuracy, intervals], (), data)


def measure_runs(
    size: tuple[int, int], runs: int, say: Callable[[str], None] = lambda _: None, *, corrupt: bool = True
) -> Iterator[Miss]:
    """Yield the errors of all contestants in each run; with `corrupt`, once more with one bad view."""
    contestants: dict[str, Contestant] = {OURS: ours, PLAIN: plain}
    camera = lens(*size)
    for run in range(runs):
        views = list(board_views(size, SEED + run, VIEWS))
        shaken = [corrupted(view) if index == BAD else view for index, view in enumerate(views)]
        for bad, chosen in enumerate([views, shaken] if corrupt else [views]):
            for name, contestant in contestants.items():
                yield _miss(name, run, bad, contestant(chosen), camera, shaken[BAD].name if bad else "")
        say(f"calibration {size[0]}x{size[1]}: {run + 1} of {runs} runs")


def ours(views: Sequence[BoardView]) -> Outcome:
    """Calibrate with roverlink."""
    detector = BoardDetector(BOARD)
    found = calibrate([detector.find(view.frame, view.name) for view in views], BOARD)
    dropped = tuple(one.view.name for one in found.views if one.dropped)
    return Outcome(found.camera, found.deviations, found.covariance, found.rms, dropped)


def plain(views: Sequence[BoardView]) -> Outcome:
    """Calibrate with OpenCV as usual."""
    detector = cv2.aruco.CharucoDetector(BOARD.opencv)
    objects, images = [], []
    for view in views:
        corners, ids = detector.detectBoard(view.frame)[:2]
        if ids is not None and len(ids) >= 6:
            objects.append(BOARD.points[np.ravel(ids)].astype(np.float32))
            images.append(np.reshape(corners, (-1, 2)).astype(np.float32))
    size = size_of(views[0].frame)
    rms, matrix, distortion, _, _, deviations, _, _ = cv2.calibrateCameraExtended(objects, images, size, None, None)
    camera = CameraParameters(matrix, distortion, size)
    return Outcome(camera, np.ravel(deviations)[: 4 + camera.distortion.size], None, float(rms), ())


def _miss(name: str, run: int, bad: int, outcome: Outcome, truth: Lens, bad_name: str) -> Miss:
    (fx, _, cx), (_, fy, cy), _ = truth.matrix.tolist()
    camera = outcome.camera
    found = np.concatenate([camera.focal, camera.centre, camera.distortion])
    error = found - (fx, fy, cx, cy, *truth.distortion)
    distances = projection_differences(camera, truth)
    covariance = outcome.covariance
    return Miss(
        contestant=name,
        run=run,
        bad_views=bad,
        rms=outcome.rms,
        fx=float(100 * error[0] / fx),
        cx=float(error[2]),
        cy=float(error[3]),
        projection_mean=float(distances.mean()),
        projection_max=float(np.max(distances)),
        named=outcome.dropped == ((bad_name,) if bad else ()),
        inside=tuple((np.abs(error) <= _QUANTILE * outcome.deviations).tolist()),
        nees=None if covariance is None else float(error @ np.linalg.solve(covariance, error)),
    )


def projection_differences(camera: CameraParameters, truth: Lens) -> Floats:
    """Return the distances (N,) in pixels of equal rays over the whole image, after removing the best rotation."""
    width, height = truth.size
    pixels = np.stack(np.meshgrid(np.linspace(0, width - 1, 32), np.linspace(0, height - 1, 18)), axis=-1)
    rays, seen = (_directions(one.reshape(-1, 2)) for one in (truth.rays(pixels), camera.undistort(pixels)))
    left, _, right = np.linalg.svd(seen.T @ rays)  # best rotation between two sets of directions (Kabsch, 1976)
    turn = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    turned = rays @ turn.T
    distances: Floats = np.linalg.norm(camera.distort(turned[:, :2] / turned[:, 2:]) - pixels.reshape(-1, 2), axis=1)
    return distances


def _directions(rays: Floats) -> Floats:
    lifted = np.column_stack([rays, np.ones(len(rays))])
    directions: Floats = lifted / np.linalg.norm(lifted, axis=1)[:, None]
    return directions


def _rows(misses: Sequence[Miss], bad: int) -> list[tuple[str, ...]]:
    rows = []
    for name in (OURS, PLAIN):
        chosen = [one for one in misses if one.contestant == name and one.bad_views == bad]
        each = ((one.rms, one.fx, one.cx, one.cy, one.projection_mean, one.projection_max) for one in chosen)
        figures = [max(map(abs, values)) for values in zip(*each)]
        named = f"{100 * np.mean([one.named for one in chosen]):.0f}" if bad else ""
        rows.append((name, *(f"{figure:.3f}" for figure in figures), named))
    return rows


def _interval_rows(misses: Sequence[Miss], band: str) -> list[tuple[str, ...]]:
    rows = []
    for name in (OURS, PLAIN):
        chosen = [one for one in misses if one.contestant == name]
        inside = 100 * np.mean([one.inside for one in chosen], axis=0)
        cells = [f"{part:.0f}" for part in (*inside[:4], inside[4:].mean())]
        nees = [one.nees for one in chosen if one.nees is not None]
        rows.append((name, *cells, f"{np.mean(nees):.1f}" if nees else "", band if nees else ""))
    return rows
