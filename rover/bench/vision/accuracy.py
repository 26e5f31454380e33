"""Accuracy of poses from single frames by marker size, and consistency of their covariance."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import cv2
import numpy as np
from roverkit.vision.images.rendering import Floats, Pose

from bench.result import Chart, Curve, Group, SectionResult, Table
from rover.bench.vision.contestants import OURS, Estimate, estimators
from rover.bench.vision.scenes import lens, scenes

SIZES = (24, 32, 48, 96, 160)
SEED = 7
FLIPPED = np.radians(3)
"""Smallest rotation error of a flipped pose, in radians; it must also be nearer to the mirror image of the truth."""
GOALS = {
    24: ("95", "0.3", "1.5", "0.7", "", ""),
    32: ("", "", "", "", "", "3"),
    48: ("99", "0.08", "0.25", "0.12", "0.6", "0"),
    96: ("99", "0.04", "0.10", "0.06", "0.25", "0"),
    160: ("", "", "", "", "", "0"),
}
COLUMNS = (
    "marker side, px",
    "detected\n%",
    "translation\nmedian %",
    "translation\np95 %",
    "rotation\nmedian deg",
    "rotation\np95 deg",
    "flips\n%",
    "NEES",
    "its 95 %\nband",
)


@dataclass(frozen=True, slots=True)
class Miss:
    """Error of an estimate: translation as a fraction of the distance, rotation in radians."""

    translation: float
    rotation: float
    flipped: bool
    nees: float | None
    """Normalized estimation error squared (NEES): 6 on average if the covariance is correct."""


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Accuracy of one contestant at one size: errors in % and degrees over all detections, flips included."""

    contestant: str
    side_px: int
    poses: int
    detected: float
    false_ids: int
    translation_median: float
    translation_p95: float
    rotation_median: float
    rotation_p95: float
    flips: float
    nees: float | None
    nees_band: tuple[float, float] | None

    @property
    def cells(self) -> tuple[str, ...]:
        """Values as table cells."""
        band = "" if self.nees_band is None else "{:.2f} - {:.2f}".format(*self.nees_band)
        return (
            f"{self.detected:.1f}",
            f"{self.translation_median:.3f}",
            f"{self.translation_p95:.3f}",
            f"{self.rotation_median:.3f}",
            f"{self.rotation_p95:.3f}",
            f"{self.flips:.1f}",
            "" if self.nees is None else f"{self.nees:.2f}",
            band,
        )


def measure(poses: int, sizes: Sequence[int], say: Callable[[str], None]) -> SectionResult:
    """Measure all contestants on the same frames."""
    results = [accuracy for size in sizes for accuracy in measure_size(size, poses, say)]
    groups = [Group(f"{size} px", _rows([one for one in results if one.side_px == size])) for size in sizes]
    notes = [
        f"{poses} poses per size, each in its own frame: tilted by 0 to 60 degrees, anywhere in the frame. The side is "
        "that of a marker facing the camera.",
        "Flips: nearer to the mirror image of the true pose than to it, and at least 3 degrees off.",
        "NEES: squared error in units of the covariance, 6 on average if the covariance is correct; without flips.",
    ]
    table = Table("Poses of single frames", COLUMNS, groups, notes)
    return SectionResult([table], _charts(results), {"accuracy": [asdict(result) for result in results]})


def measure_size(
    side_px: int, poses: int, say: Callable[[str], None] = lambda _: None, names: Sequence[str] = ()
) -> list[Accuracy]:
    """Measure one size; `say` reports progress; `names` selects contestants, and empty means all."""
    contestants = {name: one for name, one in estimators(lens()).items() if not names or name in names}
    misses: dict[str, list[Miss]] = defaultdict(list)
    false_ids: dict[str, int] = defaultdict(int)
    for index, scene in enumerate(scenes(side_px, poses, SEED), 1):
        for name, estimate in contestants.items():
            found = estimate(scene.frame)
            misses[name] += [miss_of(result, scene.pose) for result in found if result.number == scene.number][:1]
            false_ids[name] += sum(one.number != scene.number for one in found)
        if index % 50 == 0 or index == poses:
            say(f"accuracy {side_px} px: {index} of {poses} poses")
    return [_summary(name, side_px, poses, misses[name], false_ids[name]) for name in contestants]


