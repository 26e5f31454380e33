"""Parameters of cameras from their CameraInfo."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from roverlink.runtime import SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, RegionOfInterest
from roverlink.vision import CameraParameters
from roverlink.vision.ros.camera_info import camera_info_topic, camera_of, is_rectified
from tests.vision.ros_images import camera_info

_MATRIX = np.array([[600.0, 0, 322.5], [0, 602.0, 236.0], [0, 0, 1]])
_PLUMB_BOB = CameraParameters(_MATRIX, np.array([0.1, -0.2, 0.001, 0.002, 0.05]), (640, 480))
_TILTED = CameraParameters(_MATRIX, np.linspace(0.01, 0.02, 14), (640, 480))
_RATIONAL = CameraParameters(_MATRIX, np.array([0.1, -0.2, 0.001, 0.002, 0.05, 0.01, 0.02, 0.03]), (640, 480))
_FISHEYE = CameraParameters(_MATRIX, np.zeros(4), (640, 480), fisheye=True)


def _info(camera: CameraParameters = _PLUMB_BOB, **fields: Any) -> CameraInfo:
    info = camera_info(camera)
    for name, value in fields.items():
        setattr(info, name, value)
    return info


@pytest.mark.parametrize("camera", [_PLUMB_BOB, _RATIONAL, _TILTED, _FISHEYE])
def test_each_model_comes_back(camera: CameraParameters) -> None:
    """Matrix, distortion, size and kind of lens are those of the driver."""
    read = camera_of(camera_info(camera), rectified=False)
    assert np.array_equal(read.matrix, camera.matrix)
    assert np.array_equal(read.distortion, camera.distortion if camera.distortion.any() or camera.fisheye else [])
    assert (read.size, read.fisheye) == (camera.size, camera.fisheye)


@pytest.mark.parametrize(("model", "coefficients"), [("", []), ("", [0.0] * 5), ("plumb_bob", [0.0] * 5), ("none", [])])
def test_a_camera_without_distortion(model: str, coefficients: list[float]) -> None:
    """Drivers spell it in several ways."""
    assert camera_of(_info(distortion_model=model, d=coefficients), rectified=False).distortion.size == 0


def test_other_names_of_a_model_are_known() -> None:
    """Kalibr's name of plumb_bob, for one."""
    read = camera_of(_info(d=[0.1, 0.2, 0.0, 0.0], distortion_model="radtan"), rectified=False)
    assert read.distortion.tolist() == [0.1, 0.2, 0.0, 0.0]


def test_rectified_images_have_p_and_no_distortion() -> None:
    """K and D belong to the raw images."""
    p = [500.0, 0, 310, -25, 0, 500, 240, 0, 0, 0, 1, 0]
    read = camera_of(_info(p=p), rectified=True)
    assert read.matrix.tolist() == [[500, 0, 310], [0, 500, 240], [0, 0, 1]]
    assert read.distortion.size == 0


def test_a_cut_and_binned_image_has_its_own_parameters() -> None:
    """A ray meets the pixel of the whole image that is in the window, and the bin that this pixel is in."""
    roi = RegionOfInterest(x_offset=40, y_offset=20, width=401, height=300)
    read = camera_of(_info(roi=roi, binning_x=2, binning_y=4), rectified=False)
    assert read.size == (200, 75)
    rays = np.array([[0.0, 0.0], [0.2, -0.1]])
    whole = _PLUMB_BOB.distort(rays)
    assert np.allclose(read.distort(rays), (whole - (40, 20) + 0.5) / (2, 4) - 0.5)


@pytest.mark.parametrize(
    ("fields", "rectified", "expected"),
    [
        (
            {"k": [0.0] * 9},
            False,
            r"not calibrated: K of its CameraInfo is zero; .*`roverlink aruco calibrate`, .*--para",
        ),
        ({"p": [0.0] * 12}, True, "not calibrated: P of its CameraInfo is zero"),
        ({"distortion_model": "thin_prism"}, False, "unknown distortion model 'thin_prism' in the CameraInfo"),
        ({"d": [0.1] * 9, "distortion_model": "rational_polynomial"}, False, "the distortion has 9 coefficients"),
        ({"width": 0}, False, "names no image size"),
        ({"k": [float("nan")] * 9}, False, "must be 3x3 with positive focal lengths"),
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
        ("/camera/image_rect/compressed", "/camera/camera_info", True),
        ("/image", "/camera_info", False),
    ],
)
def test_the_topic_beside_the_images(image: str, info: str, rectified: bool) -> None:
    """Its name follows ROS 2's rule, and the name of the images tells whether they are rectified."""
    assert (camera_info_topic(image), is_rectified(image)) == (info, rectified)
