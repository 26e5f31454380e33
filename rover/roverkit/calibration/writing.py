"""Writing of a calibration to a file of camera parameters."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path

import numpy as np

from roverkit.calibration.solution import Calibration
from roverkit.vision.camera.parameters_file import COVARIANCE, DEVIATIONS, Fact, write_parameters


def write_calibration(path: Path, calibration: Calibration) -> None:
    """Write the camera's parameters and their accuracy to a file, completely or not at all.

    Keys in addition to the parameters: `reprojection_error_rms` in pixels, `standard_deviations` of fx fy cx cy and the
    distortion coefficients, their `parameter_covariance`, the numbers of used `views` and `corners`, the verdict of the
    `judgement`, and `data_date`, the day (UTC) of the newest view if known. Raises `SetupError` if the file cannot be
    written.
    """
    used = [fitted for fitted in calibration.views if not fitted.dropped]
    facts: dict[str, Fact] = {
        "reprojection_error_rms": calibration.rms,
        DEVIATIONS: calibration.deviations.reshape(1, -1),
        COVARIANCE: calibration.covariance,
        "views": len(used),
        "corners": int(np.sum([fitted.used.sum() for fitted in used])),
        "judgement": calibration.judgement.verdict.value,
    }
    if newest := max(fitted.view.stamp_ns for fitted in used):
        facts["data_date"] = datetime.fromtimestamp(newest / 1e9, timezone.utc).strftime("%Y-%m-%d")
    write_parameters(path, calibration.camera, facts)
