"""What somebody reads who has not installed OpenCV."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("missing", ["cv2", "numpy"])
def test_what_is_missing_is_a_setup_error_with_its_cure(missing: str) -> None:
    """Importing the package names the extra that installs what it needs."""
    program = (
        f"import sys; sys.modules[{missing!r}] = None\n"
        "from runtime.errors import SetupError\n"
        "try:\n    import vision\nexcept SetupError as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert "pip install 'roverlink[vision]'" in done.stdout


def test_an_old_opencv_is_told_so() -> None:
    """A version whose interface differs is refused by number, not by an AttributeError later."""
    program = (
        "import sys, types; old = types.ModuleType('cv2'); old.__version__ = '4.8.1'\n"
        "old.aruco = types.SimpleNamespace(ArucoDetector=None); sys.modules['cv2'] = old\n"
        "from runtime.errors import SetupError\n"
        "try:\n    import vision\nexcept SetupError as error:\n    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    assert "4.8.1 is installed" in done.stdout


@pytest.mark.parametrize(("words", "code"), [(["aruco", "track", "0"], 2), (["aruco", "track", "--help"], 0)])
def test_commands_say_what_they_need(words: list[str], code: int) -> None:
    """A camera command names the extra, with exit code 2; its help is there all the same."""
    program = f"import sys; sys.modules['cv2'] = None\nfrom roverlink.__main__ import main\nsys.exit(main({words}))\n"
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert "pip install 'roverlink[vision]'" in done.stderr if code else "usage: roverlink aruco track" in done.stdout
    assert "Traceback" not in done.stderr


def test_the_demo_does_without_a_camera() -> None:
    """It shows the rest, and says how to get the camera."""
    program = (
        "import sys; sys.modules['cv2'] = None\nfrom roverlink.__main__ import main\n"
        "sys.exit(main(['demo', '--seconds', '1', '--middleware', 'memory']))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "without a camera: " in done.stdout
    assert "pip install 'roverlink[vision]'" in done.stdout
    assert "21 of 21 messages crossed" in done.stdout
