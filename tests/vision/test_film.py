"""Films, drawings, and recordings played as if they were taken now."""

from __future__ import annotations

import time
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from roverlink.runtime.core.errors import SetupError
from roverlink.vision import CameraParameters, FieldPose, Pose
from roverlink.vision.camera.camera_settings import CameraSettings
from roverlink.vision.frames import open_source, play
from roverlink.vision.images.drawing import REJECTED, SEEN, draw
from roverlink.vision.images.film import Film
from tests.vision.seen import FACING, sighting

MS = 1_000_000


def _image(grey: int) -> NDArray[np.uint8]:
    return np.full((64, 96, 3), grey, np.uint8)


def _greys(path: Path) -> list[int]:
    capture, found = cv2.VideoCapture(str(path)), []
    while capture.grab():
        found.append(round(float(capture.retrieve()[1].mean()) / 10))
    return found


@pytest.mark.parametrize("name", ["film.mp4", "film.avi"])
def test_a_film_is_as_fast_as_its_images_came(tmp_path: Path, name: str) -> None:
    """Where an image is late the one before stands still, and of two at once one is left out."""
    path = tmp_path / name
    with Film(path, 10) as film:
        for place, stamp in enumerate((0, 100, 400, 410, 500)):
            film.add(_image(40 * place), stamp * MS)
        assert list(tmp_path.glob("film*")) == []
    assert _greys(path) == [0, 4, 8, 8, 8, 16]
    assert [one.name for one in tmp_path.iterdir()] == [name]
    assert cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FPS) == 10


def test_a_long_time_without_images_is_cut_out(tmp_path: Path) -> None:
    """A camera that was away for an hour makes no film of an hour."""
    with Film(tmp_path / "film.avi", 10) as film:
        film.add(_image(0), 0)
        film.add(_image(40), 3_600_000 * MS)
        film.add(_image(80), 3_600_100 * MS)
    greys = _greys(tmp_path / "film.avi")
    assert len(greys) == 22
    assert greys[-1] == 8


def test_a_film_that_cannot_be_is_told(tmp_path: Path) -> None:
    """Its ending, its folder, and a size that changes; nothing is left behind where nothing was written."""
    with pytest.raises(SetupError, match=r"end with \.mp4 or \.avi"):
        Film(tmp_path / "film.gif", 10)
    with pytest.raises(SetupError, match="does not exist"):
        Film(tmp_path / "none" / "film.mp4", 10)
    with Film(tmp_path / "empty.mp4", 10):
        pass
    with Film(tmp_path / "film.avi", 10) as film:
        film.add(_image(0), 0)
        with pytest.raises(SetupError, match="image size changed from"):
            film.add(_image(0)[:32], MS)
    assert [one.name for one in tmp_path.iterdir()] == ["film.avi"]


def test_a_recording_is_played_at_its_pace(tmp_path: Path) -> None:
    """Frames come when they are due, stamped with that time; in a loop the stamps and the numbers go on."""
    for number in range(3):
        cv2.imwrite(str(tmp_path / f"{number}.png"), _image(number))
    began = time.time_ns()
    with open_source(str(tmp_path), CameraSettings(rate=20)) as source:
        frames = [(frame, time.time_ns()) for _, frame in zip(range(7), play(source, loop=True))]
    stamps = [frame.stamp for frame, _ in frames]
    assert np.diff(stamps).tolist() == [50 * MS] * 6
    assert began <= stamps[0] <= began + 500 * MS
    assert all(came >= frame.stamp for frame, came in frames)
    assert [frame.number for frame, _ in frames] == list(range(7))
    assert [int(frame.image[0, 0, 0]) for frame, _ in frames] == [0, 1, 2, 0, 1, 2, 0]


def test_without_a_loop_a_recording_ends(tmp_path: Path) -> None:
    """It is played once."""
    cv2.imwrite(str(tmp_path / "one.png"), _image(0))
    with open_source(str(tmp_path)) as source:
        assert len(list(play(source))) == 1


def test_what_was_seen_is_drawn_where_it_is() -> None:
    """The outline is on the corners, red where the landmark was left out; the image itself stays as it is."""
    camera = CameraParameters(np.array([[900.0, 0, 320], [0, 900, 240], [0, 0, 1]]), np.zeros(5), (640, 480))
    rng = np.random.default_rng(0)
    image = np.full((480, 640, 3), 90, np.uint8)
    one, two = (sighting(number, Pose(FACING, np.array([x, 0.0, 1.5])), rng) for number, x in ((7, -0.3), (8, 0.3)))
    for each in (one, two):
        object.__setattr__(each, "corners", camera.distort(each.corners))
    place = FieldPose("field", Pose(np.eye(3), np.array([1.0, 2.0, 3.0])), np.eye(6), (7,), (8,))
    drawn = draw(image, camera, (one, two), place)
    for each, colour in ((one, SEEN), (two, REJECTED)):
        x, y = np.rint(0.75 * each.corners[0] + 0.25 * each.corners[1]).astype(int)  # the axes are elsewhere
        assert np.abs(drawn[y, x].astype(int) - colour).max() < 30
    assert (image == 90).all()
    assert (drawn[440:] != 90).any()
    assert (drawn[300:400] == 90).all()
