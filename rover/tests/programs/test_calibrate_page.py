"""A camera is calibrated on the page, by somebody who moves a board and somebody who clicks."""

from __future__ import annotations

import re
from contextlib import closing
from pathlib import Path

import pytest
from needs import NO_OPENCV
from programs import Start

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)

from rover.bench.vision.moving_board import LENS, pictures  # noqa: E402
from rover.tests.vision.browsing import visiting  # noqa: E402
from rover.tests.vision.webcam import Webcam  # noqa: E402

pytestmark = pytest.mark.slow

POSES, TOO_FEW = 16, 5
FRAMES, FRAME_S = 6, 0.1
"""For how many frames the board is held still, and how long each is."""


def test_a_camera_is_calibrated_by_clicking(start: Start, tmp_path: Path) -> None:
    """Views are taken by themselves, too few are refused, one is dropped, the rest give the camera and the report."""
    jpegs = [cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, 97])[1].tobytes() for grey in pictures(POSES)]
    held = [jpeg for jpeg in jpegs for _ in range(FRAMES)]
    webcam = Webcam(held[: TOO_FEW * FRAMES], pause_s=FRAME_S)
    camera = ("aruco", "calibrate", f"http://{webcam.address}/video")
    program = start(*camera, "--page", "--page-port", 0, folder=tmp_path)
    address = re.search(r"http://127\.0\.0\.1:\d+/", program.wait_for("in a web browser"))
    assert address
    with closing(webcam), visiting() as visitor:
        visitor.open(address[0])
        visitor.until(lambda: visitor.count("#views li") >= 2)
        visitor.until(lambda: visitor.run("return document.getElementById('picture').naturalWidth") == 640)
        visitor.click("#calibrate")
        visitor.until(lambda: "10 are needed" in visitor.text("#refused"))

        webcam.pictures = held
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
        assert program.end() == 0
        assert visitor.complaints() == []
    saved = cv2.FileStorage(str(tmp_path / "charuco_camera_params.yml"), cv2.FILE_STORAGE_READ)
    assert saved.getNode("camera_matrix").mat() == pytest.approx(LENS.matrix, rel=3e-3)
    assert "<h2>Uncertainty</h2>" in (tmp_path / "charuco_camera_params.html").read_text(encoding="utf-8")
