"""OpenCV, or how to get it: the one place that imports it.

It is imported as a value of any type: its stubs differ from version to version, and so would what they allow.
"""

from __future__ import annotations

import importlib
import os
from typing import Any

from roverlink.runtime.core.errors import SetupError

OLDEST = (4, 11)

_QUIET = {"OPENCV_LOG_LEVEL": "SILENT", "OPENCV_FFMPEG_LOGLEVEL": "-8"}
"""What it and FFmpeg would print of their own of a camera or stream that is not there, by environment variables that
OpenCV reads when it is imported. Who wants to read it sets them."""


def _load() -> Any:
    for name, level in _QUIET.items():
        os.environ.setdefault(name, level)
    try:
        module: Any = importlib.import_module("cv2")
        version = tuple(int(part) for part in module.__version__.split(".")[:2])
        module.aruco.ArucoDetector  # noqa: B018  # an OpenCV without contrib has no aruco before 4.7
    except (ImportError, AttributeError) as error:
        raise SetupError(f"the camera programs need OpenCV ({error}); pip install 'roverlink[vision]'") from error
    if version < OLDEST:
        raise SetupError(
            f"the camera programs need OpenCV {'.'.join(map(str, OLDEST))} or newer, and {module.__version__} is "
            "installed; pip install --upgrade 'roverlink[vision]'"
        )
    return module


cv2: Any = _load()
