"""The truth that the other tests measure by."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from bench.vision.scenes import lens, random_pose
from roverlink.vision.images.rendering import Pose, Print, project, render

CAMERA = lens()


def test_projection_is_that_of_opencv() -> None:
    """The renderer's lens is OpenCV's, and its rays are the inverse."""
    rng = np.random.default_rng(1)
    pixels = rng.uniform((0, 0), CAMERA.size, (100, 2))
    points = np.column_stack([CAMERA.rays(pixels), np.ones(100)])
    projected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), CAMERA.matrix, np.array(CAMERA.distortion))
    assert projected.reshape(-1, 2) == pytest.approx(pixels, abs=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_a_square_is_where_its_projection_is(seed: int) -> None:
    """The centre of a rendered square's light is the centre of its outline's area: no half pixel is lost."""
    rng = np.random.default_rng(seed)
    pose = random_pose(CAMERA, 40, rng)
    plane = Print(np.full((30, 30), 250, np.uint8), 0.05 / 30)
    frame = render(CAMERA, np.full((480, 640), 10.0), [(plane, pose)], rng, noise_sigma=0).astype(float) - 10
    rows, columns = np.indices(frame.shape)
    light = np.array([(frame * columns).sum(), (frame * rows).sum()]) / frame.sum()
    h = 0.025
    outline = project(CAMERA, pose, np.array([[-h, h, 0], [h, h, 0], [h, -h, 0], [-h, -h, 0]]))
    moments = cv2.moments(outline.astype(np.float32))
    assert light == pytest.approx(np.array([moments["m10"], moments["m01"]]) / moments["m00"], abs=0.03)


def test_the_noise_is_what_was_asked_for() -> None:
    """Two grey levels, and the rounding to whole ones."""
    frame = render(CAMERA, np.full((480, 640), 100.4), [], np.random.default_rng(0))
    assert frame.std() == pytest.approx((2.0**2 + 1 / 12) ** 0.5, rel=0.02)
    assert frame.mean() == pytest.approx(100.4, abs=0.02)


def test_a_print_outside_the_frame_changes_nothing() -> None:
    """What is not in view is not painted."""
    plane = Print(np.zeros((10, 10), np.uint8), 0.005)
    pose = Pose(np.diag([1.0, -1.0, -1.0]), np.array([5.0, 0.0, 1.0]))
    frame = render(CAMERA, np.full((480, 640), 100.0), [(plane, pose)], np.random.default_rng(0), noise_sigma=0)
    assert (frame == 100).all()
