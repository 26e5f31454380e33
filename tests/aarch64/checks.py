"""Checks that `make test-aarch64` runs on aarch64, with roverlink and roverkit from their wheels and without sources.

Only the standard library of Debian's Python is there when this script starts.
"""

from __future__ import annotations

import json
import math
import os
import platform
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

_SOURCES = Path("/src")
_PROJECT = Path("/rover")
_ENVIRONMENT = Path("/venv")
_TOLERANCE_M = 0.02
_CIRCLE_M, _HEIGHT_M, _FRAMES = 0.3, 0.6, 16
"""Path of the camera in rover/docs/vision/drive.mp4: a circle around the origin of the field, once in all frames."""


def main() -> int:
    """Run the checks in order. Returns 1 at the first one that fails."""
    print(f"== {platform.machine()}, Python {platform.python_version()}")
    for check in (install, copy_project, generate, lint, compare_native_core, bridge, track, compile_cpp_handlers):
        if not _passes(check):
            return 1
    return 0


def _passes(check: Callable[[], None]) -> bool:
    start = time.monotonic()
    try:
        check()
    except (subprocess.CalledProcessError, AssertionError) as error:
        print(f"== {check.__name__} failed: {error}", file=sys.stderr)
        return False
    print(f"== {check.__name__}: passed in {time.monotonic() - start:.0f} s")
    return True


def install() -> None:
    """Install the wheels of roverlink and roverkit from `make dist` with their dependencies for aarch64."""
    if not _ENVIRONMENT.exists():
        _run(sys.executable, "-m", "venv", _ENVIRONMENT)
    pip = (_ENVIRONMENT / "bin" / "python", "-m", "pip", "--quiet", "--disable-pip-version-check")
    (roverlink,), (roverkit,) = (
        _SOURCES.glob(f"dist/{name}") for name in ("roverlink-*_aarch64.whl", "roverkit-*.whl")
    )
    # pip would keep an earlier build of the same version.
    _run(*pip, "-qq", "uninstall", "--yes", "roverlink", "roverkit")
    _run(*pip, "install", f"{roverlink}[standard,record]", f"{roverkit}[vision]", "hypothesis", "pytest")


def copy_project() -> None:
    """Copy the sample rover, without the sources, so that nothing but the wheels can be imported."""
    shutil.rmtree(_PROJECT, ignore_errors=True)
    for name in ("proto", "generated", "docs", "rover/docs", "tests"):
        shutil.copytree(_SOURCES / name, _PROJECT / name)
    for name in ("mapping.yaml", "mapping.lock"):
        shutil.copy(_SOURCES / name, _PROJECT / name)


def generate() -> None:
    """Compare what the generator writes on aarch64 with the committed files."""
    _roverlink("generate", "--check")


def lint() -> None:
    """Lint the table and the protos."""
    _roverlink("lint")


def compare_native_core() -> None:
    """Compare the native core of the wheel with the Python handlers, on random messages of all rows."""
    python = _ENVIRONMENT / "bin" / "python"
    _run(python, "-c", "from roverlink.runtime.native.core import LIBRARY, load_library; load_library(LIBRARY)")
    assert _run(python, "tests/generator/crosscheck.py", capture=True, given=f"40 {_PROJECT}\n") == "0\n"


def bridge() -> None:
    """Bridge every message in memory; the demo fails if a message does not cross."""
    _roverlink("demo", "--middleware", "memory")


def track() -> None:
    """Compare the camera's positions in the recorded drive with the true ones."""
    parameters = ("--parameters", "rover/docs/vision/camera.yml", "--landmarks", "rover/docs/vision/landmarks.yaml")
    options = (*parameters, "--side", "0.15", "--json", "--ros-args", "--disable-stdout-logs")
    frames = _roverlink("aruco", "track", "rover/docs/vision/drive.mp4", *options, capture=True).splitlines()
    assert len(frames) == _FRAMES, f"{len(frames)} of {_FRAMES} frames"
    for number, frame in enumerate(frames):
        angle = 2 * math.pi * number / _FRAMES
        true = (_CIRCLE_M * math.sin(angle), _CIRCLE_M * math.cos(angle), _HEIGHT_M)
        found = json.loads(frame)["camera"]["position"]
        assert math.dist(found, true) < _TOLERANCE_M, f"frame {number}: the camera is at {true}, not at {found}"


def compile_cpp_handlers() -> None:
    """Compile the table's C++ handlers and compare their answers with those of the Python handlers."""
    _run(_ENVIRONMENT / "bin" / "python", "tests/ros/cpp/crosscheck.py", "mapping.yaml")


def _roverlink(*arguments: str, capture: bool = False) -> str:
    return _run(_ENVIRONMENT / "bin" / "roverlink", *arguments, capture=capture)


def _run(*command: str | os.PathLike[str], capture: bool = False, given: str = "") -> str:
    """Run a command with an input in the project's copy; return its output if ``capture`` is true."""
    folder = _PROJECT if _PROJECT.exists() else _SOURCES
    output = subprocess.PIPE if capture else None
    return subprocess.run(command, cwd=folder, check=True, input=given, stdout=output, text=True).stdout


if __name__ == "__main__":
    sys.exit(main())
