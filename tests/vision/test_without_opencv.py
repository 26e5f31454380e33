"""What somebody reads who has not installed OpenCV, or has an OpenCV that pip knows nothing about."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from needs import NO_OPENCV

ROOT = Path(__file__).parents[2]
_CURE = "pip install 'opencv-contrib-python-headless>=4.8'"
_IMPORT = """
from roverlink.runtime.core.errors import SetupError
try:
    import roverlink.vision
except SetupError as error:
    print(error)
"""
_OLD_NUMPY = """
import sys; print('A module that was compiled using NumPy 1.x', file=sys.stderr)
raise ImportError('numpy.core.multiarray failed to import')
"""


def _python(program: str, *options: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *options, "-c", program]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def _main(words: list[str], missing: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the command line in a Python that lacks a package."""
    start = f"import sys; sys.modules[{missing!r}] = None\nfrom roverlink.__main__ import main\n"
    return _python(f"{start}sys.exit(main({words}))", folder=folder)


@pytest.mark.parametrize(
    ("module", "told"),
    [
        ("raise ImportError", _CURE),
        ("__version__ = '4.7.0'; aruco = None", "need OpenCV 4.8 or newer, but 4.7.0 is installed"),
        ("__version__ = '4.8.1'", "OpenCV 4.8.1 was built without its module objdetect"),
        (_OLD_NUMPY, "the installed OpenCV was built for NumPy 1; install an older NumPy with `pip install 'numpy<2'`"),
    ],
)
def test_an_opencv_that_does_not_fit_is_told_so(module: str, told: str, tmp_path: Path) -> None:
    """It is refused in one line that says why, and not by an AttributeError later."""
    (tmp_path / "cv2.py").write_text(module)
    done = _python(f"import sys; sys.path.insert(0, {str(tmp_path)!r}){_IMPORT}")
    assert (told in done.stdout, done.stderr) == (True, "")


@pytest.mark.parametrize(
    ("command", "missing", "told"),
    [
        ("aruco track 0", "cv2", _CURE),
        ("aruco track 0", "numpy", _CURE),
        pytest.param("aruco calibrate 0", "cv2", _CURE, marks=pytest.mark.slow),
        pytest.param("aruco board --out board.pdf", "cv2", _CURE, marks=pytest.mark.slow),
        ("video send 0", "av", "pip install 'av>=12'"),
        ("video receive", "av", "pip install 'av>=12'"),
    ],
)
def test_commands_say_what_they_need(command: str, missing: str, told: str, tmp_path: Path) -> None:
    """A command names the extra that it needs, with exit code 2; its help is there all the same."""
    if missing == "av":
        pytest.importorskip("cv2", reason=NO_OPENCV)
    done = _main(command.split(), missing, tmp_path)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert told in done.stderr
    group, name, *_ = command.split()
    helped = _main([group, name, "--help"], missing, tmp_path)
    assert (helped.returncode, helped.stderr) == (0, "")
    assert f"usage: roverlink {group}" in helped.stdout


@pytest.mark.slow
@pytest.mark.parametrize("missing", ["cv2", "numpy", "av"])
def test_the_demo_does_without_a_camera_or_video(missing: str) -> None:
    """It shows the rest, a rover that drives among it, and says how to get what is missing."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    done = _main(["demo", "--seconds", "1", "--middleware", "memory"], missing, ROOT)
    assert done.returncode == 0, done.stderr
    without = (
        ["video: video needs PyAV"] if missing == "av" else ["a camera that sees objects", "a camera on the rover"]
    )
    for part in without:
        assert f"running without {part}" in done.stdout
    if missing != "av":
        assert _CURE in done.stdout
        assert "the rover drove" in done.stdout
    assert "21 of 21 messages were bridged" in done.stdout


@pytest.mark.slow
def test_an_opencv_of_the_system_is_enough(tmp_path: Path) -> None:
    """Every camera command runs with a cv2 that no package of pip's brought, such as JetPack's."""
    cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
    from tests.vision.board_frames import frames

    for entry in Path(cv2.__file__).parents[1].iterdir():
        if not (entry.name.startswith("opencv") and entry.name.endswith(".dist-info")):
            (tmp_path / entry.name).symlink_to(entry)
    out = tmp_path / "out"
    out.mkdir()
    for image, view in enumerate(frames(10)):
        cv2.imwrite(str(out / f"{image}.png"), view)
    program = (
        f"import sys; sys.path[:0] = [{str(ROOT)!r}, {str(tmp_path)!r}]\n"
        "from importlib.metadata import distributions\n"
        "from roverlink.__main__ import main\n"
        "assert not [one for one in distributions() if one.name.startswith('opencv')]\n"
    )
    drive, parameters = (ROOT / "docs" / "vision" / name for name in ("drive.mp4", "camera.yml"))
    for words in (
        ["board", "--out", out / "board.pdf"],
        ["track", drive, "--parameters", parameters, "--json", "--count", 1],
        ["calibrate", out, "--out", out / "camera.yml"],
    ):
        done = _python(f"{program}sys.exit(main({['aruco', *map(str, words)]}))", "-S")
        assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stderr
    assert f"OpenCV {cv2.__version__}" in (out / "camera.html").read_text()
