"""Outliers: corners and views that do not fit the others, so that the calibration leaves them out.

A view is the set of board corners found in one image. A residual is the observed minus the expected position of a
corner in pixels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.adjustment import Estimate
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.board_shape import shaped_points
from roverkit.calibration.start import residuals
from roverkit.calibration.views import FEWEST_CORNERS, View
from roverkit.vision.camera.camera_model import Floats

# Why leave out corners at all: before the corners were fitted (`saddles`), a few bad ones decided. Measured with
# OpenCV's corners in 20 rendered views of 1280x720: with all corners, fx was wrong by 1.33 px, without the outliers by
# 0.04 px. With one corrupted view among the 20, by 4.9 and 0.28 px. The standard deviations were up to three times too
# small while the outliers were in.
OUTLIER = 3.5
"""Length of a residual, in standard deviations of a coordinate, above which a corner is left out."""
BAD_VIEW_RATIO = 4.0
"""Ratio of a view's median residual to the typical one (median over the views), above which the view is left out."""
# With 1.345, the estimate has 95 % of the efficiency of least squares if there are no outliers at all.
HUBER = 1.345
"""Residual, in standard deviations, from which the cost is linear instead of quadratic (Huber, 1964)."""
# sqrt(2 ln 2)
_RAYLEIGH_MEDIAN = 1.1774
"""Median of the Rayleigh distribution: of the length of a vector with two normal components of sigma 1."""


@dataclass(frozen=True, slots=True, eq=False)
class ResidualLengths:
    """Lengths of the residuals of all corners; for each view an array (N,)."""

    pixels: tuple[Floats, ...]
    """Lengths in pixels; NaN for a corner that the camera cannot have seen."""
    sigmas: tuple[Floats, ...]
    """Expected standard deviations of a corner's coordinate in pixels: image noise and model error, see `measure`."""

    @property
    def lengths(self) -> list[Floats]:
        """Lengths of the residuals, divided by the standard deviations of the corners."""
        return [length / sigma for length, sigma in zip(self.pixels, self.sigmas)]

    def weights(self, masks: Sequence[NDArray[np.bool_]]) -> list[Floats]:
        """Return the weights of the corners, for each view an array (N,).

        `masks` holds true for each corner that is used. All other corners have weight 0.
        """
        return [mask / sigma**2 for mask, sigma in zip(masks, self.sigmas)]

    def robust_weights(self) -> list[Floats]:
        """Return the weights of the corners by Huber's function, which gives outliers less weight."""
        return [
            np.nan_to_num(np.minimum(1, HUBER / np.maximum(length, 1e-12))) / sigma**2
            for length, sigma in zip(self.lengths, self.sigmas)
        ]


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """Selection of the corners and views that the calibration uses."""

    masks: tuple[NDArray[np.bool_], ...]
    """For each view, the mask (N,) of the corners that are used; all false if the view is left out."""
    dropped: tuple[str, ...]
    """For each view, the reason why it is left out; an empty text if it is used."""

    @property
    def kept(self) -> list[int]:
        """Indices of the views that are used."""
        return [place for place, reason in enumerate(self.dropped) if not reason]

    def same(self, other: Choice | None) -> bool:
        """Return true if this selection and another one use the same corners; false if the other one is None."""
        return other is not None and all((here == there).all() for here, there in zip(self.masks, other.masks))


def measure(views: Sequence[View], board: CalibrationBoard, estimate: Estimate) -> ResidualLengths:
    """Return the lengths of the residuals of all corners for an estimate of camera and poses.

    Residuals are often larger than the image noise explains, because the board is uneven or the lens differs from its
    model. The excess is treated as additional noise that is equal for all corners.
    """
    points = shaped_points(board, estimate.shape)
    lengths = tuple(
        np.linalg.norm(residuals(view, points, estimate.camera, pose), axis=1)
        for view, pose in zip(views, estimate.poses)
    )
    # Medians, because outliers are not yet removed here.
    known = float(np.median(np.concatenate([view.sigmas for view in views])))
    seen = float(np.nanmedian(np.concatenate(lengths))) / _RAYLEIGH_MEDIAN
    shared = max(seen**2 - known**2, 0.0)
    return ResidualLengths(lengths, tuple(np.sqrt(view.sigmas**2 + shared) for view in views))


def choose(misses: ResidualLengths) -> Choice:
    """Return the corners and views to use: those whose residuals are not much larger than expected."""
    lengths = misses.lengths
    reasons = _bad_views(misses)
    masks = [length < OUTLIER for length in lengths]  # false for NaN
    reasons = [reason or _emptied(mask) for reason, mask in zip(reasons, masks)]
    return Choice(tuple(mask & (not reason) for mask, reason in zip(masks, reasons)), tuple(reasons))


def _bad_views(misses: ResidualLengths) -> list[str]:
    """Return, for each view, the reason why the view does not fit the others; an empty text if it fits."""
    medians = [float(np.median(np.nan_to_num(length, nan=np.inf))) for length in misses.lengths]
    typical = float(np.median(medians))
    others = float(np.nanmedian(np.concatenate(misses.pixels)))
    return [
        _off(float(np.nanmedian(pixels)), others) if median > BAD_VIEW_RATIO * typical else ""
        for median, pixels in zip(medians, misses.pixels)
    ]


def _off(own: float, others: float) -> str:
    return (
        f"its corners are off by {own:.2g} px, those of all views by {others:.2g} px (medians): the image is blurred, "
        "or the board was moving or bent"
    )


def _emptied(mask: NDArray[np.bool_]) -> str:
    left = int(mask.sum())
    return f"only {left} of its {mask.size} corners fit the other views" if left < FEWEST_CORNERS else ""
