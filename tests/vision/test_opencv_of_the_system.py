"""An OpenCV that the system brought, without the metadata of a package of pip."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import cv2
import pytest

from tests.vision.board_frames import frames

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_an_opencv_of_the_system_is_enough(tmp_path: Path) -> None:
    """Every camera command runs with a cv2 that no package of pip's brought, such as JetPack's."""
    for entry in Path(cv2.__file__).parents[1].iterdir():
        if not (entry.name.startswith("opencv") and entry.name.endswith(".dist-info")):
            (tmp_path / entry.name).symlink_to(entry)
    out, drive = tmp_path / "out", ROOT / "docs" / "vision" / "drive.mp4"
    out.mkdir()
    for image, view in enumerate(frames(10)):
        cv2.imwrite(str(out / f"{image}.png"), view)
    parameters = ["--parameters", ROOT / "docs" / "vision" / "camera.yml"]
    program = (
        f"import sys; sys.path[:0] = [{str(ROOT)!r}, {str(tmp_path)!r}]\n"
        "from importlib.metadata import distributions\n"
        "from roverlink.__main__ import main\n"
        "assert not [one for one in distributions() if one.name.startswith('opencv')]\n"
    )
    for words in (
        ["board", "--out", out / "board.pdf"],
        ["track", drive, *parameters, "--json", "--count", 1],
        ["calibrate", out, "--out", out / "camera.yml"],
    ):
        call = f"{program}sys.exit(main({['aruco', *map(str, words)]}))"
        done = subprocess.run([sys.executable, "-S", "-c", call], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stderr
    assert f"OpenCV {cv2.__version__}" in (out / "camera.html").read_text()
