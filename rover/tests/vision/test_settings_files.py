"""Files that people write: landmarks, boards, cameras and classes of objects; and the markers that there are."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from roverkit.objects.object_types import ClassesFile, ObjectTypes, read_classes
from roverkit.vision import Board, MarkerSet, read_landmarks
from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.camera.cameras_file import read_cameras
from roverkit.vision.markers.boards import read_boards
from roverkit.vision.markers.marker_set import square

from roverlink.runtime.core.errors import SetupError

_LANDMARKS = """
frame: arena
survey: {position: 0.02, rotation: 1}
landmarks:
  7: {position: [1.0, 2.0, 0.5], rpy: [90, 0, -90]}
  gate: {position: [4, 0, 1], orientation: [0, 0, 0.70710678, 0.70710678], survey: {position: 0.03}}
"""
_BOARDS = """\
boards:
  gate:
    side: 0.1
    markers:
      20: {position: [-0.2, 0, 0], rpy: [0, 0, 0]}
      21: {position: [0.2, 0, 0], rpy: [0, 0, 90], side: 0.2}
"""
_CAMERAS = """
cameras:
  front:
    source: topic:/camera/image_raw
    mount: {position: [0.3, 0, 0.45], rpy: [0, 90, 0]}
  left:
    source: 2
    parameters: left.yml
    frame: left_optical
    mount: {position: [0, 0.25, 0.5], rpy: [0, 0, 90]}
  film:
    source: drive.mp4
