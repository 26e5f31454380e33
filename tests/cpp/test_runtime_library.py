"""The C++ runtime library, built with CMake and tested by ctest."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from needs import NO_ROS

_TESTS = Path(__file__).parents[2] / "cpp" / "tests"
_WANTED = ["/usr/include/google/protobuf/message.h", "/usr/include/gtest/gtest.h"]
_MISSING = [tool for tool in ("cmake", "ctest", "g++") if not shutil.which(tool)]
_MISSING += [path for path in _WANTED if not Path(path).exists()]


@pytest.mark.slow
@pytest.mark.skipif(bool(_MISSING), reason=NO_ROS)
def test_the_cpp_library_passes_its_own_tests(tmp_path: Path) -> None:
    """Configure, compile with all warnings as errors, and run ctest.

    The sources are compiled together, which takes a third of the time; `make ros-package` compiles each alone.
    """
    for command in (
        ["cmake", "-S", _TESTS, "-B", tmp_path, "-DCMAKE_UNITY_BUILD=ON"],
        ["cmake", "--build", tmp_path, "--parallel", "2"],
        ["ctest", "--test-dir", tmp_path, "--output-on-failure", "--no-tests=error"],
    ):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
