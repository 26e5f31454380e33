"""Cameras: what meets which pixel."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.runtime.core.errors import SetupError
from roverlink.vision import CameraParameters

MATRIX = np.array([[1163.3, 0, 941.6], [0, 1168.5, 618.5], [0, 0, 1.0]])
ROVER = (0.100096, -0.256227, 0.00111085, 0.000269882, 0.203651)
RATIONAL = (0.3, 0.1, 1e-3, -2e-3, 0.02, 0.4, 0.15, 0.03)
CAMERAS = {
    "pinhole": CameraParameters(MATRIX, np.array([]), (1920, 1200)),
    "4 coefficients": CameraParameters(MATRIX, np.array([0.1, -0.2, 0.001, -0.002]), (1920, 1200)),
    "rover": CameraParameters(MATRIX, np.array(ROVER), (1920, 1200)),
    "rational": CameraParameters(MATRIX, np.array(RATIONAL), (1920, 1200)),
    "thin prism": CameraParameters(MATRIX, np.array([*RATIONAL, 0.01, -0.004, -0.008, 0.003]), (1920, 1200)),
    "tilt": CameraParameters(MATRIX, np.array([*RATIONAL, 0.01, -0.004, -0.008, 0.003, 0.05, -0.08]), (1920, 1200)),
    "fisheye": CameraParameters(MATRIX, np.array([0.1, -0.02, 0.01, -0.002]), (1920, 1200), fisheye=True),
}
rays = st.tuples(st.floats(-0.6, 0.6), st.floats(-0.5, 0.5)).map(np.array)
kinds = st.sampled_from(list(CAMERAS))


@settings(max_examples=40)
@given(kinds, rays)
def test_projection_is_that_of_opencv(kind: str, ray: np.ndarray) -> None:
    """A calibration by OpenCV means here what it means there."""
    camera, point = CAMERAS[kind], np.append(ray, 1.0)
    if camera.fisheye:
        expected, _ = cv2.fisheye.projectPoints(
            point.reshape(1, 1, 3), np.zeros(3), np.zeros(3), MATRIX, camera.distortion
        )
    else:
        expected, _ = cv2.projectPoints(point.reshape(1, 3), np.zeros(3), np.zeros(3), MATRIX, camera.distortion)
    assert camera.project(3 * point) == pytest.approx(expected.ravel(), abs=1e-7)


@settings(max_examples=40)
@given(kinds, rays)
def test_undistorting_takes_distorting_back(kind: str, ray: np.ndarray) -> None:
    """A pixel's ray meets that pixel."""
    camera = CAMERAS[kind]
    assert camera.undistort(camera.distort(ray)) == pytest.approx(ray, abs=1e-9)


@settings(max_examples=40)
@given(st.sampled_from([kind for kind, camera in CAMERAS.items() if not camera.fisheye]), rays)
def test_undistorting_is_that_of_opencv(kind: str, ray: np.ndarray) -> None:
    """OpenCV finds the same ray for a pixel, where its iteration is let run to the end."""
    camera = CAMERAS[kind]
    pixel = camera.distort(ray)
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 500, 1e-13)
    undistort = getattr(cv2, "undistortPointsIter", cv2.undistortPoints)  # OpenCV 4 has its own function for criteria
    expected = undistort(pixel.reshape(1, 1, 2), MATRIX, camera.distortion, R=np.eye(3), P=np.eye(3), criteria=criteria)
    assert camera.undistort(pixel) == pytest.approx(expected.ravel(), abs=1e-7)


@settings(max_examples=40)
@given(kinds, rays)
def test_the_slope_is_the_derivative(kind: str, ray: np.ndarray) -> None:
    """What a small change of the ray does to the pixel is what the slope says."""
    camera, small = CAMERAS[kind], 1e-6
    _, slope = camera.distort_with_derivative(ray)
    for axis, step in enumerate(np.eye(2) * small):
        difference = (camera.distort(ray + step) - camera.distort(ray - step)) / (2 * small)
        assert slope[:, axis] == pytest.approx(difference, rel=1e-5, abs=1e-3)


@settings(max_examples=40)
@given(kinds, rays, st.sampled_from([(960, 600), (640, 400), (3840, 2400), (1280, 1200)]))
def test_a_scaled_camera_sees_the_same_part_of_the_image(kind: str, ray: np.ndarray, size: tuple[int, int]) -> None:
    """Pixel areas scale, so a place (x + 1/2) / width of the image stays."""
    camera = CAMERAS[kind]
    before, after = camera.distort(ray), camera.scaled(size).distort(ray)
    assert (after + 0.5) / size == pytest.approx((before + 0.5) / (1920, 1200), abs=1e-9)


def test_points_behind_the_camera_meet_no_pixel() -> None:
    """They give nan, not a pixel that looks right."""
    assert np.isnan(CAMERAS["rover"].project(np.array([0.1, 0.1, -1.0]))).all()


@pytest.mark.parametrize(
    ("matrix", "distortion", "fisheye", "words"),
    [
        (np.eye(2), ROVER, False, "3x3"),
        (np.diag([-1.0, 1, 1]), ROVER, False, "positive focal"),
        (np.full((3, 3), np.nan), ROVER, False, "3x3"),
        (MATRIX, (1, 2, 3), False, "3 coefficients"),
        (MATRIX, ROVER, True, "k1 k2 k3 k4"),
        (MATRIX, (np.inf,) * 5, False, "finite"),
    ],
)
def test_what_cannot_be_a_camera_is_refused(matrix: np.ndarray, distortion: tuple, fisheye: bool, words: str) -> None:
    """The message says what a camera has instead."""
    with pytest.raises(SetupError, match=words):
        CameraParameters(matrix, np.array(distortion), None, fisheye)


def test_scaling_needs_a_size() -> None:
    """Parameters that say nothing about the image cannot be scaled."""
    with pytest.raises(SetupError, match="no image size"):
        CameraParameters(MATRIX, np.array(ROVER)).scaled((640, 480))
