"""Check that a camera's parameters belong to images of a size.

Parameters are valid for one image size. Those of another size give positions that are wrong by metres, and nothing else
shows it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverlink.runtime.core.errors import SetupError

_SAME_SHAPE = 0.01
"""Largest relative change of the ratio fx / fy at which images count as scaled, and not as cropped or stretched."""
_CENTRED = 0.05
"""Largest distance of the principal point from the centre, as a part of the image's size, if no size is named.

Lenses are mounted within a few percent of the centre. Parameters for images of 1920x1200 are off by 7 % on images of
1920x1080, and those for 640x480 by 10 % on 800x600.
"""
_NEARLY_CENTRED = 0.2
"""The same distance above which a calibration for this image size gives a warning: the images may be cropped."""
_OUTSIDE = 0.5
_USUAL = [
    *((320, 240), (424, 240), (640, 360), (640, 480), (800, 600), (848, 480), (960, 540), (1024, 768), (1280, 720)),
    *((1280, 800), (1280, 960), (1280, 1024), (1440, 1080), (1600, 1200), (1920, 1080), (1920, 1200), (2048, 1536)),
    *((2560, 1440), (2592, 1944), (3280, 2464), (3840, 2160), (4032, 3024), (4608, 2592)),
]
"""Usual image sizes of cameras."""


def for_images(
    camera: CameraParameters, size: tuple[int, int], name: str, *, rescale: bool, warn: Callable[[str], None]
) -> CameraParameters:
    """Return the camera's parameters for images of ``size`` (width, height).

    With ``rescale``, parameters for images of another size are scaled. ``name`` is the file or topic of the parameters
    in messages; ``warn`` is called with warnings. Raises `SetupError` if the parameters do not fit.
    """
    width, height = size
    own = camera.size or size
    _check_principal_point(camera, own, name, warn)
    if camera.size == size or (camera.size is None and not rescale):
        if camera.size is None:
            warn(f"{name} names no image size; assuming {width}x{height}")
        return camera
    if not rescale:
        raise SetupError(
            f"{name}: the camera parameters are for images of {_text(own)} pixels, but the images have "
            f"{width}x{height}; calibrate at this size, or use --rescale if the camera scales its images and does not "
            "crop them"
        )
    scaled = camera.scaled(size)
    # Scaling keeps the ratio of the focal lengths; cropping or stretching in one direction changes it.
    ratio = float(scaled.focal[0] / scaled.focal[1] / (camera.focal[0] / camera.focal[1]))
    if abs(ratio - 1) > _SAME_SHAPE:
        raise SetupError(
            f"{name}: images of {width}x{height} pixels are not scaled images of {_text(own)}: they were "
            "cropped or stretched; calibrate at this size"
        )
    warn(f"{name}: the parameters were scaled from images of {_text(own)} pixels to {width}x{height}")
    return scaled


def _check_principal_point(
    camera: CameraParameters, size: tuple[int, int], name: str, warn: Callable[[str], None]
) -> None:
    """Raise `SetupError` if the principal point cannot be that of images of ``size``.

    Far from the centre is an error only if the parameters name no size; otherwise the camera may really be so.
    """
    off = float(_distances(camera.centre, [size])[0])
    place = "outside" if off > _OUTSIDE else "far from the centre of"
    cx, cy = camera.centre.tolist()
    what = f"{name}: the principal point ({cx:.1f}, {cy:.1f}) is {place} the image of {_text(size)} pixels"
    likely = f"its parameters are likely for images of {_plausible(camera)}"
    if camera.size is None and off > _CENTRED:
        cure = "calibrate at this size; or add image_width and image_height to the file if they are known"
        raise SetupError(f"{what}; {likely}; {cure}")
    if off > _OUTSIDE:
        raise SetupError(f"{what}; {likely}; calibrate at this size")
    if off > _NEARLY_CENTRED:
        warn(f"{what}; if the camera does not crop its images, calibrate again")


def _plausible(camera: CameraParameters) -> str:
    """Return the usual image size whose centre is nearest to the principal point, or else twice the principal point."""
    distances = _distances(camera.centre, _USUAL)
    best = int(np.argmin(distances))
    if distances[best] <= _CENTRED:
        return _text(_USUAL[best])
    width, height = np.maximum(2 * camera.centre + 1, 1).tolist()
    return f"about {width:.0f}x{height:.0f}"


def _distances(centre: Floats, sizes: list[tuple[int, int]]) -> Floats:
    """Return the distance of a principal point from the centre of each image size, as a part of the size.

    The larger one of the distances in x and y counts. It is above 1/2 if the point is outside the image.
    """
    distances: Floats = np.abs((centre + 0.5) / np.array(sizes, dtype=float) - 0.5).max(axis=1)
    return distances


def _text(size: tuple[int, int]) -> str:
    return "{}x{}".format(*size)
