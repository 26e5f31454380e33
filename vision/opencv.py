"""Import of OpenCV. Only this module imports it; if that fails, the error says how to install OpenCV.

The module object has the type Any, because OpenCV's type stubs differ between versions.
"""

from __future__ import annotations

import importlib
import os
from typing import Any

from roverlink.runtime.core.errors import SetupError

OLDEST = (4, 11)

_QUIET = {"OPENCV_LOG_LEVEL": "SILENT", "OPENCV_FFMPEG_LOGLEVEL": "-8"}
"""Environment variables that OpenCV reads at import. They silence messages of OpenCV and FFmpeg about missing cameras.

A variable that the user has set keeps its value, so the user can make the messages visible.
"""


def _load() -> Any:
    for name, level in _QUIET.items():
        # setdefault keeps a value that the user has set.
        os.environ.setdefault(name, level)
    try:
        module: Any = importlib.import_module("cv2")
        version = tuple(int(part) for part in module.__version__.split(".")[:2])
        module.aruco.ArucoDetector  # noqa: B018  # without contrib, OpenCV has no aruco module before 4.7
    except (ImportError, AttributeError) as error:
        raise SetupError(
            f"the camera programs need OpenCV ({error}); install it with "
            "`pip install 'opencv-contrib-python-headless>=4.11'`"
        ) from error
    if version < OLDEST:
        raise SetupError(
            f"the camera programs need OpenCV {'.'.join(map(str, OLDEST))} or newer, but {module.__version__} is "
            "installed; upgrade it with `pip install --upgrade 'opencv-contrib-python-headless>=4.11'`"
        )
    return module


cv2: Any = _load()
