"""Cameras: what meets which pixel, by OpenCV's own functions, and what a CameraInfo says about one."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from roverkit.vision import CameraParameters
from roverkit.vision.ros.camera_info import camera_info_topic, camera_of, is_rectified

from rover.tests.vision.ros_images import camera_info
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, RegionOfInterest

MATRIX = np.array([[1163.3, 0, 941.6], [0, 1168.5, 618.5], [0, 0, 1.0]])
ROVER = (0.100096, -0.256227, 0.00111085, 0.000269882, 0.203651)
RATIONAL = (0.3, 0.1, 1e-3, -2e-3, 0.02, 0.4, 0.15, 0.03)
PRISM = (0.01, -0.004, -0.008, 0.003)
CAMERAS = {
    name: CameraParameters(MATRIX, np.array(distortion), (1920, 1200), name == "fisheye")
    for name, distortion in {
        "pinhole": (),
        "4 coefficients": (0.1, -0.2, 0.001, -0.002),
        "rover": ROVER,
        "rational": RATIONAL,
        "thin prism": (*RATIONAL, *PRISM),
        "tilt": (*RATIONAL, *PRISM, 0.05, -0.08),
        "fisheye": (0.1, -0.02, 0.01, -0.002),
    }.items()
}
rays = st.tuples(st.floats(-0.6, 0.6), st.floats(-0.5, 0.5)).map(np.array)
kinds = st.sampled_from(list(CAMERAS))


@given(kinds, rays)
def test_projection_is_that_of_opencv(kind: str, ray: np.ndarray) -> None:
    """A calibration by OpenCV means here what it means there; its ray for a pixel, iterated to the end, is the same."""
    camera, point = CAMERAS[kind], np.append(ray, 1.0).reshape(1, 1, 3)
    project = cv2.fisheye.projectPoints if camera.fisheye else cv2.projectPoints
    expected, _ = project(point, np.zeros(3), np.zeros(3), MATRIX, camera.distortion)
    assert camera.project(3 * point.ravel()) == pytest.approx(expected.ravel(), abs=1e-7)
    assert np.isnan(camera.project(-point.ravel())).all()  # behind the camera, no pixel looks right
    pixel = camera.distort(ray)
    assert camera.undistort(pixel) == pytest.approx(ray, abs=1e-9)
    if not camera.fisheye:
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 500, 1e-13)
        undistort = getattr(cv2, "undistortPointsIter", cv2.undistortPoints)  # OpenCV 4 has a function for criteria
        back = undistort(pixel.reshape(1, 1, 2), MATRIX, camera.distortion, R=np.eye(3), P=np.eye(3), criteria=criteria)
        assert camera.undistort(pixel) == pytest.approx(back.ravel(), abs=1e-7)


@settings(max_examples=40)
@given(kinds, rays)
def test_the_slope_is_the_derivative(kind: str, ray: np.ndarray) -> None:
    """What a small change of the ray does to the pixel is what the slope says."""
    camera, small = CAMERAS[kind], 1e-6
    _, slope = camera.distort_with_derivative(ray)
    for axis, step in enumerate(np.eye(2) * small):
        difference = (camera.distort(ray + step) - camera.distort(ray - step)) / (2 * small)
        assert slope[:, axis] == pytest.approx(difference, rel=1e-5, abs=1e-3)


@settings(max_examples=20)
@given(kinds, rays, st.sampled_from([(960, 600), (640, 400), (3840, 2400), (1280, 1200)]))
def test_a_scaled_camera_sees_the_same_part_of_the_image(kind: str, ray: np.ndarray, size: tuple[int, int]) -> None:
    """Pixel areas scale, so a place (x + 1/2) / width of the image stays."""
    camera = CAMERAS[kind]
    before, after = camera.distort(ray), camera.scaled(size).distort(ray)
    assert (after + 0.5) / size == pytest.approx((before + 0.5) / (1920, 1200), abs=1e-9)


@pytest.mark.parametrize(
    ("matrix", "distortion", "fisheye", "words"),
    [
        (np.eye(2), ROVER, False, "3x3"),
        (np.diag([-1.0, 1, 1]), ROVER, False, "positive focal"),
        (MATRIX, (1, 2, 3), False, "3 coefficients"),
        (MATRIX, ROVER, True, "k1 k2 k3 k4"),
        (MATRIX, ROVER, False, "no image size"),
    ],
)
def test_what_cannot_be_a_camera_is_refused(matrix: np.ndarray, distortion: tuple, fisheye: bool, words: str) -> None:
    """The message says what a camera has instead; one without an image size cannot be scaled."""
    with pytest.raises(SetupError, match=words):
        CameraParameters(matrix, np.array(distortion), None, fisheye).scaled((640, 480))


def _info(kind: str = "rover", **fields: Any) -> CameraInfo:
    info = camera_info(CAMERAS[kind])
    for name, value in fields.items():
        setattr(info, name, value)
    return info


@pytest.mark.parametrize("kind", ["4 coefficients", "rover", "rational", "tilt", "fisheye"])
def test_each_model_comes_back(kind: str) -> None:
    """Matrix, distortion, size and kind of lens are those of the driver."""
    read, camera = camera_of(_info(kind), rectified=False), CAMERAS[kind]
    assert np.array_equal(read.matrix, camera.matrix)
    assert np.array_equal(read.distortion, camera.distortion)
    assert (read.size, read.fisheye) == (camera.size, camera.fisheye)


@pytest.mark.parametrize(
    ("model", "coefficients", "read"),
    [
        *((model, zeros, []) for model, zeros in (("", []), ("", [0.0] * 5), ("plumb_bob", [0.0] * 5), ("none", []))),
        ("equidistant", [0.0] * 4, [0.0] * 4),
        ("radtan", [0.1, 0.2, 0.0, 0.0], [0.1, 0.2, 0.0, 0.0]),
    ],
)
def test_other_spellings_of_a_model_are_known(model: str, coefficients: list[float], read: list[float]) -> None:
    """Drivers spell a camera without distortion in several ways; Kalibr calls plumb_bob radtan."""
    assert camera_of(_info(distortion_model=model, d=coefficients), rectified=False).distortion.tolist() == read


def test_rectified_images_have_p_and_no_distortion() -> None:
    """K and D belong to the raw images."""
    read = camera_of(_info(p=[500.0, 0, 310, -25, 0, 500, 240, 0, 0, 0, 1, 0]), rectified=True)
    assert read.matrix.tolist() == [[500, 0, 310], [0, 500, 240], [0, 0, 1]]
    assert read.distortion.size == 0


def test_a_cut_and_binned_image_has_its_own_parameters() -> None:
    """A ray meets the pixel of the whole image that is in the window, and the bin that this pixel is in."""
    roi = RegionOfInterest(x_offset=40, y_offset=20, width=401, height=300)
    read = camera_of(_info(roi=roi, binning_x=2, binning_y=4), rectified=False)
    assert read.size == (200, 75)
    rays = np.array([[0.0, 0.0], [0.2, -0.1]])
    assert np.allclose(read.distort(rays), (CAMERAS["rover"].distort(rays) - (40, 20) + 0.5) / (2, 4) - 0.5)


@pytest.mark.parametrize(
    ("fields", "rectified", "expected"),
    [
        ({"k": [0.0] * 9}, False, r"calibrated: K of its CameraInfo is zero; .*`roverlink aruco calibrate`, .*--para"),
        ({"p": [0.0] * 12}, True, "not calibrated: P of its CameraInfo is zero"),
        ({"distortion_model": "thin_prism"}, False, "unknown distortion model 'thin_prism' in the CameraInfo"),
    ],
)
def test_what_cannot_be_used_is_told(fields: dict[str, Any], rectified: bool, expected: str) -> None:
    """The error says what is wrong with the driver's message, and what to do."""
    with pytest.raises(SetupError, match=expected):
        camera_of(_info(**fields), rectified)


@pytest.mark.parametrize(
    ("image", "info", "rectified"),
    [
        ("/camera/color/image_raw", "/camera/color/camera_info", False),
        ("/camera/color/image_raw/compressed", "/camera/color/camera_info", False),
        ("/camera/image_rect_color", "/camera/camera_info", True),
        ("/image", "/camera_info", False),
    ],
)
def test_the_topic_beside_the_images(image: str, info: str, rectified: bool) -> None:
    """Its name follows ROS 2's rule, and the name of the images tells whether they are rectified."""
    assert (camera_info_topic(image), is_rectified(image)) == (info, rectified)
