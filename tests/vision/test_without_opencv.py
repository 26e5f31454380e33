"""What somebody reads who has not installed OpenCV."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from needs import NO_OPENCV

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("missing", ["cv2", "numpy"])
def test_what_is_missing_is_a_setup_error_with_its_cure(missing: str) -> None:
    """Importing the package names the extra that installs what it needs."""
    program = (
        f"import sys; sys.modules[{missing!r}] = None\n"
        "from roverlink.runtime.core.errors import SetupError\n"
        "try:\n    import roverlink.vision\nexcept SetupError as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert "pip install 'opencv-contrib-python-headless>=4.8'" in done.stdout


@pytest.mark.parametrize(
    ("module", "told"),
    [
        ("__version__ = '4.7.0'; aruco = None", "need OpenCV 4.8 or newer, but 4.7.0 is installed"),
        ("__version__ = '4.8.1'", "OpenCV 4.8.1 was built without its module objdetect"),
        (
            "import sys; print('A module that was compiled using NumPy 1.x', file=sys.stderr)\n"
            "raise ImportError('numpy.core.multiarray failed to import')",
            "the installed OpenCV was built for NumPy 1; install an older NumPy with `pip install 'numpy<2'`",
        ),
    ],
)
def test_an_opencv_that_does_not_fit_is_told_so(module: str, told: str, tmp_path: Path) -> None:
    """It is refused in one line that says why, and not by an AttributeError later."""
    (tmp_path / "cv2.py").write_text(module)
    program = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n"
        "from roverlink.runtime.core.errors import SetupError\n"
        "try:\n    import roverlink.vision\nexcept SetupError as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert (told in done.stdout, done.stderr) == (True, "")


@pytest.mark.parametrize("missing", ["cv2", pytest.param("numpy", marks=pytest.mark.slow)])
@pytest.mark.parametrize("command", ["track 0", "calibrate 0", "board --out board.pdf"])
def test_commands_say_what_they_need(command: str, missing: str, tmp_path: Path) -> None:
    """A camera command names the extra that it needs, with exit code 2; its help is there all the same."""
    told = _main(["aruco", *command.split()], missing, tmp_path)
    assert told.returncode == 2
    assert len(told.stderr.splitlines()) == 1
    assert "pip install 'opencv-contrib-python-headless>=4.8'" in told.stderr
    helped = _main(["aruco", command.split()[0], "--help"], missing, tmp_path)
    assert (helped.returncode, helped.stderr) == (0, "")
    assert "usage: roverlink aruco" in helped.stdout


@pytest.mark.parametrize("command", ["send 0", "receive"])
def test_video_says_what_it_needs(command: str, tmp_path: Path) -> None:
    """PyAV, with exit code 2; the help is there all the same."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    told = _main(["video", *command.split()], "av", tmp_path)
    assert told.returncode == 2
    assert len(told.stderr.splitlines()) == 1
    assert "video needs PyAV" in told.stderr
    assert "pip install 'av>=12'" in told.stderr
    helped = _main(["video", command.split()[0], "--help"], "av", tmp_path)
    assert (helped.returncode, helped.stderr) == (0, "")


def _main(words: list[str], missing: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the command line in a Python that lacks a package."""
    program = (
        f"import sys; sys.modules[{missing!r}] = None\nfrom roverlink.__main__ import main\nsys.exit(main({words}))\n"
    )
    return subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_the_demo_does_without_video() -> None:
    """It shows the rest, and says how to get the page."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    done = _main(["demo", "--seconds", "1", "--middleware", "memory"], "av", ROOT)
    assert done.returncode == 0, done.stderr
    assert "running without video: video needs PyAV" in done.stdout
    assert "21 of 21 messages were bridged" in done.stdout


@pytest.mark.parametrize("missing", ["cv2", "numpy"])
@pytest.mark.slow
def test_the_demo_does_without_a_camera(missing: str) -> None:
    """It shows the rest, a rover that drives among it, and says how to get the cameras."""
    done = _main(["demo", "--seconds", "1", "--middleware", "memory"], missing, ROOT)
    assert done.returncode == 0, done.stderr
    for camera in ("a camera that sees objects", "a camera on the rover"):
        assert f"running without {camera}: " in done.stdout
    assert "the rover drove" in done.stdout
    assert "pip install 'opencv-contrib-python-headless>=4.8'" in done.stdout
    assert "21 of 21 messages were bridged" in done.stdout
