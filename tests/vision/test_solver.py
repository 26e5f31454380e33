"""From views to a camera, without images: the corners are OpenCV's projections, and noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.vision.calibration import projection_differences
from roverlink.vision import CameraParameters
from roverlink.vision.calibration import Model, PoorViewsError, calibrate
from roverlink.vision.calibration.adjustment import moved_camera
from roverlink.vision.camera.parameter_derivatives import by_parameters
from roverlink.vision.images.rendering import Lens
from tests.vision.boards import BOARD, CAMERA, FISHEYE, NOISE, RATIONAL, SIZE, part, views

MODELS = {Model.PLUMB_BOB: CAMERA, Model.RATIONAL: RATIONAL, Model.EQUIDISTANT: FISHEYE}
LENS = Lens(CAMERA.matrix, tuple(CAMERA.distortion.tolist()), SIZE)


@pytest.mark.parametrize(
    "model", [Model.PLUMB_BOB, pytest.param(Model.RATIONAL, marks=pytest.mark.slow), Model.EQUIDISTANT]
)
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


def test_a_corrupted_view_is_dropped_and_named() -> None:
    """One whose corners shake by two pixels does not fit the others, and the camera is as without it."""
    good = views(CAMERA, 20, 4)
    bad = replace(good[7], corners=good[7].corners + np.random.default_rng(1).normal(0, 2, good[7].corners.shape))
    found = calibrate([*good[:7], bad, *good[8:]], BOARD)
    assert [one.view.name for one in found.views if one.dropped] == ["view 7"]
    assert "blurred" in found.views[7].dropped
    assert found.camera.matrix == pytest.approx(CAMERA.matrix, rel=1e-3)


def test_corners_that_do_not_fit_are_left_out() -> None:
    """Some corners that were taken for others count in no view."""
    good = views(CAMERA, 20, 5)
    for one in good[:5]:
        one.corners[3:6] += 1.5
    found = calibrate(good, BOARD)
    assert all(not one.used[3:6].any() for one in found.views[:5])
    assert sum(one.rejected for one in found.views) < 5 * 3 + 10


def test_too_few_views_are_refused() -> None:
    """With their number, and the number that is needed."""
    few = views(CAMERA, 12, 6)
    few[2:5] = [part(one, one.ids < 5) for one in few[2:5]]
    with pytest.raises(PoorViewsError, match="9 of 12 views are usable, but 10 are needed"):
        calibrate(few, BOARD)


def test_views_that_all_face_the_camera_are_refused() -> None:
    """The focal length is not to be had from them."""
    with pytest.raises(PoorViewsError, match="tilted in 0 views"):
        calibrate(views(CAMERA, 12, 7, tilt=0.05), BOARD)


def test_views_of_a_part_of_the_image_are_refused() -> None:
    """The part that nothing is known about is named."""
    left = [part(one, one.corners[:, 0] < 560) for one in views(CAMERA, 40, 8)]
    with pytest.raises(PoorViewsError, match=r"parts of the image have no corners: .*right"):
        calibrate(left, BOARD)


@pytest.mark.slow
@pytest.mark.parametrize("model", list(Model))
def test_the_stated_interval_holds_the_truth(model: Model) -> None:
    """Each parameter's 95 % interval in at least 90 % of forty calibrations."""
    truth, inside = MODELS[model], []
    expected = np.concatenate([truth.focal, truth.centre, truth.distortion])
    for seed in range(40):
        found = calibrate(views(truth, 20, 100 + seed), BOARD, model)
        values = np.concatenate([found.camera.focal, found.camera.centre, found.camera.distortion])
        inside.append(np.abs(values - expected) <= found.interval * found.deviations)
    assert np.mean(inside, axis=0).min() >= 0.9


@pytest.mark.slow
def test_views_that_disagree_widen_the_interval() -> None:
    """Where the corners of each view err together, they tell less than their number seems to say."""
    rng = np.random.default_rng(9)
    good = views(CAMERA, 20, 9)
    bent = []
    for one in good:
        across, down = (one.corners / one.size - 0.5).T
        bend = np.outer(across**2, rng.normal(0, 0.5, 2)) + np.outer(down**2, rng.normal(0, 0.5, 2))
        bent.append(replace(one, corners=one.corners + bend))
    wider = calibrate(bent, BOARD).deviations / calibrate(good, BOARD).deviations
    assert wider.min() > 1
    assert np.median(wider) > 1.5


@pytest.mark.slow
def test_the_uncertainty_is_what_the_camera_errs_by() -> None:
    """Over the image, in the root mean square of six calibrations; it is cautious, and no more than that."""
    pixels = np.stack(np.meshgrid(np.linspace(20, SIZE[0] - 20, 12), np.linspace(20, SIZE[1] - 20, 7)), axis=-1)
    stated, made = [], []
    for seed in range(6):
        found = calibrate(views(CAMERA, 12, 300 + seed), BOARD)
        stated.append(found.uncertainty(pixels) ** 2)
        made.append(projection_differences(found.camera, LENS).reshape(-1) ** 2)
    assert np.sqrt(np.mean(made)) < np.sqrt(np.mean(stated)) * 1.1
    assert np.sqrt(np.mean(stated)) < np.sqrt(np.mean(made)) * 1.8
