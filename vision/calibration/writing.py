"""Writes a calibration to the file of the camera's parameters."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path

import numpy as np

from roverlink.vision.calibration.solution import Calibration
from roverlink.vision.camera.parameters_file import Fact, write_parameters


def write_calibration(path: Path, calibration: Calibration) -> None:
    """Write the camera, and beside it what is known of its accuracy, whole or not at all.

    Under `reprojection_error_rms` in pixels, `standard_deviations` of fx fy cx cy and the distortion's coefficients,
    `views` and `corners` that it rests on, and `data_date`, the day (UTC) of the newest view where that is known.
    Raises `SetupError` where the file cannot be written.
    """
    used = [one for one in calibration.views if not one.dropped]
    facts: dict[str, Fact] = {
        "reprojection_error_rms": calibration.rms,
        "standard_deviations": calibration.deviations.reshape(1, -1),
        "views": len(used),
        "corners": int(np.sum([one.used.sum() for one in used])),
    }
    if newest := max(one.view.stamp_ns for one in used):
        facts["data_date"] = datetime.fromtimestamp(newest / 1e9, timezone.utc).strftime("%Y-%m-%d")
    write_parameters(path, calibration.camera, facts)
