"""Accuracy of calibrations compared with plain OpenCV, and correctness of their stated uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass

import cv2
import numpy as np
from roverkit.calibration import BoardDetector, calibrate
from roverkit.vision import CameraParameters
from roverkit.vision.frames.frame import size_of
from roverkit.vision.images.rendering import Floats, Lens

from bench.result import Group, SectionResult, Table
from rover.bench.vision.boards import BOARD, BoardView, board_views, corrupted
from rover.bench.vision.contestants import OURS
from rover.bench.vision.scenes import lens

SIZE = (1280, 720)
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


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of a contestant: camera, RMS, and views left out."""

    camera: CameraParameters
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


Contestant = Callable[[Sequence[BoardView]], Outcome]


def measure(runs: int, say: Callable[[str], None]) -> SectionResult:
    """Measure `runs` calibrations of `VIEWS` views."""
    misses = list(measure_runs(SIZE, runs, say))
    accuracy = Table(
        f"Calibration, {VIEWS} views of {SIZE[0]}x{SIZE[1]}, {runs} runs",
        COLUMNS,
        [
            Group("all views good", [*_rows(misses, 0), (*GOAL[:-1], "")]),
            Group("one view taken while the camera shook", [*_rows(misses, 1), GOAL]),
        ],
        ["Projection: distance between the pixels of equal rays over the image, after the best rotation."],
    )
    return SectionResult([accuracy], (), {"calibrations": [asdict(miss) for miss in misses]})


def measure_runs(size: tuple[int, int], runs: int, say: Callable[[str], None] = lambda _: None) -> Iterator[Miss]:
    """Yield the errors of all contestants in each run with good views, and once more with one bad view."""
    contestants: dict[str, Contestant] = {OURS: ours, PLAIN: plain}
    camera = lens(*size)
    for run in range(runs):
        views = list(board_views(camera, SEED + run, VIEWS))
        shaken = [corrupted(view) if index == BAD else view for index, view in enumerate(views)]
        for bad, chosen in enumerate([views, shaken]):
            for name, contestant in contestants.items():
                yield _miss(name, run, bad, contestant(chosen), camera, shaken[BAD].name if bad else "")
        say(f"calibration {size[0]}x{size[1]}: {run + 1} of {runs} runs")


def ours(views: Sequence[BoardView]) -> Outcome:
    """Calibrate with roverlink."""
    detector = BoardDetector(BOARD)
    found = calibrate([detector.find(view.frame, view.name) for view in views], BOARD)
    dropped = tuple(one.view.name for one in found.views if one.dropped)
    return Outcome(found.camera, found.rms, dropped)


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
    rms, matrix, distortion, *_ = cv2.calibrateCamera(objects, images, size, None, None)
    return Outcome(CameraParameters(matrix, distortion, size), float(rms), ())


def _miss(name: str, run: int, bad: int, outcome: Outcome, truth: Lens, bad_name: str) -> Miss:
    (fx, _, cx), (_, _, cy), _ = truth.matrix.tolist()
    camera = outcome.camera
    distances = projection_differences(camera, truth)
    return Miss(
        contestant=name,
        run=run,
        bad_views=bad,
        rms=outcome.rms,
        fx=float(100 * (camera.focal[0] / fx - 1)),
        cx=float(camera.centre[0] - cx),
        cy=float(camera.centre[1] - cy),
        projection_mean=float(distances.mean()),
        projection_max=float(np.max(distances)),
        named=outcome.dropped == ((bad_name,) if bad else ()),
    )


def projection_differences(camera: CameraParameters, truth: Lens, pixels: Floats | None = None) -> Floats:
    """Return the distances (N,) in pixels of equal rays, after removing the best rotation.

    Compares the rays at `pixels` (N, 2), or over the whole image. Pixels for which the camera's model has no ray are
    left out.
    """
    if pixels is None:
        width, height = truth.size
        grid = np.stack(np.meshgrid(np.linspace(0, width - 1, 32), np.linspace(0, height - 1, 18)), axis=-1)
        pixels = grid.reshape(-1, 2)
    known = np.isfinite(camera.undistort(pixels)).all(axis=1)
    pixels = pixels[known]
    rays, seen = _directions(truth.rays(pixels)), _directions(camera.undistort(pixels))
    left, _, right = np.linalg.svd(seen.T @ rays)  # best rotation between two sets of directions (Kabsch, 1976)
    turn = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    turned = rays @ turn.T
    distances: Floats = np.linalg.norm(camera.distort(turned[:, :2] / turned[:, 2:]) - pixels, axis=1)
    return distances


def _directions(rays: Floats) -> Floats:
    lifted = np.column_stack([rays, np.ones(len(rays))])
    directions: Floats = lifted / np.linalg.norm(lifted, axis=1)[:, None]
    return directions


def _rows(misses: Sequence[Miss], bad: int) -> list[tuple[str, ...]]:
    rows = []
    for name in (OURS, PLAIN):
        chosen = [miss for miss in misses if miss.contestant == name and miss.bad_views == bad]
        each = ((run.rms, run.fx, run.cx, run.cy, run.projection_mean, run.projection_max) for run in chosen)
        figures = [max(map(abs, values)) for values in zip(*each)]
        named = f"{100 * np.mean([one.named for one in chosen]):.0f}" if bad else ""
        rows.append((name, *(f"{figure:.3f}" for figure in figures), named))
    return rows
