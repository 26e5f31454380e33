"""docs/vision.md, followed to the letter; and its pictures, made anew."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import pytest
from needs import NO_OPENCV, needs_dds
from page import ROOT, Reader, blocks

_PAGE = ROOT / "docs" / "vision.md"
_NEEDS_OPENCV = pytest.mark.skipif(not find_spec("cv2"), reason=NO_OPENCV)


@_NEEDS_OPENCV
@pytest.mark.slow
@needs_dds
def test_what_stands_there_happens(tmp_path: Path) -> None:
    """From the recording to JSON, to ROS 2, and to the basestation."""
    with Reader.in_copy(tmp_path) as reader:
        reader.follow(blocks(_PAGE, "Try it"))


@_NEEDS_OPENCV
def test_the_examples_of_files_are_read(tmp_path: Path) -> None:
    """The landmarks, boards and cameras that the page shows are taken as they stand."""
    from roverlink.vision import read_landmarks
    from roverlink.vision.camera.cameras_file import read_cameras
    from roverlink.vision.markers.boards import read_boards

    texts = {block.text.splitlines()[0]: block.text for block in blocks(_PAGE) if block.language == "yaml"}
    for name, text in texts.items():
        (tmp_path / name.removeprefix("# ")).write_text(text, encoding="utf-8")
    assert set(read_landmarks(tmp_path / "landmarks.yaml").places) == {7, "gate"}
    assert [board.name for board in read_boards(tmp_path / "boards.yaml")] == ["gate"]
    assert [camera.name for camera in read_cameras(tmp_path / "cameras.yaml")] == ["front", "left"]


def test_every_topic_of_the_code_stands_there() -> None:
    """The table of the page has those of `roverlink.vision.ros.publishing` and `rover_pose`."""
    code = "".join((ROOT / "vision" / "ros" / name).read_text("utf-8") for name in ("publishing.py", "rover_pose.py"))
    topics = dict(re.findall(r"^\| (\S+) +\| (\w+/\w+)", code, re.MULTILINE))
    page = re.findall(r"^\| `([\w/]+)` \| `(\w+/\w+)`", _PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(topics) == 7
    assert {topic.replace("<name>", "aruco_7"): kind for topic, kind in topics.items()} == dict(page)


@_NEEDS_OPENCV
@pytest.mark.slow
def test_the_pictures_are_what_the_programs_draw(tmp_path: Path) -> None:
    """Made anew, but for another version's letters and rounding, they are the pictures of the page."""
    import cv2
    import numpy as np

    from bench.vision.pictures import main

    pytest.importorskip("matplotlib", reason="need matplotlib (pip install matplotlib)")
    assert main(["--quick", "--out", str(tmp_path)]) == 0
    for path in tmp_path.glob("*.png"):
        new, old = (cv2.imread(str(one)).astype(int) for one in (path, ROOT / "docs" / "vision" / path.name))
        assert new.shape == old.shape, path.name
        assert np.abs(new - old).mean() < 6, path.name
    for name in ("camera.yml", "landmarks.yaml", "cameras.yaml"):
        assert (tmp_path / name).read_bytes() == (ROOT / "docs" / "vision" / name).read_bytes()
