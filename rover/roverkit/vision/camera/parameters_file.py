"""File of a camera's parameters, `charuco_camera_params.yml`: OpenCV's FileStorage with keys of ROS.

    %YAML:1.0
    ---
    image_width: 1920
    image_height: 1200
    camera_matrix: !!opencv-matrix
       rows: 3
       cols: 3
       dt: d
       data: [ 1163.311, 0.0, 941.628, 0.0, 1168.458, 618.535, 0.0, 0.0, 1.0 ]
    distortion_model: "plumb_bob"
    distortion_coefficients: !!opencv-matrix
       rows: 1
       cols: 5
       dt: d
       data: [ 0.100096, -0.256227, 0.00111085, 0.000269882, 0.203651 ]

The XML of OpenCV's FileStorage is read as well. Only `camera_matrix` and `distortion_coefficients` are required;
unknown keys are ignored. Image size and distortion model have the keys of ROS's `camera_calibration`, so its files can
be read as well. The text is parsed as YAML and not by OpenCV, because errors then have a line number. It is not written
by OpenCV either, because 5.0 writes another first line than 4.x.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.camera.file_storage_xml import compose_xml
from roverkit.vision.yaml_file import LARGEST, Item, parse, parse_with
from roverlink.bounded_files import read_text
from roverlink.numerals import counted
from roverlink.runtime.atomic_files import write_whole
from roverlink.runtime.core.errors import SetupError, nearest

PLUMB_BOB, RATIONAL, EQUIDISTANT = "plumb_bob", "rational_polynomial", "equidistant"
"""Names of the distortion models in ROS (sensor_msgs/distortion_models.hpp)."""
_MODELS = {PLUMB_BOB: (4, 5), RATIONAL: (8, 12, 14), EQUIDISTANT: (4,)}
"""Allowed numbers of distortion coefficients of each model."""
OTHER_NAMES = {"radtan": PLUMB_BOB, "fisheye": EQUIDISTANT, "kannala_brandt": EQUIDISTANT}
"""Names of the same models in Kalibr (radtan), OpenCV (fisheye) and camera drivers."""
_UNDISTORTED = ("none", "")
DEVIATIONS = "standard_deviations"
"""Key of the standard deviations of fx fy cx cy and the coefficients."""
COVARIANCE = "parameter_covariance"
"""Key of the covariance of the same parameters."""

_LINE = 120  # columns; OpenCV before 4.5.4 rejects lines longer than 4096
_TAG = "!!opencv-matrix"

Fact = str | int | float | Floats
"""Value that can be written to the file; an array must have two dimensions, and is written as a matrix."""


def model_name(camera: CameraParameters) -> str:
    """Return the name of a camera's distortion model in ROS, as in `sensor_msgs/CameraInfo`."""
    if camera.fisheye:
        return EQUIDISTANT
    return RATIONAL if camera.distortion.size > max(_MODELS[PLUMB_BOB]) else PLUMB_BOB


def read_parameters(path: Path) -> CameraParameters:
    """Read a camera's parameters from a file.

    Raises `SetupError` if the file is missing, is not YAML, or describes an impossible camera. If the error is in a
    line of the file, the message names the line.
    """
    try:
        text = read_text(path)
    except FileNotFoundError as error:
        raise SetupError(
            f"{path}: no such file with camera parameters; make one with `roverlink aruco calibrate`"
        ) from error
    except OSError as error:
        raise SetupError(f"{path}: cannot read the file: {error.strerror}") from error
    entries = _Entries(path, text)
    matrix, distortion = entries.matrix("camera_matrix"), entries.matrix("distortion_coefficients")
    size, fisheye = entries.size(), entries.model(distortion) == EQUIDISTANT
    covariance = entries.covariance()
    try:
        return CameraParameters(matrix, distortion, size, fisheye, covariance)
    except SetupError as error:
        raise SetupError(f"{path}: {error}") from error


def write_parameters(path: Path, camera: CameraParameters, facts: Mapping[str, Fact] | None = None) -> None:
    """Write a camera's parameters and `facts`, which are additional keys, to a file, completely or not at all.

    Equal values give equal bytes. Raises `SetupError` if the file cannot be written.
    """
    entries: dict[str, Fact] = {}
    if camera.size is not None:
        entries["image_width"], entries["image_height"] = camera.size
    entries["camera_matrix"] = camera.matrix
    entries["distortion_model"] = model_name(camera)
    # OpenCV and ROS both expect coefficients; five zeros mean no distortion.
    none = np.zeros(max(_MODELS[PLUMB_BOB]))
    entries["distortion_coefficients"] = (camera.distortion if camera.distortion.size else none).reshape(1, -1)
    entries |= facts or {}
    lines = (line for key, fact in entries.items() for line in _lines(key, fact))
    write_whole(path, "\n".join(["%YAML:1.0", "---", *lines, ""]).encode())


