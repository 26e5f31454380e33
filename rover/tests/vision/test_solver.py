"""From views to a camera and its judgement, without images: corners are OpenCV's projections, and noise."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from roverkit.calibration import Calibration, Model, PoorViewsError, Verdict, View, calibrate
from roverkit.calibration.adjustment import moved_camera
from roverkit.calibration.board_shape import STRETCH, height
from roverkit.calibration.verdict import BetterModel, Evidence, judge
from roverkit.vision import CameraParameters
from roverkit.vision.camera.parameter_derivatives import by_parameters

from rover.tests.vision.boards import BOARD, CAMERA, FISHEYE, NOISE, RATIONAL, SIZE, part, project, views

MODELS = {Model.PLUMB_BOB: CAMERA, Model.RATIONAL: RATIONAL, Model.EQUIDISTANT: FISHEYE}


@pytest.mark.slow
@pytest.mark.parametrize("model", [Model.PLUMB_BOB, Model.EQUIDISTANT])
def test_the_camera_that_saw_the_views_is_found(model: Model) -> None:
    """The error is some standard deviations of the noise, everywhere in the image, and as large as stated."""
    truth = MODELS[model]
    found = calibrate(views(truth, 20, 3), BOARD, model)
    assert found.rms == pytest.approx(NOISE * 2**0.5, rel=0.1)
    assert found.camera.matrix == pytest.approx(truth.matrix, rel=1e-3)
    miss = np.abs(found.camera.matrix - truth.matrix)[[0, 1, 0, 1], [0, 1, 2, 2]]
    assert (miss < 4 * found.deviations[:4]).all()


@pytest.mark.parametrize("camera", MODELS.values(), ids=MODELS)
def test_the_derivatives_are_those_of_the_projection(camera: CameraParameters) -> None:
    """A small change of each parameter moves pixels as the derivative says."""
    rays = np.random.default_rng(0).uniform(-0.5, 0.5, (20, 2))
    derivative = by_parameters(camera, rays)
    for place, step in enumerate(np.eye(derivative.shape[2]) * 1e-6):
        difference = moved_camera(camera, step).distort(rays) - moved_camera(camera, -step).distort(rays)
        assert derivative[:, :, place] == pytest.approx(difference / 2e-6, rel=1e-4, abs=1e-4)


@pytest.mark.slow
def test_what_does_not_fit_is_left_out() -> None:
    """A view whose corners shake by two pixels is dropped and named; corners that are others do not count."""
    good = views(CAMERA, 20, 4)
    bad = good[7].corners + np.random.default_rng(1).normal(0, 2, good[7].corners.shape)
    for one in good[:5]:
        one.corners[3:6] += 1.5
    found = calibrate([*good[:7], replace(good[7], corners=bad), *good[8:]], BOARD)
    assert [one.view.name for one in found.views if one.dropped] == ["view 7"]
    assert "blurred" in found.views[7].dropped
    assert found.camera.matrix == pytest.approx(CAMERA.matrix, rel=1e-3)
    assert all(not one.used[3:6].any() for one in found.views[:5])
    assert sum(one.rejected for one in found.views if not one.dropped) < 5 * 3 + 10


@pytest.mark.slow
def test_views_that_tell_too_little_are_refused() -> None:
    """Too few, all of them frontal, or of a part of the image: the error says what is missing."""
    few = views(CAMERA, 12, 6)
    few[2:5] = [part(one, one.ids < 5) for one in few[2:5]]
    left = [part(one, one.corners[:, 0] < 560) for one in views(CAMERA, 40, 8)]
    for poor, words in (
        (few, "9 of 12 views are usable, but 10 are needed"),
        (views(CAMERA, 12, 7, tilt=0.05), "tilted in 0 views"),
        (left, r"no corners in \d+ of 24 parts of the image: .*right"),
    ):
        with pytest.raises(PoorViewsError, match=words):
            calibrate(poor, BOARD)


_MATRIX = np.array([[535.0, 0, 644], [0, 536.8, 357], [0, 0, 1]])
WIDE = CameraParameters(_MATRIX, np.array([0.02, -0.008, 0.003, -0.0008]), SIZE, fisheye=True)
"""Fisheye lens of 137 degrees."""
FINE = Evidence("plumb_bob", rms=0.05, noise=0.04, uncertainty=0.1)


def misprinted(seed: int, count: int, points: np.ndarray) -> list[View]:
    """Views of a board whose corners are at other points."""
    rng = np.random.default_rng(seed)
    found = []
    for one in views(CAMERA, count, seed):
        _, turn, shift = cv2.solvePnP(BOARD.points[one.ids], one.corners, CAMERA.matrix, CAMERA.distortion)
        pixels = project(CAMERA, points[one.ids], turn, shift)
        found.append(replace(one, corners=pixels + rng.normal(0, 0.03, one.corners.shape)))
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


@pytest.mark.opencv
@pytest.mark.slow
def test_good_views_give_a_good_calibration() -> None:
    """There is nothing to complain about. Parts of the image without corners are named: the lens is unknown there."""
    found = calibrate(views(CAMERA, 20, 3), BOARD)
    assert (found.judgement.verdict, doubts(found)) == (Verdict.GOOD, "")
    found = calibrate([part(one, one.corners[:, 0] < 1000) for one in views(CAMERA, 30, 2)], BOARD)
    assert found.judgement.verdict is Verdict.USABLE
    assert "no corners in 4 of 24 parts of the image" in doubts(found)


@pytest.mark.slow
def test_a_bent_board_is_named_and_does_not_change_the_camera() -> None:
    """Its height is measured, and fx is right nevertheless; before, it was wrong by more than a percent."""
    cylinder = np.outer((2 * BOARD.points[:, 0] / BOARD.size[0] - 1) ** 2, (0, 0, 0.002))
    found = calibrate(misprinted(4, 20, BOARD.points + cylinder), BOARD)
    assert height(BOARD, found.shape) == pytest.approx(0.002, rel=0.05)
    assert "usable: the board is bent by 2.0 mm" in doubts(found)
    assert found.camera.focal == pytest.approx(CAMERA.focal, rel=1e-3)


@pytest.mark.slow
def test_a_stretched_print_is_named_and_does_not_change_the_camera() -> None:
    """A print that is 0.2 % too wide was called a rolling shutter, and fx was wrong by 0.43 %."""
    found = calibrate(misprinted(5, 22, BOARD.points * (1.002, 1, 1)), BOARD)
    assert found.shape[STRETCH] == pytest.approx(-0.002, abs=0.0005)
    assert "usable: the squares of the print are 0.2 % wider than high" in doubts(found)
    assert "rolling" not in doubts(found)
    assert found.camera.focal == pytest.approx(CAMERA.focal, rel=1e-3)


@pytest.mark.slow
def test_a_lens_model_that_is_too_simple_is_named_with_a_better_one() -> None:
    """A fisheye lens of 137 degrees does not follow plumb_bob."""
    found = calibrate(views(WIDE, 20, 2), BOARD)
    assert found.judgement.verdict is Verdict.UNUSABLE
    assert "calibrate again with --model equidistant" in doubts(found)
    assert calibrate(views(WIDE, 20, 2), BOARD, Model.EQUIDISTANT).judgement.verdict is Verdict.GOOD


@pytest.mark.slow
def test_a_rolling_shutter_is_named() -> None:
    """The lens and the board are not to blame."""
    found = calibrate(moving(2, 1.0), BOARD)
    assert found.judgement.verdict is Verdict.USABLE
    assert "rolling shutter" in doubts(found)
    assert "bent" not in doubts(found)
    assert "--model" not in doubts(found)


@pytest.mark.parametrize(
    ("evidence", "verdict", "words"),
    [
        (FINE, Verdict.GOOD, ""),
        (replace(FINE, bend=0.001, width=0.264), Verdict.USABLE, "bent by 1.0 mm"),
        (replace(FINE, bend=0.006, width=0.264), Verdict.UNUSABLE, "bent by 6.0 mm"),
        (replace(FINE, stretch=0.05), Verdict.UNUSABLE, "5 % higher than wide"),
        (replace(FINE, motion=5.0, motion_explains=0.9, rms=0.5), Verdict.UNUSABLE, "picture moves by 5.0 px"),
        (replace(FINE, uncertainty=0.7), Verdict.USABLE, "known to 0.7 px only"),
        (replace(FINE, rms=0.5), Verdict.USABLE, "may be uneven"),
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
