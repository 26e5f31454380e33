"""The file of a camera's parameters. OpenCV's own reader and writer are the judges."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from roverkit.vision import CameraParameters, read_parameters, write_parameters
from roverkit.vision.camera.parameters_file import model_name

from roverlink.runtime.core.errors import SetupError

MATRIX = np.array([[1163.311, 0, 941.628], [0, 1168.458, 618.535], [0, 0, 1.0]])
ROVER = (0.100096, -0.256227, 0.00111085, 2.69882e-07, 0.203651)
CAMERAS = {
    "plumb_bob": CameraParameters(MATRIX, np.array(ROVER), (1920, 1200)),
    "rational_polynomial": CameraParameters(MATRIX, np.linspace(-1, 1, 8) / 3, (1920, 1200)),
    "equidistant": CameraParameters(MATRIX, np.array([0.1, -0.02, 0.01, -0.002]), (640, 480), fisheye=True),
}
OLD = """%YAML:1.0
---
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1.1633110000000000e+03, 0., 9.4162800000000004e+02, 0.,
       1.1684580000000001e+03, 6.1853499999999997e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 1.00096e-01, -2.56227e-01, 1.11085e-03, 2.69882e-07, 2.03651e-01 ]
"""
WRITTEN = """%YAML:1.0
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
   data: [ 0.100096, -0.256227, 0.00111085, 2.69882e-07, 0.203651 ]
views: 20
of: "a lens"
"""
ROS = """image_width: 1920
image_height: 1200
camera_name: rover
camera_matrix: {rows: 3, cols: 3, data: [1163.311, 0, 941.628, 0, 1168.458, 618.535, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0.100096, -0.256227, 0.00111085, 2.69882e-7, 0.203651]}
"""
XML = """<?xml version="1.0"?>
<opencv_storage>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    1163.311 0. 941.628 0. 1168.458
    618.535 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>1</rows> <cols>5</cols> <dt>d</dt> <data>0.1 -0.2 0.001 0.0002 0.2</data>
