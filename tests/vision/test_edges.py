"""The edge fit: how exact corners are, from how far it finds them, and what it says about itself."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest

from bench.vision.contestants import camera_of
from bench.vision.scenes import DICTIONARY, SIDE, Scene, corner_points, lens, project, random_pose, scenes
from roverlink.vision.images.rendering import Floats, marker_print, render, texels_for
from roverlink.vision.markers.edges import Fit, Guess, fit_edges
from roverlink.vision.markers.marker_set import MarkerSet

LENS = lens()
CAMERA, MARKERS = camera_of(LENS), MarkerSet()


@pytest.fixture(scope="module")
def film() -> Sequence[Scene]:
    """Frames with markers of 48 pixels."""
    return list(scenes(48, 12, 100))


def fit(scene: Scene, off: Floats | float = 0.3) -> Fit | None:
    """Fit from corners that are off by some pixels."""
    return fit_edges(scene.frame, CAMERA, [Guess(MARKERS.pattern(scene.number), scene.corners + off)])[0]


def miss(found: Fit, scene: Scene) -> float:
    """The root mean squared error of the corners in pixels."""
    return float(np.sqrt(((CAMERA.distort(found.rays) - scene.corners) ** 2).mean()))


def test_corners_are_exact_to_hundredths_of_a_pixel(film: Sequence[Scene]) -> None:
    """At 48 pixels, noise of 2 grey levels allows 0.01 pixels."""
    errors = [miss(found, scene) for scene in film if (found := fit(scene))]
    assert len(errors) == len(film)
    assert np.median(errors) < 0.015
    assert max(errors) < 0.03


def test_the_corners_covariance_is_honest(film: Sequence[Scene]) -> None:
    """The squared error in its units is 8 on average."""
    nees = []
    for scene in film:
        found = fit(scene)
        assert found
        error = (LENS.rays(scene.corners) - found.rays).ravel()
        nees.append(error @ np.linalg.solve(found.covariance, error))
    assert 4 < np.mean(nees) < 12.5


@pytest.mark.parametrize("off", [1.0, 2.0])
def test_a_detector_s_error_does_not_matter(film: Sequence[Scene], off: float) -> None:
    """From corners that are off by one or two pixels, each in a direction of its own, the fit arrives."""
    rng = np.random.default_rng(0)
    for scene in film:
        angles = rng.uniform(0, 2 * np.pi, 4)
        found = fit(scene, off * np.column_stack([np.cos(angles), np.sin(angles)]))
        assert found
        assert miss(found, scene) < 0.05


def test_it_measures_noise_contrast_and_blur(film: Sequence[Scene]) -> None:
    """What the covariance is made of is found: 2 grey levels, a contrast of 200, 0.8 pixels and a pixel's area."""
    found = [one for one in map(fit, film) if one]
    assert np.median([one.noise for one in found]) == pytest.approx(2.02, rel=0.1)
    assert np.median([one.contrast for one in found]) == pytest.approx(200, rel=0.05)
    assert np.median([one.blur for one in found]) == pytest.approx((0.8**2 + 1 / 12) ** 0.5, rel=0.03)
    assert min(one.explained for one in found) > 0.98


def test_a_covered_corner_is_left_out(film: Sequence[Scene]) -> None:
    """A finger on a corner is an outlier; the other edges still say where the corner is."""
    errors = []
    for scene in film:
        frame = scene.frame.copy()
        cv2.circle(frame, tuple(int(x) for x in np.rint(scene.corners[0])), 6, 90, -1)
        found = fit(Scene(frame, scene.number, scene.pose, scene.corners))
        assert found
        errors.append(miss(found, scene))
    assert np.median(errors) < 0.1


@pytest.mark.parametrize("sigma", [0.5, 1.6])
def test_the_lens_may_be_sharper_or_blurred(sigma: float) -> None:
    """The blur is fitted, too."""
    rng = np.random.default_rng(1)
    pose = random_pose(LENS, 60, rng)
    plane = marker_print(DICTIONARY, 17, SIDE, texels=texels_for(60))
    frame = render(LENS, np.full((480, 640), 120.0), [(plane, pose)], rng, psf_sigma=sigma)
    scene = Scene(frame, 17, pose, project(LENS, pose, corner_points()))
    found = fit(scene)
    assert found
    assert miss(found, scene) < 0.05
    assert found.blur == pytest.approx((sigma**2 + 1 / 12) ** 0.5, rel=0.1)


def test_light_may_fall_off_across_the_marker(film: Sequence[Scene]) -> None:
    """Brightness that changes linearly is part of the model."""
    shade = np.linspace(1, 0.5, 640)
    for scene in film[:4]:
        found = fit(Scene(np.rint(scene.frame * shade).astype(np.uint8), scene.number, scene.pose, scene.corners))
        assert found
        assert miss(found, scene) < 0.04


def test_another_marker_s_pattern_is_not_explained(film: Sequence[Scene]) -> None:
    """What the detector might misread is seen here: the wrong pattern leaves much unexplained."""
    for scene in film:
        found = fit_edges(scene.frame, CAMERA, [Guess(MARKERS.pattern((scene.number + 1) % 250), scene.corners)])[0]
        assert found is None or found.explained < 0.9


def test_nothing_to_fit_gives_nothing(film: Sequence[Scene]) -> None:
    """A guess outside the image, on a plain wall, or where no ray goes is None or explains nothing; others stand."""
    wall = np.full((480, 640), 128, np.uint8)
    good = Guess(MARKERS.pattern(film[0].number), film[0].corners)
    far = Guess(good.pattern, film[0].corners + 5000)
    assert fit_edges(film[0].frame, CAMERA, []) == []
    found, lost = fit_edges(film[0].frame, CAMERA, [good, far])
    assert found
    assert lost is None
    plain = fit_edges(wall, CAMERA, [good])[0]
    assert plain is None or abs(plain.contrast) < 8
