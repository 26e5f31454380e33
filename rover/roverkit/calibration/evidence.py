"""Evidence for the judgement of a calibration, from its residuals and its views."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roverkit.calibration.adjustment import Estimate
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.board_shape import BEND, STRETCH, height
from roverkit.calibration.coverage import CELLS, Coverage
from roverkit.calibration.cross_validation import better_model
from roverkit.calibration.outliers import Choice
from roverkit.calibration.robust_fit import observations_of, part_of
from roverkit.calibration.rolling_shutter import find_rolling_shutter
from roverkit.calibration.solution import Calibration
from roverkit.calibration.verdict import Evidence
from roverkit.calibration.views import View

_SUSPICIOUS = 1.05
"""Ratio of the residuals to the image noise above which other lens models are tried, which takes some seconds."""
_MANY_REJECTED = 0.01
"""Share of rejected corners with the same effect."""
_SIGNIFICANT = 16.3
"""Squared bend in units of its covariance above which it is no chance (chi squared, 3 degrees of freedom, 99.9 %)."""
_SIGNIFICANT_STRETCH = 10.8
"""The same for the stretch of the print (1 degree of freedom)."""
_PLACES = 500
"""Largest number of corners at which the uncertainty is computed."""


def gather(
    calibration: Calibration,
    usable: Sequence[View],
    board: CalibrationBoard,
    estimate: Estimate,
    choice: Choice,
    coverage: Coverage,
) -> Evidence:
    """Return the evidence for the judgement of a calibration.

    `estimate` and `choice` are the fit to the `usable` views, `coverage` is that of the views that are used.
    """
    kept = [fitted for fitted in calibration.views if not fitted.dropped]
    corners = calibration.seen
    sigmas = np.concatenate([fitted.view.sigmas[fitted.used] for fitted in kept])
    noise = float(np.sqrt(2 * np.mean(sigmas**2)))
    rejected = 1 - len(corners) / sum(fitted.used.size for fitted in kept)
    dropped = 1 - len(kept) / len(usable)
    deviations = calibration.uncertainty(corners[:: -(-len(corners) // _PLACES)])
    bend, stretch = calibration.shape[BEND], float(calibration.shape[STRETCH])
    chi2 = float(bend @ np.linalg.solve(calibration.shape_covariance[BEND, BEND], bend))
    stretch_chi2 = stretch**2 / float(calibration.shape_covariance[STRETCH, STRETCH])
    suspicious = calibration.rms > _SUSPICIOUS * noise or rejected > _MANY_REJECTED or dropped > 0
    shutter = find_rolling_shutter(
        observations_of(usable, board, estimate, choice), part_of(estimate, choice), usable[0].size[1]
    )
    return Evidence(
        model=calibration.model.value,
        rms=calibration.rms,
        noise=noise,
        uncertainty=float(np.sqrt(np.nanmean(deviations**2))),
        bend=height(board, calibration.shape) if chi2 > _SIGNIFICANT else 0.0,
        stretch=stretch if stretch_chi2 > _SIGNIFICANT_STRETCH else 0.0,
        width=board.size[0],
        better=better_model(usable, board, calibration.model, estimate, choice) if suspicious else None,
        motion=shutter.shift,
        motion_explains=shutter.explained,
        empty=tuple(need.name for need in coverage.needs() if need.kind == "region" and not need.have),
        parts=CELLS[0] * CELLS[1],
        dropped=dropped,
        rejected=rejected,
    )