</distortion_coefficients>
</opencv_storage>
"""


@pytest.mark.parametrize("model", CAMERAS)
def test_opencv_reads_what_is_written(tmp_path: Path, model: str) -> None:
    """Every number arrives as it was, facts beside the parameters included; so it does when read back here."""
    path, camera = tmp_path / "camera.yml", CAMERAS[model]
    deviations = np.arange(40.0).reshape(2, 20) / 7e5
    write_parameters(path, camera, {"rms": 0.1, "views": 20, "of": 'a "lens" \\ or so', "deviations": deviations})
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    assert (file.getNode("camera_matrix").mat() == camera.matrix).all()
    assert (file.getNode("distortion_coefficients").mat() == camera.distortion[None]).all()
    assert (file.getNode("deviations").mat() == deviations).all()
    assert file.getNode("distortion_model").string() == model == model_name(camera)
    assert (file.getNode("image_width").real(), file.getNode("image_height").real()) == camera.size
    assert (file.getNode("rms").real(), file.getNode("views").real()) == (0.1, 20)
    assert file.getNode("of").string() == 'a "lens" \\ or so'
    again = read_parameters(path)
    assert (again.matrix == camera.matrix).all()
    assert (again.distortion == camera.distortion).all()
    assert (again.size, again.fisheye) == (camera.size, camera.fisheye)


def test_the_file_is_the_same_whichever_opencv_is_installed(tmp_path: Path) -> None:
    """To the byte, so it makes no difference to git; without distortion it has zeros, OpenCV has no empty matrix."""
    path = tmp_path / "camera.yml"
    write_parameters(path, CAMERAS["plumb_bob"], {"views": 20, "of": "a lens"})
    assert path.read_text() == WRITTEN
    write_parameters(path, CameraParameters(MATRIX, np.array([])))
    assert (read_parameters(path).distortion == np.zeros(5)).all()


@pytest.mark.parametrize("name", ["camera.yml", "camera.xml"])
def test_what_opencv_writes_is_read(tmp_path: Path, name: str) -> None:
    """Files of whichever version is installed, whose first line differs."""
    path = tmp_path / name
    file = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    matrices = {"camera_matrix": MATRIX, "distortion_coefficients": np.array(ROVER)[:, None]}
    texts = {"distortion_model": "plumb_bob", "calibration_time": "Sat 22 Nov"}
    for key, value in {**matrices, "image_width": 1920, "image_height": 1200, **texts}.items():
        file.write(key, value)
    file.startWriteStruct("views", cv2.FileNode_SEQ)
    for number in range(2):
        file.startWriteStruct("", cv2.FileNode_MAP)
        file.write("number", number)
        file.endWriteStruct()
    file.endWriteStruct()
    file.release()
    camera = read_parameters(path)
    assert (camera.matrix == MATRIX).all()
    assert (camera.distortion == ROVER).all()
    assert camera.size == (1920, 1200)


@pytest.mark.parametrize(
    ("text", "size", "distortion"),
    [(OLD, None, ROVER), (ROS, (1920, 1200), ROVER), (XML, None, (0.1, -0.2, 0.001, 0.0002, 0.2))],
)
def test_files_of_others_are_read(tmp_path: Path, text: str, size: tuple[int, int] | None, distortion: tuple) -> None:
    """The lost calibration program's file, without a size; that of ROS's camera_calibration; and one by hand."""
    path = tmp_path / ("camera.xml" if text == XML else "camera.yml")
    path.write_text(text)
    camera = read_parameters(path)
    assert (camera.matrix == MATRIX).all()
    assert (camera.distortion == distortion).all()
    assert camera.size == size


@pytest.mark.parametrize(
    ("model", "coefficients", "as_here"),
    [
        ("radtan", "0.1, -0.2, 0.001, 0.002", "plumb_bob"),
        ("plumb_bob", "", "plumb_bob"),
        ("none", "", "plumb_bob"),
        ("rational_polynomial", ", ".join(["0.01"] * 14), "rational_polynomial"),
        ("fisheye", "0.1, -0.02, 0.01, -0.002", "equidistant"),
    ],
)
def test_models_have_the_names_that_others_use(tmp_path: Path, model: str, coefficients: str, as_here: str) -> None:
    """Those of ROS, OpenCV and Kalibr; drivers leave out the coefficients or the name where nothing is distorted."""
    path = tmp_path / "camera.yml"
    numbers = [float(one) for one in coefficients.split(",") if one]
    start = ROS[: ROS.index("distortion_model")]
    coefficients = f"distortion_coefficients: {{rows: 1, cols: {len(numbers)}, data: [{coefficients}]}}\n"
    path.write_text(f"{start}distortion_model: {model}\n{coefficients}")
    camera = read_parameters(path)
    assert camera.distortion.tolist() == numbers
    assert model_name(camera) == as_here


_DISTORTION = "distortion_coefficients: "


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("camera_matrix:", "camera_matrx:", r"missing key 'camera_matrix'; did you mean 'camera_matrx'\?"),
        ("camera_matrix:", "frame:", r"missing key 'camera_matrix'; camera parameters come from `roverlink aruco cal"),
        ("   rows: 3\n", "", r":3:16: camera_matrix is not a matrix"),
        ("rows: 3", "rows: 2", r":7:10: camera_matrix is 2x3, but has 9 numbers"),
        (" 0.,\n", " zero,\n", r":7:64: a number of camera_matrix is zero"),
        (_DISTORTION, f"image_width: 3\n{_DISTORTION}", r":9:14: .* give both"),
        ("1.1633", "1.0e+300, 1.1633", r":7:12: .* is 1.0e\+300; it must be a finite number, at most 1e\+09"),
        (_DISTORTION, f"distortion_model: fishy\n{_DISTORTION}", r":9:19: unknown distortion model 'fishy'"),
        (
            _DISTORTION,
            f"distortion_model: equidistant\n{_DISTORTION}",
            r"'equidistant' needs 4 coeff.*, but the file has 5",
        ),
        ("618.535 0.", "618.535 zero", r":9:13: a number of camera_matrix is zero"),
        ("camera_matrix type", "camera_matrx type", r":9:30: not valid XML: mismatched tag"),
        ("<?xml", "<!DOCTYPE x [<!ENTITY a 'b'>]>\n<?xml", r":1:\d+: the file has a document type"),
        ("opencv_storage", "calibration", r":2:1: the file is <calibration>, and no FileStorage"),
        ("<rows>1</rows>", "<rows>1</rows> <rows>2</rows>", r":11:18: the key rows occurs twice"),
    ],
)
def test_mistakes_are_told_with_their_place(tmp_path: Path, old: str, new: str, words: str) -> None:
    """The file, the line and the column, where the mistake has them, in YAML and in XML."""
    is_yaml = old in OLD
    path = tmp_path / f"camera.{'yml' if is_yaml else 'xml'}"
    path.write_text(OLD.replace(old, new, 1) if is_yaml else XML.replace(old, new))
    with pytest.raises(SetupError, match=words) as raised:
        read_parameters(path)
    assert str(raised.value).count(str(path)) == 1


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    """Where it cannot be written, nothing is left behind, and what was there stays."""
    (tmp_path / "folder").mkdir()
    for path in (tmp_path / "folder", tmp_path / "nowhere" / "camera.yml"):
        with pytest.raises(SetupError, match="cannot write the file"):
            write_parameters(path, CAMERAS["plumb_bob"])
    assert list(tmp_path.rglob("*")) == [tmp_path / "folder"]
