"""What the tests of the camera programs share. Without OpenCV they are skipped."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path

import pytest
from needs import NO_OPENCV

WITHOUT_OPENCV = {"test_without_opencv.py"}


class _Skipped(pytest.Module):
    def collect(self) -> Iterator[pytest.Item | pytest.Collector]:
        pytest.skip(NO_OPENCV, allow_module_level=True)


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Module | None:
    """Skip what would import OpenCV."""
    if importlib.util.find_spec("cv2") or module_path.name in WITHOUT_OPENCV:
        return None
    return _Skipped.from_parent(parent, path=module_path)