"""
_TYPES = {"OBJECT_UNKNOWN": 0, "OBJECT_ROCK": 1, "OBJECT_MAIN_SWITCH": 3, "OBJECT_SWITCH": 5}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """The file."""
    return tmp_path / "written.yaml"


def test_landmarks_have_poses_and_sigmas(path: Path) -> None:
    """Angles are degrees about fixed axes or a quaternion; a landmark's own survey goes before the field's."""
    path.write_text(_LANDMARKS)
    found = read_landmarks(path)
    assert (found.frame, list(found.places)) == ("arena", [7, "gate"])
    facing_back, gate = (one.pose for one in found.places.values())
    assert facing_back.translation == pytest.approx([1, 2, 0.5])
    assert facing_back.rotation @ [0, 0, 1] == pytest.approx([-1, 0, 0], abs=1e-12)  # out of the print is -x
    assert facing_back.rotation @ [0, 1, 0] == pytest.approx([0, 0, 1], abs=1e-12)  # up the print is up
    assert gate.rotation @ [1, 0, 0] == pytest.approx([0, 1, 0], abs=1e-7)
    assert (found.places[7].position_sigma, found.places["gate"].position_sigma) == (0.02, 0.03)
    assert found.places["gate"].rotation_sigma == pytest.approx(np.radians(1))


def test_the_corners_are_where_the_file_says(path: Path) -> None:
    """A marker's centre is at its position, its axes are turned, and its side is its own or the board's."""
    path.write_text(_BOARDS)
    (gate,) = read_boards(path)
    assert gate.name == "gate"
    x, y = [-0.25, -0.15, -0.15, -0.25], [0.05, 0.05, -0.05, -0.05]
    assert gate.corners[20] == pytest.approx(np.column_stack([x, y, np.zeros(4)]))
    # turned left by a quarter, the upper left corner is the lower left one
    assert gate.corners[21] == pytest.approx(np.array([[0.1, -0.1, 0], [0.1, 0.1, 0], [0.3, 0.1, 0], [0.3, -0.1, 0]]))
    markers = MarkerSet(boards=(gate,))
    assert [markers.is_target(one) for one in ("gate", 20, 7, "wall", 250)] == [True, False, True, False, False]
    assert [markers.target(number) for number in (20, 21, 3)] == ["gate", "gate", 3]
    assert markers.points(21) == pytest.approx(gate.corners[21])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: MarkerSet(dictionary="DICT_5X5_205"), "DICT_5X5_250"),
        (lambda: MarkerSet(sides={250: 0.1}), "0 to 249"),
        (lambda: MarkerSet(sides={3: -1.0}), "positive"),
        (lambda: Board("gate", {}), "no markers"),
        (lambda: Board("gate", {1: square(0.1) * [1, 2, 1]}), "do not form a square"),
        (lambda: MarkerSet(boards=(Board("a", {1: square(0.1)}), Board("b", {1: square(0.1)}))), "'a' and 'b'"),
        (lambda: MarkerSet(side=None).points(3), "marker 3"),
    ],
)
def test_markers_that_cannot_be_are_refused(make: Callable[[], object], words: str) -> None:
    """The message names the number, the board or the nearest dictionary."""
    with pytest.raises(SetupError, match=words):
        make()


def test_cameras_are_read_from_a_file(path: Path) -> None:
    """Mounts turn body axes to optical ones; files are beside the file; settings have the names of the options."""
    path.write_text(_CAMERAS + "    format: MJPG\n    size: [640, 480]\n    latency: 0.03\n")
    (path.parent / "drive.mp4").touch()
    front, left, film = read_cameras(path)
    assert (front.name, front.source, front.parameters, front.frame) == ("front", "topic:/camera/image_raw", None, "")
    assert (left.source, left.parameters, left.frame) == ("2", path.parent / "left.yml", "left_optical")
    assert (film.source, film.mount) == (str(path.parent / "drive.mp4"), None)
    assert film.settings == CameraSettings(size=(640, 480), format="MJPG", latency=0.03)
    assert front.mount
    assert left.mount
    ahead = np.array([0.0, 0, 1])
    assert front.mount.apply(ahead) == pytest.approx([0.3, 0, -0.55])  # it looks down
    assert left.mount.apply(ahead) == pytest.approx([0, 1.25, 0.5])  # it looks to the left
    assert left.mount.apply(np.array([0.0, 1, 0])) == pytest.approx([0, 0.25, -0.5])  # y is down in the image


def test_a_class_has_the_type_of_its_name() -> None:
    """However it is written; without a type it is unknown, which is told once, with what to do."""
    said: list[str] = []
    types = ObjectTypes(ClassesFile(), _TYPES, (), said.append)
    names = ("rock", "Rock", "OBJECT_ROCK", "main switch", "main-switch", "main_switch")
    assert [types.of(name) for name in names] == [1, 1, 1, 3, 3, 3]
    assert [types.of(name) for name in ("dog", "dog", "cat", "rock")] == [0, 0, 0, 1]
    told = "objects of the class {!r} are sent as unknown; add a line to the types in --classes FILE"
    assert said == [told.format(name) for name in ("dog", "cat")]


@pytest.mark.parametrize("names", ["[stone, e-stop]", "{0: stone, 1: e-stop}"])
def test_the_file_names_classes_and_types(path: Path, names: str) -> None:
    """Names as a list, or as in the data.yaml of a YOLO data set."""
    path.write_text(f"names: {names}\ntypes: {{stone: OBJECT_ROCK, e-stop: OBJECT_MAIN_SWITCH}}\n")
    file = read_classes(path)
    assert file.names == ("stone", "e-stop")
    types = ObjectTypes(file, _TYPES, file.names, pytest.fail)
    assert [types.of(name) for name in file.names] == [1, 3]


def _read_classes(path: Path) -> None:
    ObjectTypes(read_classes(path), _TYPES, ("rock",), pytest.fail)


def _places(start: str) -> str:
    return "landmarks: {7: {" + start + "}}"


_POSE = "position: [0, 0, 0], rpy: [0, 0, 0]"
_MISTAKES = {
    read_landmarks: [
        ("landmarks: [", r":1:13: not valid YAML"),
        ("", r":1:1: the file is not a mapping"),
        ("[" * 1000, "nested too deeply"),
        ("frame: field", "no landmarks found"),
        ("frame: a\nlandmark: {}", r":2:1: the file has an unknown key .*did you mean 'landmarks'"),
        ("frame: 3\nlandmarks: {7: {}}", r":1:8: .* is 3; it must be a name"),
        ("frame: 2026-02-30\nlandmarks: {7: {}}", r":1:8: the file: frame: 2026-02-30 is not a valid value"),
        ("landmarks: {[7]: {" + _POSE + "}}", r":1:13: a key is a list of 1; it must be a name"),
        ("landmarks:\n  7: {}\n  8: {}\n  7: {}", r":4:3: the key 7 occurs twice"),
        ("landmarks: {<<: 3}", r":1:17: not valid YAML: expected a mapping"),
        (_places("<<: {side: 1}"), r":1:22: landmark 7 has an unknown key 'side'"),
        (_places("rpy: [0, 0, 0]"), r":1:16: landmark 7 has no position"),
        (_places("position: [0, 0, 0]"), "either rpy or orientation"),
        (_places("position: [0, 0], rpy: [0, 0, 0]"), r":1:27: landmark 7: position is .* list of 3 numbers"),
        (_places("position: [0, 0, .nan], rpy: [0, 0, 0]"), r":1:34: .* is .nan; it must be a finite number"),
        (_places("position: [0, 0, 1.0e+300], rpy: [0, 0, 0]"), r":1:34: .* is 1.0e\+300; that is too large"),
        (_places("position: [0, 0, 0], orientation: [0, 0, 1, 1]"), "length"),
        (_places(_POSE + ", survey: {position: -1}"), "standard deviation"),
    ],
    read_boards: [
        ("gates: {}", "unknown key 'gates'; known: boards"),
        ("boards: {7: {}}", "board 7: the name of a board must not be a number"),
        ("boards: {gate: {}}", r":1:16: board gate has no markers"),
        ("boards: {gate: {markers: {a: {}}}}", "board gate: 'a' is not the number of a marker"),
        (_BOARDS.replace("    side: 0.1\n", ""), r":4:11: board gate: marker 20 has no side, and the board"),
        (_BOARDS.replace("position: [0.2, 0, 0], ", ""), r":6:11: board gate: marker 21 has no position"),
        (_BOARDS.replace("0.1", "1.0e-200"), r":3:5: board 'gate': the corners of marker 20 do not form a square"),
    ],
    read_cameras: [
        ("x: 1", r"the file has an unknown key 'x'; known: cameras"),
        (_CAMERAS.replace("source: 2", "sauce: 2"), r":7:5: camera left has an unknown key 'sauce'; did you mean 'so"),
        (_CAMERAS.replace("    source: 2\n", ""), r":7:5: camera left has no source; add"),
        (_CAMERAS.replace("  left:", "  Left one:"), r"the camera's name is 'Left one'; .* letters a-z"),
        ("cameras:\n  arm: {source: 2, exposure: slow}", r":2:30: camera arm: exposure is slow; it must be a number"),
        ("cameras:\n  arm: {source: 2, exposure: 0}", r":2:8: camera arm: the exposure 0 is not possible"),
        (
            "cameras:\n  arm: {source: 2, format: mjpg2}",
            r":2:8: camera arm: .mjpg2. is no pixel format; use a FOURCC code",
        ),
        (
            "cameras: {a: {source: 'topic:/a', parameters: a, camera_info: /b}}",
            "has 'parameters' and 'camera_info'; re",
        ),
    ],
    _read_classes: [
        ("typs: {}", ":1:1: the file has an unknown key 'typs'; did you mean 'types'"),
        ("names: stone", ":1:8: names is not a list of different names"),
        ("names: {1: a}", ":1:8: the keys of names are not 0, 1, 2 and so on"),
        ("types:\n  rock: OBJECT_ROK", ":2:9: type of rock is OBJECT_ROK; did you mean 'OBJECT_ROCK'"),
        ("types:\n  rok: OBJECT_ROCK", ":2:8: the detector has no class 'rok'; did you mean 'rock'"),
    ],
}


@pytest.mark.parametrize(
    ("read", "text", "words"), [(read, *one) for read, mistakes in _MISTAKES.items() for one in mistakes]
)
def test_mistakes_are_told_with_their_place(path: Path, read: Callable[[Path], object], text: str, words: str) -> None:
    """The message says where and what; nothing is taken for something else or left out in silence."""
    path.write_text(text)
    with pytest.raises(SetupError, match=words) as raised:
        read(path)
    assert str(raised.value).startswith(f"{path}:")
