"""What does not fit: how far off corners may be, and which of them, or of the views, are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverlink.vision.calibration.adjustment import Estimate
from roverlink.vision.calibration.board import CharucoBoard
from roverlink.vision.calibration.start import residuals
from roverlink.vision.calibration.views import FEWEST_CORNERS, View
from roverlink.vision.camera.camera_model import Floats

OUTLIER = 3.5
"""Corners whose residuals are longer than so many standard deviations of a coordinate are left out."""
STRANGE = 4.0
"""A view is left out whose residuals are so many times those of the others (medians)."""
HUBER = 1.345
"""Standard deviations from where on residuals count by their size, not its square (Huber, 1964)."""
_RAYLEIGH_MEDIAN = 1.1774
"""Median length of a vector of two normal components, in their standard deviations."""


@dataclass(frozen=True, slots=True, eq=False)
class Misses:
    """How far the corners of views are off, for each view (N,)."""

    pixels: tuple[Floats, ...]
    """Lengths of the residuals; nan where a corner cannot have been seen."""
    sigmas: tuple[Floats, ...]
    """Standard deviations of a coordinate in pixels."""

    @property
    def lengths(self) -> list[Floats]:
        """Lengths in standard deviations."""
        return [length / sigma for length, sigma in zip(self.pixels, self.sigmas)]

    def weights(self, masks: Sequence[NDArray[np.bool_]]) -> list[Floats]:
        """What each corner counts, if those outside of the masks count nothing."""
        return [mask / sigma**2 for mask, sigma in zip(masks, self.sigmas)]

    def robust_weights(self) -> list[Floats]:
        """What each corner counts, if those that stand out count less."""
        return [
            np.nan_to_num(np.minimum(1, HUBER / np.maximum(length, 1e-12))) / sigma**2
            for length, sigma in zip(self.lengths, self.sigmas)
        ]


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """What is used of views."""

    masks: tuple[NDArray[np.bool_], ...]
    """Which corners (N,) of each view; none of one that is dropped."""
    dropped: tuple[str, ...]
    """Why each view is left out; empty if it is not."""

    @property
    def kept(self) -> list[int]:
        """The places of the views that are used."""
        return [place for place, reason in enumerate(self.dropped) if not reason]

    def same(self, other: Choice | None) -> bool:
        """Whether both use the same corners."""
        return other is not None and all((here == there).all() for here, there in zip(self.masks, other.masks))


def measure(views: Sequence[View], board: CharucoBoard, estimate: Estimate) -> Misses:
    """How far off the corners are by an estimate.

    What the noise of the images does not explain is taken as noise that all corners share: an uneven board, a lens
    that is not as the model has it.
    """
    lengths = tuple(
        np.linalg.norm(residuals(view, board, estimate.camera, pose), axis=1)
        for view, pose in zip(views, estimate.poses)
    )
    known = float(np.median(np.concatenate([view.sigmas for view in views])))
    seen = float(np.nanmedian(np.concatenate(lengths))) / _RAYLEIGH_MEDIAN
    shared = max(seen**2 - known**2, 0.0)
    return Misses(lengths, tuple(np.sqrt(view.sigmas**2 + shared) for view in views))


def choose(misses: Misses) -> Choice:
    """What to use of views that are so far off."""
    lengths = misses.lengths
    reasons = _strange(misses)
    masks = [length < OUTLIER for length in lengths]  # nan is no less
    reasons = [reason or _emptied(mask) for reason, mask in zip(reasons, masks)]
    return Choice(tuple(mask & (not reason) for mask, reason in zip(masks, reasons)), tuple(reasons))


def _strange(misses: Misses) -> list[str]:
    """For each view, why it does not fit the others; empty where it does."""
    medians = [float(np.median(np.nan_to_num(one, nan=np.inf))) for one in misses.lengths]
    typical = float(np.median(medians))
    others = float(np.nanmedian(np.concatenate(misses.pixels)))
    return [
        _off(float(np.nanmedian(pixels)), others) if median > STRANGE * typical else ""
        for median, pixels in zip(medians, misses.pixels)
    ]


def _off(own: float, others: float) -> str:
    return (
        f"its corners are off by {own:.2g} px, those of all views by {others:.2g} px (medians): it is blurred, or the "
        "board was moving or bent"
    )


def _emptied(mask: NDArray[np.bool_]) -> str:
    left = int(mask.sum())
    return f"only {left} of its {mask.size} corners fit the other views" if left < FEWEST_CORNERS else ""
