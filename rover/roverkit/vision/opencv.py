"""Import of OpenCV. Only this module imports it; if that fails, the error says how to install OpenCV.

The module object has the type Any, because OpenCV's type stubs differ between versions.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
from typing import Any

from roverlink.runtime.core.errors import SetupError

OLDEST = (4, 8)

_INSTALL = "install it with `pip install 'opencv-contrib-python-headless>=4.8'`"
_OTHER_NUMPY = "numpy.core.multiarray failed to import"
"""Text of the error if OpenCV was built for NumPy 1, and NumPy 2 is installed. OpenCV before 4.10 was."""

_QUIET = {"OPENCV_LOG_LEVEL": "SILENT", "OPENCV_FFMPEG_LOGLEVEL": "-8"}
"""Environment variables that OpenCV reads at import. They silence messages of OpenCV and FFmpeg about missing cameras.

A variable that the user has set keeps its value, so the user can make the messages visible.
"""


def _load() -> Any:
    for name, level in _QUIET.items():
        # setdefault keeps a value that the user has set.
        os.environ.setdefault(name, level)
    try:
        with contextlib.redirect_stderr(io.StringIO()):  # NumPy prints a page about modules for an older NumPy
            module: Any = importlib.import_module("cv2")
        version = tuple(int(part) for part in module.__version__.split(".")[:2])
    except (ImportError, AttributeError) as error:
        if _OTHER_NUMPY in str(error):
            cure = "install an older NumPy with `pip install 'numpy<2'`, or a newer OpenCV"
            raise SetupError(f"the installed OpenCV was built for NumPy 1; {cure}") from error
        raise SetupError(f"the camera programs need OpenCV ({error}); {_INSTALL}") from error
    if version < OLDEST:
        raise SetupError(
            f"the camera programs need OpenCV {'.'.join(map(str, OLDEST))} or newer, but {module.__version__} is "
            "installed; upgrade it with `pip install --upgrade 'opencv-contrib-python-headless>=4.8'`"
        )
    if not hasattr(module, "aruco"):  # a part of the module objdetect, which a build of one's own can leave out
        raise SetupError(f"OpenCV {module.__version__} was built without its module objdetect; {_INSTALL}")
    return module


cv2: Any = _load()
