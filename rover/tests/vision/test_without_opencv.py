"""What somebody reads who has not installed OpenCV, or has an OpenCV that pip knows nothing about."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from needs import NO_OPENCV

ROOT = Path(__file__).parents[3]
_CURE = "pip install 'opencv-contrib-python-headless>=4.8'"
_IMPORT = """
from roverlink.runtime.core.errors import SetupError
try:
    import roverkit.vision
except SetupError as error:
    print(error)
"""
_OLD_NUMPY = """
import sys; print('A module that was compiled using NumPy 1.x', file=sys.stderr)
raise ImportError('numpy.core.multiarray failed to import')
"""


def _python(
    program: str, folder: Path = ROOT, env: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", program]
    return subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)


def _main(words: list[str], missing: str, folder: Path, **completion: str) -> subprocess.CompletedProcess[str]:
    """Run the command line in a Python that lacks some modules."""
    start = f"import sys; sys.modules.update(dict.fromkeys({missing.split()}))\nfrom roverlink.__main__ import main\n"
    return _python(f"{start}sys.exit(main({words}))", folder=folder, env={**os.environ, **completion})


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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "missing", "told"),
    [
        ("aruco track 0", "cv2", _CURE),
        ("aruco track 0", "numpy", _CURE),
        ("video send 0", "av", "pip install 'av>=12'"),
        ("video receive", "av", "pip install 'av>=12'"),
    ],
)
def test_commands_say_what_they_need(command: str, missing: str, told: str, tmp_path: Path) -> None:
    """A command names the extra that it needs, with exit code 2."""
    if missing == "av":
        pytest.importorskip("cv2", reason=NO_OPENCV)
    done = _main(command.split(), missing, tmp_path)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert told in done.stderr


_NO_EXTRA = "numpy cv2 av gtsam onnxruntime scipy jax"
_BROKEN = "aruco           cannot be loaded: import of roverkit.aruco.board_options halted"


@pytest.mark.parametrize(
    ("words", "missing", "code", "told"),
    [
        ("--help", _NO_EXTRA, 0, "aruco           track ArUco markers"),
        ("aruco --help", _NO_EXTRA, 0, "usage: roverlink aruco"),
        pytest.param("aruco track --help", _NO_EXTRA, 0, "usage: roverlink aruco track", marks=pytest.mark.slow),
        pytest.param("video send --help", _NO_EXTRA, 0, "usage: roverlink video send", marks=pytest.mark.slow),
        ("--help", "roverkit.aruco.board_options", 0, _BROKEN),
        ("aruco track 0", "roverkit.aruco.board_options", 2, " ".join(_BROKEN.split())),
    ],
)
def test_the_command_line_needs_no_extra(words: str, missing: str, code: int, told: str, tmp_path: Path) -> None:
    """All commands are listed without the packages of the extras; one whose module is missing says so in one line."""
    done = _main(words.split(), missing, tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (code, int(code > 0))
    assert told in done.stdout + done.stderr


def test_completion_needs_no_extra(tmp_path: Path) -> None:
    """A shell completes the commands below `aruco` without OpenCV and NumPy."""
    asked = {"COMP_LINE": "roverlink aruco tr", "COMP_POINT": "18", "_ARGCOMPLETE": "1", "_ARGCOMPLETE_SHELL": "bash"}
    done = _main([], _NO_EXTRA, tmp_path, **asked, _ARGCOMPLETE_STDOUT_FILENAME=str(tmp_path / "words"))
    assert (done.returncode, done.stderr, (tmp_path / "words").read_text().split()) == (0, "", ["track"])


@pytest.mark.slow
@pytest.mark.parametrize("missing", ["cv2", "numpy"])
def test_the_demo_does_without_a_camera(missing: str) -> None:
    """It shows the rest, a rover that drives among it, and says how to get what is missing."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    done = _main(["demo", "--seconds", "1", "--middleware", "memory"], missing, ROOT)
    assert done.returncode == 0, done.stderr
    for part in ("a camera that sees objects", "a camera on the rover", _CURE, "the rover drove"):
        assert part in done.stdout
    assert "21 of 21 messages bridged" in done.stdout
