"""Section `consistency`: how far covariances can be trusted if images, prints and parameters are not ideal."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from roverkit.vision.camera.uncertainty import Uncertainty

from bench.result import Group, SectionResult, Table
from rover.bench.vision.accuracy import Miss, miss_of, nees_band
from rover.bench.vision.contestants import OURS, Ours, camera_of, estimators
from rover.bench.vision.degradations import CLEAN, DEGRADATIONS, READOUT_S, Degradation, degraded_scenes
from rover.bench.vision.scenes import lens

SIZES = (24, 48, 96)
SEED = 17
GOAL = 4.0
"""Largest factor by which a covariance may be too confident."""
BOUND = 12.59
"""NEES that a correct covariance exceeds in 5 % of all cases: chi squared with 6 degrees of freedom."""
IMAGE = "image alone"
"""Our poses with covariances that contain the noise of the image only."""
CONTESTANTS = (OURS, "OpenCV", "OpenCV APRILTAG")
SHOWN = (IMAGE, *CONTESTANTS)


@dataclass(frozen=True, slots=True)
class Consistency:
    """Errors of one contestant under one degradation, without flips; those of the covariance are NaN without one."""

    degradation: str
    side_px: int
    contestant: str
    count: int
    """Number of poses that were found and not flipped."""
    translation_median: float
    """Error of the translation in % of the distance."""
    rotation_median: float
    """Error of the rotation in degrees."""
    nees: float
    too_confident: float
    """Root of (mean NEES / 6): the factor by which the standard deviations are too small."""
    inside: float
    """Percentage of the poses inside the ellipsoid of 95 %."""


def measure(poses: int, sizes: Sequence[int], say: Callable[[str], None]) -> SectionResult:
    """Measure all degradations at all sizes."""
    results: list[Consistency] = []
    for degradation in DEGRADATIONS:
        say(f"consistency: {degradation.name}, {poses} poses of each size")
        for size in sizes:
            results += measure_degradation(degradation, size, poses)
    columns = (
        "",
        "found\n%",
        "too\nconfident",
        "inside\n95 %, %",
        "image alone:\nconfident",
        "inside\n95 %, %",
        "NEES",
        *(f"{name}\ntranslation %" for name in CONTESTANTS),
    )
    groups = [Group(f"{size} px", _rows([one for one in results if one.side_px == size], poses)) for size in sizes]
    low, high = nees_band(poses)
    notes = [
        "Too confident: root of (mean NEES / 6), the factor by which the standard deviations are too small; goal: at "
        f"most {GOAL:g}. Found: percentage of the poses that were found and not flipped; only they count.",
        f"The first two columns of this kind have the default options and the readout time of {READOUT_S:g} s. Image "
        "alone: the covariance contains only what the frame shows; side, corners and camera count as exact. Then the "
        f"NEES of clean frames must be in {low:.2f} to {high:.2f}.",
        "Translation: median of the error in % of the distance. OpenCV computes no covariance.",
    ]
    table = Table("Covariances of degraded images and prints", columns, groups, notes)
    return SectionResult([table], (), {"consistency": [asdict(result) for result in results]})


def measure_degradation(
    degradation: Degradation, side_px: int, poses: int, names: Sequence[str] = SHOWN
) -> list[Consistency]:
    """Measure the contestants `names` under one degradation at one size."""
    true = lens()
    matrix = true.matrix.copy()
    matrix[[0, 1], [0, 1]] *= degradation.focal
    given = replace(true, matrix=matrix)
    exact = estimators(given)
    ours = Ours(camera_of(given), Uncertainty(readout_time=READOUT_S))
    misses: dict[str, list[Miss]] = defaultdict(list)
    for scene in degraded_scenes(degradation, side_px, poses, SEED):
        for name in names:
            if name == OURS:
                seen = ours(scene.scene.frame, scene.earlier)
            else:
                seen = exact[OURS if name == IMAGE else name](scene.scene.frame)
            found = [other for other in seen if other.number == scene.scene.number][:1]
            misses[name] += [miss for miss in (miss_of(other, scene.scene.pose) for other in found) if not miss.flipped]
    return [_summary(degradation, side_px, name, misses[name]) for name in names]


def _summary(degradation: Degradation, side_px: int, name: str, misses: Sequence[Miss]) -> Consistency:
    nees = np.array([miss.nees for miss in misses if miss.nees is not None] or [np.nan])
    return Consistency(
        degradation=degradation.name,
        side_px=side_px,
        contestant=name,
        count=len(misses),
        translation_median=float(np.median([100 * miss.translation for miss in misses] or [np.nan])),
        rotation_median=float(np.median([np.degrees(miss.rotation) for miss in misses] or [np.nan])),
        nees=float(nees.mean()),
        too_confident=float(np.sqrt(nees.mean() / 6)),
        inside=float(100 * np.mean(nees < BOUND)),
    )


def _rows(results: Sequence[Consistency], poses: int) -> list[Sequence[str]]:
    by_row: dict[str, dict[str, Consistency]] = defaultdict(dict)
    for result in results:
        by_row[result.degradation][result.contestant] = result
    return [
        (
            name,
            f"{100 * row[OURS].count / poses:.0f}",
            f"{row[OURS].too_confident:.2f}",
            f"{row[OURS].inside:.0f}",
            f"{row[IMAGE].too_confident:.2f}",
            f"{row[IMAGE].inside:.0f}",
            f"{row[IMAGE].nees:.1f}",
            *(f"{row[contestant].translation_median:.3f}" for contestant in CONTESTANTS),
        )
        for name, row in by_row.items()
    ]


__all__ = ["CLEAN", "DEGRADATIONS", "IMAGE", "OURS", "Consistency", "measure", "measure_degradation"]
