"""Positions of detected objects from a depth image."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverlink.vision import CameraParameters, Pose
from roverlink.vision.objects.detected_objects import Box
from roverlink.vision.objects.location import Location, locate
from roverlink.vision.poses.pose import rotation_of

_CAMERA = CameraParameters(np.array([[600.0, 0, 320], [0, 610, 240], [0, 0, 1]]), np.array([0.1, -0.2, 0, 0, 0]))


def _depth(distance: float) -> np.ndarray:
    return np.full((480, 640), distance)


@given(
    st.floats(0.3, 8.0),
    st.floats(0, 600),
    st.floats(0, 440),
    st.floats(4, 200),
    st.floats(4, 200),
)
def test_the_position_is_seen_at_the_middle_of_the_box(
    distance: float, x: float, y: float, width: float, height: float
) -> None:
    """For any box in the image, whose lens bends."""
    box = Box(x, y, min(width, 640 - x), min(height, 480 - y))
    found = locate(box, _depth(distance), _CAMERA)
    assert found
    assert found.point[2] == pytest.approx(distance)
    assert _CAMERA.project(found.point) == pytest.approx([box.x + box.width / 2, box.y + box.height / 2], abs=1e-6)
    assert np.linalg.eigvalsh(found.covariance).min() > 0


def test_the_background_at_the_rim_does_not_count() -> None:
    """The depths in the middle of the box decide; their median ignores some that are wrong."""
    depth = _depth(5.0)
    depth[100:200, 100:200] = 2.0
    depth[140:150, 140:160] = 9.0
    found = locate(Box(90, 90, 120, 120), depth, _CAMERA)
    assert found
    assert found.point[2] == 2.0


@pytest.mark.parametrize(("missing", "value"), [(0.0, 0), (0.6, 0), (0.6, np.nan), (0.8, 0), (1.0, 0), (1.0, np.nan)])
def test_too_few_depths_give_no_position(missing: float, value: float) -> None:
    """At least 30 % of the middle must have a depth."""
    depth = _depth(2.0)
    depth[:, : round(640 * missing)] = value
    depth = np.random.default_rng(0).permuted(depth, axis=1)
    assert (locate(Box(200, 100, 200, 200), depth, _CAMERA) is None) == (missing > 0.7)


def test_a_box_outside_the_depth_image_has_no_position() -> None:
    """For instance if the depth image is smaller than the colour image."""
    assert locate(Box(700, 100, 20, 20), _depth(2.0), _CAMERA) is None


def test_the_covariance_covers_the_error() -> None:
    """Boxes that are wrong by 5 % and depths that are wrong by 1 % give a normalized squared error of 3."""
    rng = np.random.default_rng(1)
    truth, nees = np.array([0.3, -0.2, 3.0]), []
    u, v = _CAMERA.project(truth)
    for _ in range(400):
        box = Box(u - 50 + rng.normal(0, 5), v - 30 + rng.normal(0, 3), 100, 60)
        found = locate(box, _depth(3 * (1 + rng.normal(0, 0.01))), _CAMERA)
        assert found
        error = found.point - truth
        nees.append(error @ np.linalg.solve(found.covariance, error))
    assert np.mean(nees) == pytest.approx(3, abs=0.5)


def test_a_position_goes_to_other_frames() -> None:
    """Its covariance turns with it."""
    one = Location(np.array([1.0, 2, 3]), np.diag([1.0, 4, 9]))
    quarter = Pose(rotation_of(np.array([0, 0, np.pi / 2])), np.array([10.0, 0, 0]))
    other = one.through(quarter)
    assert other.point == pytest.approx([8, 1, 3])
    assert np.diag(other.covariance) == pytest.approx([4, 1, 9])
    assert np.diag(one.after(2, 0.5).covariance) == pytest.approx([2, 5, 10])
