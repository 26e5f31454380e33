"""Test for motion during the readout of the image: a rolling shutter, or a board that was not still.

A camera with a rolling shutter reads one row after the other. If the board moves meanwhile, each row is shifted a
little more than the one above it. So the test asks how much better the corners fit if each view may have a shift that
grows from row to row. The shifts of the views are unrelated: no lens and no bent board looks like this.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from roverkit.calibration.adjustment import Estimate, Observation, linearise
from roverkit.vision.camera.camera_model import Floats

_SHIFTS = 2  # along x and y


@dataclass(frozen=True, slots=True)
class RollingShutter:
    """Result of the test for motion during readout."""

    shift: float
    """Shift between the first and the last row in pixels: root mean square over the views."""
    explained: float
    """Share (0 to 1) of the squared residuals that the shifts explain."""
    expected: float
    """Share that as many unknowns explain on average if there is only noise."""


def find_rolling_shutter(observations: Sequence[Observation], estimate: Estimate, rows: int) -> RollingShutter:
    """Return the motion during readout that fits the residuals best; `rows` is the height of the image.

    The camera stays as estimated, because a shift that is equal in all views is the same as another focal length.
    """
    shifts, before, after, count = [], 0.0, 0.0, 0
    for view, observation in zip(linearise(observations, estimate), observations):
        unknowns = np.column_stack([view.by_pose, _by_shift(observation, rows)])
        found = np.linalg.lstsq(unknowns, view.residuals, rcond=None)[0]
        shifts.append(found[-_SHIFTS:])
        before += float(view.residuals @ view.residuals)
        after += float(np.sum((view.residuals - unknowns @ found) ** 2))
        count += len(view.residuals)
    size = float(np.sqrt(np.mean(np.sum(np.square(shifts), axis=1))))
    return RollingShutter(size, 1 - after / before, _SHIFTS * len(shifts) / count)


def _by_shift(observation: Observation, rows: int) -> Floats:
    """Return the derivative (2N, 2) of the weighted pixels with respect to the shift of the last row."""
    used = observation.weights > 0
    along = np.sqrt(observation.weights[used]) * (observation.pixels[used, 1] / rows - 0.5)
    derivative: Floats = np.kron(along[:, None], np.eye(_SHIFTS))
    return derivative
