"""What the bench measures, with few poses and wide margins: whether it still holds at all."""

from __future__ import annotations

import numpy as np
import pytest

from bench.vision import nothing
from bench.vision.accuracy import OURS, Accuracy, measure_size, nees_band
from bench.vision.contestants import camera_of
from bench.vision.scenes import lens
from roverlink.vision import MarkerSet, Tracker
from roverlink.vision.images.rendering import render, texture

GOALS = {24: (95, 0.3, 1.5, 0.7, np.inf), 48: (99, 0.08, 0.25, 0.12, 0.6), 96: (99, 0.04, 0.10, 0.06, 0.25)}
"""By side in pixels: detected %, translation median and p95 in %, rotation median and p95 in degrees."""


def ours(side_px: int, poses: int) -> Accuracy:
    return next(one for one in measure_size(side_px, poses, names=[OURS]) if one.contestant == OURS)


def check(found: Accuracy, least_detected: float) -> None:
    _, translation, translation_p95, rotation, rotation_p95 = GOALS[found.side_px]
    assert found.detected >= least_detected
    assert found.false_ids == 0
    assert found.flips <= (0 if found.side_px >= 48 else 3)  # %; below, one frame cannot always decide
    assert found.translation_median < translation
    assert found.translation_p95 < translation_p95
    assert found.rotation_median < rotation
    assert found.rotation_p95 < rotation_p95


def test_poses_are_as_accurate_as_promised() -> None:
    """A dozen poses at 48 px; one may be missed."""
    check(ours(48, 12), 100 * 11 / 12 - 0.01)


@pytest.mark.slow
@pytest.mark.parametrize("side_px", [24, 48, 96])
def test_poses_are_as_accurate_as_promised_over_many(side_px: int) -> None:
    """Two hundred poses reach the goals, and the NEES its band (widened to 99.9 %)."""
    found = ours(side_px, 200)
    check(found, GOALS[side_px][0])
    low, high = nees_band(200)
    assert 6 - 1.7 * (6 - low) < found.nees < 6 + 1.7 * (high - 6)


def test_nothing_is_seen_where_nothing_is() -> None:
    """Textures, boxes and chequers are no markers."""
    camera = lens()
    tracker = Tracker(camera_of(camera), MarkerSet(), scan_every=1)
    for seed in range(15):
        rng = np.random.default_rng([1, seed])
        assert tracker.track(render(camera, texture(camera.size, rng), [], rng), seed) == ()


@pytest.mark.slow
def test_nothing_is_seen_in_500_frames() -> None:
    """The same, as often as promised."""
    assert nothing.measure(500, lambda _: None).data["false_ids"][OURS] == 0
