"""A camera is calibrated on the page, by somebody who moves a board and somebody who clicks."""

from __future__ import annotations

import json
import re
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from needs import NO_OPENCV
from polling import wait_until
from programs import Start

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)

from bench.vision.browser import PATIENCE_S  # noqa: E402  # below what skips where it is not needed
from bench.vision.moving_board import LENS, pictures  # noqa: E402
from tests.vision.browsing import visiting  # noqa: E402
from tests.vision.webcam import Webcam  # noqa: E402

pytestmark = pytest.mark.slow

POSES = 16
FRAMES, FRAME_S = 6, 0.1
"""For how many frames the board is held still, and how long each is."""


@pytest.fixture(scope="module")
def jpegs() -> list[bytes]:
    """What a camera sees while a board is moved."""
    return [cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, 97])[1].tobytes() for grey in pictures(POSES)]


@pytest.fixture
def webcam(jpegs: list[bytes]) -> Iterator[Webcam]:
    """That camera, and the board is moved again and again from the beginning."""
    camera = Webcam([jpeg for jpeg in jpegs for _ in range(FRAMES)], pause_s=FRAME_S)
    yield camera
    camera.close()


class _Page:
    """A command with a page, without a browser."""

    def __init__(self, start: Start, folder: Path, *arguments: object) -> None:
        self.program = start("aruco", "calibrate", *arguments, "--page", "--page-port", 0, folder=folder)
        address = re.search(r"http://127\.0\.0\.1:\d+/", self.program.wait_for("in a web browser"))
        assert address
        self.url = address[0]

    def state(self) -> dict[str, Any]:
        with urllib.request.urlopen(f"{self.url}state") as answer:
            state: dict[str, Any] = json.load(answer)
            return state

    def until(self, wanted: Callable[[dict[str, Any]], Any]) -> None:
        wait_until(lambda: wanted(self.state()), "the page", PATIENCE_S)

    def click(self, path: str) -> None:
        headers = {"Origin": self.url.rstrip("/")}
        with urllib.request.urlopen(urllib.request.Request(f"{self.url}{path}", method="POST", headers=headers)):
            pass


def test_a_camera_is_calibrated_by_clicking(start: Start, webcam: Webcam, tmp_path: Path) -> None:
    """Views are taken by themselves, too few are refused, one is dropped, the rest give the camera and the report."""
    page = _Page(start, tmp_path, f"http://{webcam.address}/video")
    with visiting() as visitor:
        visitor.open(page.url)
        visitor.until(lambda: visitor.count("#views li") >= 2)
        visitor.until(lambda: visitor.run("return document.getElementById('picture').naturalWidth") == 640)
        visitor.click("#calibrate")
        visitor.until(lambda: "10 are needed" in visitor.text("#refused"))

        visitor.until(lambda: visitor.count("#views li") >= 14)
        visitor.click("#views li:nth-child(3) button")
        visitor.until(lambda: "View 3\n" not in visitor.text("#views"))
        visitor.click("#calibrate")
        visitor.until(lambda: visitor.shown("#result"))
        assert visitor.text("#numbers").startswith("fx ")
        assert "error 0." in visitor.text("#views")
        assert not (tmp_path / "charuco_camera_params.yml").exists()

        visitor.click("#save")
        visitor.until(lambda: "Saved" in visitor.text("#status"))
        assert page.program.end() == 0
        assert visitor.complaints() == []
    saved = cv2.FileStorage(str(tmp_path / "charuco_camera_params.yml"), cv2.FILE_STORAGE_READ)
    assert saved.getNode("camera_matrix").mat() == pytest.approx(LENS.matrix, rel=3e-3)
    assert "<h2>Uncertainty</h2>" in (tmp_path / "charuco_camera_params.html").read_text(encoding="utf-8")


def test_a_folder_of_images_is_looked_through_on_the_page(start: Start, jpegs: list[bytes], tmp_path: Path) -> None:
    """Every image is a view by its name; when they are over, views are dropped and the rest is calibrated."""
    folder = tmp_path / "images"
    folder.mkdir()
    for number, jpeg in enumerate(jpegs):
        (folder / f"{number}.jpg").write_bytes(jpeg)
    page = _Page(start, tmp_path, folder, "--json", "--out", "cam.yml")
    page.until(lambda state: "ended" in state["note"])
    assert [view["lines"][0] for view in page.state()["views"]] == [f"{number}.jpg" for number in range(len(jpegs))]
    page.click("views/2/drop")
    page.click("calibrate")
    page.until(lambda state: state["result"])
    page.click("save")
    assert page.program.end() == 0
    said = json.loads(page.program.output[-1])
    assert said["file"] == "cam.yml"
    assert [view["name"] for view in said["views"]] == ["0.jpg", *(f"{number}.jpg" for number in range(2, len(jpegs)))]
    assert "12.jpg" in (tmp_path / "cam.html").read_text(encoding="utf-8")


def test_a_camera_that_has_gone_does_not_hold_up_the_clicks(start: Start, jpegs: list[bytes], tmp_path: Path) -> None:
    """What was seen before is calibrated and saved, and the command ends."""
    webcam = Webcam([jpeg for jpeg in jpegs for _ in range(FRAMES)], pause_s=FRAME_S)
    page = _Page(start, tmp_path, f"http://{webcam.address}/video")
    page.until(lambda state: len(state["views"]) >= 12)
    webcam.close()
    page.program.wait_for("trying again")
    page.click("calibrate")
    page.until(lambda state: state["result"])
    page.click("save")
    assert page.program.end() == 0
    assert (tmp_path / "charuco_camera_params.yml").exists()


def test_a_folder_without_a_readable_image_ends_it(start: Start, tmp_path: Path) -> None:
    """With its name, and exit code 2; nothing is written."""
    folder = tmp_path / "images"
    folder.mkdir()
    (folder / "0.jpg").write_bytes(b"no image")
    (folder / "1.jpg").write_bytes(b"no image")
    page = _Page(start, tmp_path, folder)
    assert page.program.end() == 2
    assert "cannot read any of its 2 files as an image" in str(page.program)
    assert list(tmp_path.glob("charuco*")) == []


def test_an_interruption_writes_nothing(start: Start, webcam: Webcam, tmp_path: Path) -> None:
    """It ends at once, though the camera goes on and a browser waits."""
    page = _Page(start, tmp_path, f"http://{webcam.address}/video")
    page.until(lambda state: state["views"])
    assert page.program.interrupt() == 1
    assert "nothing was saved" in str(page.program)
    assert list(tmp_path.glob("charuco*")) == []
