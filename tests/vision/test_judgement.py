"""Judgement of calibrations, without images: what is wrong is named, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from roverlink.vision import CameraParameters
from roverlink.vision.calibration import Calibration, Model, Verdict, View, calibrate
from roverlink.vision.calibration.board_bend import height
from roverlink.vision.calibration.verdict import BetterModel, Evidence, judge
from tests.vision.boards import BOARD, CAMERA, SIZE, part, project, views

WIDE = CameraParameters(
    np.array([[535.0, 0, 644], [0, 536.8, 357], [0, 0, 1]]),
    np.array([0.02, -0.008, 0.003, -0.0008]),
    SIZE,
    fisheye=True,
)
"""Fisheye lens of 137 degrees."""
FINE = Evidence("plumb_bob", rms=0.05, noise=0.04, uncertainty=0.1)


def bent(seed: int, bend: float) -> list[View]:
    """Views of a board that is a part of a cylinder, `bend` metres high."""
    rng = np.random.default_rng(seed)
    points = BOARD.points + np.zeros(3)
    points[:, 2] += bend * (2 * points[:, 0] / BOARD.size[0] - 1) ** 2
    found = []
    for one in views(CAMERA, 20, seed):
        flat = BOARD.points[one.ids]
        _, turn, shift = cv2.solvePnP(flat, one.corners, CAMERA.matrix, CAMERA.distortion)
        pixels = project(CAMERA, points[one.ids], turn, shift) + rng.normal(0, 0.03, one.corners.shape)
        found.append(replace(one, corners=pixels))
    return found


def moving(seed: int, size: float) -> list[View]:
    """Views of a camera with a rolling shutter, in which the board moves by about `size` pixels during readout."""
    rng = np.random.default_rng(seed)
    return [
        replace(one, corners=one.corners + np.outer(one.corners[:, 1] / SIZE[1] - 0.5, rng.normal(0, size, 2)))
        for one in views(CAMERA, 20, seed)
    ]


def doubts(calibration: Calibration) -> str:
    return "\n".join(f"{one.verdict.value}: {one.text}" for one in calibration.judgement.doubts)


def test_good_views_give_a_good_calibration() -> None:
    """There is nothing to complain about."""
    found = calibrate(views(CAMERA, 20, 3), BOARD)
    assert doubts(found) == ""
    assert found.judgement.verdict is Verdict.GOOD


@pytest.mark.parametrize("bend", [0.002, pytest.param(0.001, marks=pytest.mark.slow)])
def test_a_bent_board_is_named_and_does_not_change_the_camera(bend: float) -> None:
    """Its height is measured, and fx is right nevertheless; before, it was wrong by more than a percent."""
    found = calibrate(bent(4, bend), BOARD)
    assert height(BOARD, found.bend) == pytest.approx(bend, rel=0.05)
    assert f"usable: the board is bent by {1000 * bend:.1f} mm" in doubts(found)
    assert found.camera.focal == pytest.approx(CAMERA.focal, rel=1e-3)


def test_a_lens_model_that_is_too_simple_is_named_with_a_better_one() -> None:
    """A fisheye lens of 137 degrees does not follow plumb_bob."""
    found = calibrate(views(WIDE, 20, 2), BOARD)
    assert found.judgement.verdict is Verdict.UNUSABLE
    assert "calibrate again with --model equidistant" in doubts(found)
    assert calibrate(views(WIDE, 20, 2), BOARD, Model.EQUIDISTANT).judgement.verdict is Verdict.GOOD


@pytest.mark.parametrize(("size", "verdict"), [(1.0, Verdict.USABLE), (5.0, Verdict.UNUSABLE)])
def test_a_rolling_shutter_is_named(size: float, verdict: Verdict) -> None:
    """The lens and the board are not to blame."""
    found = calibrate(moving(2, size), BOARD)
    assert found.judgement.verdict is verdict
    assert "rolling shutter" in doubts(found)
    assert "bent" not in doubts(found)
    assert "--model" not in doubts(found)


def test_parts_of_the_image_without_corners_are_named() -> None:
    """The lens is unknown there."""
    found = calibrate([part(one, one.corners[:, 0] < 1000) for one in views(CAMERA, 30, 2)], BOARD)
    assert found.judgement.verdict is Verdict.USABLE
    assert "4 of 24 parts of the image have no corners" in doubts(found)


@pytest.mark.parametrize(
    ("evidence", "verdict", "words"),
    [
        (FINE, Verdict.GOOD, ""),
        (replace(FINE, bend=0.001, width=0.264), Verdict.USABLE, "bent by 1.0 mm"),
        (replace(FINE, bend=0.006, width=0.264), Verdict.UNUSABLE, "bent by 6.0 mm"),
        (replace(FINE, motion=1.0, motion_explains=0.1), Verdict.GOOD, ""),
        (replace(FINE, uncertainty=0.7), Verdict.USABLE, "known to 0.7 px only"),
        (replace(FINE, uncertainty=3), Verdict.UNUSABLE, "known to 3.0 px only"),
        (replace(FINE, rms=0.5), Verdict.USABLE, "may be uneven"),
        (replace(FINE, dropped=0.4), Verdict.USABLE, "40 % of the views do not fit"),
        (replace(FINE, rejected=0.5), Verdict.USABLE, "50 % of the corners do not fit"),
        (replace(FINE, empty=("left", "left"), rms=9), Verdict.USABLE, "2 of 24 parts"),
        (replace(FINE, better=BetterModel("equidistant", 0.04, 0.1, 0.2), rms=0.5), Verdict.USABLE, "--model equid"),
    ],
)
def test_each_doubt_has_its_own_words(evidence: Evidence, verdict: Verdict, words: str) -> None:
    """The worst doubt decides."""
    judgement = judge(evidence)
    assert judgement.verdict is verdict
    assert words in "\n".join(one.text for one in judgement.doubts)
    assert bool(words) == bool(judgement.doubts)
