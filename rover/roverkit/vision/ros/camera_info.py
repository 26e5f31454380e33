"""Parameters of a camera from its sensor_msgs/CameraInfo.

A camera driver publishes the message beside its images. The rules are those of the comments in CameraInfo.msg.
"""

from __future__ import annotations

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.camera.parameters_file import EQUIDISTANT, OTHER_NAMES, PLUMB_BOB, RATIONAL
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo

_TRANSPORTS = ("compressed", "compressedDepth")
_RECTIFIED = "image_rect"
_REMEDY = "calibrate the camera with `roverlink aruco calibrate`, and give the file with --parameters"


def camera_info_topic(image_topic: str) -> str:
    """Return the topic with the camera's parameters that belongs to a topic with images, by ROS 2's rule.

    ``/camera/image_raw`` and ``/camera/image_raw/compressed`` both give ``/camera/camera_info``.
    """
    return f"{_uncompressed(image_topic).rpartition('/')[0]}/camera_info"


def is_rectified(image_topic: str) -> bool:
    """Return true if the images of a topic are rectified by its name, such as ``/camera/image_rect_color``."""
    return _uncompressed(image_topic).rpartition("/")[2].startswith(_RECTIFIED)


def camera_of(info: CameraInfo, rectified: bool) -> CameraParameters:
    """Return the parameters of a camera for its images, which are raw or rectified.

    Rectified images have the camera matrix P and no distortion; raw ones have K and the distortion D. Binning and the
    region of interest are applied. Raises `SetupError` if the camera is not calibrated, or if its distortion model is
    unknown.
    """
    matrix: Floats = np.reshape(info.p, (3, 4))[:, :3] if rectified else np.reshape(info.k, (3, 3))
    if not matrix[0, 0]:
        raise SetupError(
            f"the camera is not calibrated: {'P' if rectified else 'K'} of its CameraInfo is zero; {_REMEDY}"
        )
    model = OTHER_NAMES.get(info.distortion_model, info.distortion_model)
    distortion = np.zeros(0) if rectified else _distortion(info, model)
    fisheye = not rectified and model == EQUIDISTANT
    return _windowed(CameraParameters(matrix, distortion, (info.width, info.height), fisheye), info)


def _uncompressed(image_topic: str) -> str:
    base, _, transport = image_topic.rpartition("/")
    return base if transport in _TRANSPORTS else image_topic


def _distortion(info: CameraInfo, model: str) -> Floats:
    coefficients = np.array(info.d, dtype=float)
    if model == EQUIDISTANT:
        return coefficients
    # Drivers of images without distortion leave the model or the coefficients empty.
    if not coefficients.any():
        return np.zeros(0)
    if model not in (PLUMB_BOB, RATIONAL):
        raise SetupError(
            f"unknown distortion model {info.distortion_model!r} in the CameraInfo (known: {PLUMB_BOB}, {RATIONAL}, "
            f"{EQUIDISTANT}); {_REMEDY}"
        )
    return coefficients


def _windowed(camera: CameraParameters, info: CameraInfo) -> CameraParameters:
    """Return the camera for images that are cut to the region of interest, and then binned."""
    roi, across, down = info.roi, max(info.binning_x, 1), max(info.binning_y, 1)
    # A region of zeros means the whole image.
    width, height = (roi.width or info.width) // across, (roi.height or info.height) // down
    if not (width and height):
        raise SetupError(f"the CameraInfo names no image size; {_REMEDY}")
    matrix = camera.matrix.copy()
    matrix[:2, 2] -= (roi.x_offset, roi.y_offset)
    cut = CameraParameters(matrix, camera.distortion, (width * across, height * down), camera.fisheye)
    return cut.scaled((width, height))