def miss_of(estimate: Estimate, truth: Pose) -> Miss:
    """Compare an estimate with the truth."""
    shift = truth.translation - estimate.translation
    turn = cv2.Rodrigues(truth.rotation @ estimate.rotation.T)[0].ravel()
    nees = None
    if estimate.covariance is not None:
        error = np.concatenate([shift, turn])
        nees = float(error @ np.linalg.solve(estimate.covariance, error))
    normal, mirrored = truth.rotation[:, 2], _mirrored(truth)
    flipped = estimate.rotation[:, 2] @ mirrored > estimate.rotation[:, 2] @ normal and np.linalg.norm(turn) > FLIPPED
    return Miss(
        float(np.linalg.norm(shift) / np.linalg.norm(truth.translation)),
        float(np.linalg.norm(turn)),
        bool(flipped),
        nees,
    )


def _mirrored(truth: Pose) -> Floats:
    """Return the normal of the pose that looks nearly the same: mirrored at the line of sight."""
    sight = truth.translation / np.linalg.norm(truth.translation)
    normal: Floats = truth.rotation[:, 2]
    mirrored: Floats = 2 * (normal @ sight) * sight - normal
    return mirrored


def _summary(name: str, side_px: int, poses: int, misses: Sequence[Miss], false_ids: int) -> Accuracy:
    translations = [100 * miss.translation for miss in misses] or [np.nan]
    rotations = [float(np.degrees(miss.rotation)) for miss in misses] or [np.nan]
    nees = [miss.nees for miss in misses if miss.nees is not None and not miss.flipped]
    return Accuracy(
        contestant=name,
        side_px=side_px,
        poses=poses,
        detected=100 * len(misses) / poses,
        false_ids=false_ids,
        translation_median=float(np.median(translations)),
        translation_p95=float(np.percentile(translations, 95)),
        rotation_median=float(np.median(rotations)),
        rotation_p95=float(np.percentile(rotations, 95)),
        flips=100 * sum(miss.flipped for miss in misses) / max(len(misses), 1),
        nees=float(np.mean(nees)) if nees else None,
        nees_band=nees_band(len(nees)) if nees else None,
    )


def nees_band(count: int, freedom: int = 6) -> tuple[float, float]:
    """Return the band of 95 % of the means of `count` correct NEES (chi squared, Wilson and Hilferty)."""
    total = count * freedom
    part = 2 / (9 * total)
    low, high = (total * (1 - part + sign * 1.96 * part**0.5) ** 3 / count for sign in (-1, 1))
    return low, high


def _rows(results: Sequence[Accuracy]) -> list[Sequence[str]]:
    rows: list[Sequence[str]] = [(result.contestant, *result.cells) for result in results]
    goal = GOALS.get(results[0].side_px)
    return [*rows, ("goal", *goal, "in band" if results[0].side_px in GOALS else "", "")] if goal else rows


def _charts(results: Sequence[Accuracy]) -> list[Chart]:
    figures: Mapping[str, str] = {
        "translation_median": "translation error, median, %",
        "translation_p95": "translation error, p95, %",
        "rotation_median": "rotation error, median, degrees",
        "rotation_p95": "rotation error, p95, degrees",
    }
    names = list(dict.fromkeys(result.contestant for result in results))
    charts = []
    for figure, label in figures.items():
        curves = [_curve(name, figure, [one for one in results if one.contestant == name]) for name in names]
        charts.append(Chart(label, "marker side, px", label.rpartition(", ")[2], curves))
    return charts


def _curve(name: str, figure: str, results: Sequence[Accuracy]) -> Curve:
    values: list[Any] = [getattr(result, figure) for result in results]
    return Curve(name, [one.side_px for one in results], values)


__all__ = ["OURS", "SIZES", "Accuracy", "Miss", "measure", "measure_size", "miss_of", "nees_band"]