def _lines(key: str, fact: Fact) -> Iterator[str]:
    if not isinstance(fact, np.ndarray):
        yield f"{key}: {_scalar(fact)}"
        return
    rows, columns = fact.shape
    yield f"{key}: {_TAG}"
    yield from (f"   rows: {rows}", f"   cols: {columns}", "   dt: d")
    line = "   data: ["
    for place, number in enumerate(fact.ravel().tolist(), 1):
        word = f" {_scalar(float(number))}{',' if place < fact.size else ' ]'}"
        if len(line) + len(word) > _LINE:
            yield line
            line = "      "
        line += word
    yield line if fact.size else f"{line} ]"


def _scalar(value: str | int | float) -> str:
    """Return a value as text that both YAML and OpenCV can read."""
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, int) or math.isfinite(value):
        return repr(value)
    return ".Nan" if math.isnan(value) else ".Inf" if value > 0 else "-.Inf"


class _Entries:
    """Keys of a parameter file, with their values and their positions in the file."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        if text.lstrip("\ufeff \t\r\n").startswith("<"):
            whole = parse_with(compose_xml, path, text)
        else:
            # "%YAML:1.0" is not valid YAML; as a comment it keeps the line numbers.
            whole = parse(path, "#" + text if text.startswith("%YAML") else text)
        self._items = whole.entries() if whole.is_mapping else {}
        if not self._items:
            raise SetupError(f"{path}: no camera parameters found; the file needs keys such as camera_matrix")

    def matrix(self, key: str) -> Floats:
        """Return the matrix of a key: in OpenCV's form, which has a tag, or in the form of ROS, which has none."""
        item = self._items.get(key)
        if item is None:
            otherwise = "camera parameters come from `roverlink aruco calibrate`"
            raise SetupError(f"{self._path}: missing key {key!r}; {nearest(key, map(str, self._items), otherwise)}")
        parts = item.entries() if item.is_mapping else {}
        data = parts["data"].items(f"a number of {key}") if {"rows", "cols", "data"} <= parts.keys() else None
        if data is None:
            raise item.error(f"{key} is not a matrix with rows, cols and data")
        rows, columns = (_whole(parts[name], name, least=0) for name in ("rows", "cols"))
        numbers = [_number(number) for number in data]
        if len(numbers) != rows * columns:
            raise parts["data"].error(f"{key} is {rows}x{columns}, but has {counted(len(numbers), 'number')}")
        return np.array(numbers).reshape(rows, columns)

    def covariance(self) -> Floats | None:
        """Return the covariance of the parameters; None if the file tells nothing about their accuracy.

        Standard deviations alone are used for fx fy cx cy only: errors of the coefficients cancel each other to a large
        part, so without their correlations they would seem much larger than they are.
        """
        if COVARIANCE in self._items:
            return self.matrix(COVARIANCE)
        if DEVIATIONS not in self._items:
            return None
        deviations = self.matrix(DEVIATIONS).ravel()
        if deviations.size < 4:
            numbers = counted(deviations.size, "number")
            raise self._items[DEVIATIONS].error(f"{DEVIATIONS} has {numbers}; it needs fx fy cx cy")
        return np.diag(deviations[:4] ** 2)

    def size(self) -> tuple[int, int] | None:
        """Return width and height of the images of the calibration; None if the file does not have them."""
        keys = ("image_width", "image_height")
        given = [key for key in keys if key in self._items]
        if not given:
            return None
        if len(given) == 1:
            raise self._items[given[0]].error(
                f"{given[0]!r} is given alone; give both 'image_width' and 'image_height'"
            )
        width, height = (_whole(self._items[key], key) for key in keys)
        return width, height

    def model(self, distortion: Floats) -> str:
        """Return the distortion model that the file names. Without a name, the number of coefficients decides."""
        item = self._items.get("distortion_model")
        if item is None:
            return RATIONAL if distortion.size in _MODELS[RATIONAL] else PLUMB_BOB
        name = item.text or ""
        if name in _UNDISTORTED:
            if distortion.any():
                raise item.error(
                    f"the distortion model is {item.shown}, but there are coefficients that are not 0; "
                    f"name their model, such as {PLUMB_BOB}"
                )
            return PLUMB_BOB
        model = OTHER_NAMES.get(name, name)
        if model not in _MODELS:
            raise item.error(f"unknown distortion model {name!r}; {nearest(name, [*_MODELS, *OTHER_NAMES, 'none'])}")
        # ROS writes no coefficients at all for a pinhole camera without distortion.
        if distortion.size not in _MODELS[model] and (distortion.size or model == EQUIDISTANT):
            wanted = " or ".join(map(str, _MODELS[model]))
            raise item.error(
                f"the distortion model {name!r} needs {wanted} coefficients, but the file has {distortion.size}"
            )
        return model


def _whole(item: Item, what: str, least: int = 1) -> int:
    number = item.value
    if isinstance(number, bool) or not isinstance(number, int) or number < least:
        raise item.error(f"{what} is {item.shown}; it must be a whole number, at least {least}")
    return number


def _number(item: Item) -> float:
    """Parse the text of an item as a number, because OpenCV writes some numbers in a form that YAML reads as text."""
    try:
        number = float(item.text or "")
    except ValueError:
        number = math.nan
    item.require(abs(number) <= LARGEST, f"a finite number, at most {LARGEST:g}")  # false for NaN too
    return number
