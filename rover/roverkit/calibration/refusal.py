"""Checks that refuse to calibrate from insufficient views. The errors tell the user which views are missing.

A view is the set of board corners found in one image.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.coverage import CELLS, Coverage, traits
from roverkit.calibration.solution import Fitted, PoorViewsError
from roverkit.calibration.views import View
from roverkit.vision.camera.camera_model import CameraParameters
from roverlink.numerals import counted

FEWEST_VIEWS = 10
FEWEST_CELLS = 0.6
"""Least share of the image regions that must contain corners."""
FEWEST_TILTED = 3


def check_sizes(views: Iterable[View]) -> None:
    """Raise `PoorViewsError` if the images of the views do not all have the same size."""
    sizes = sorted({view.size for view in views})
    if len(sizes) > 1:
        named = ", ".join(f"{width}x{height}" for width, height in sizes)
        raise PoorViewsError((f"the images have several sizes: {named}; calibrate each size by itself",))


def check_count(usable: int, given: int) -> None:
    """Raise `PoorViewsError` if fewer views are usable than a calibration needs."""
    if usable < FEWEST_VIEWS:
        raise PoorViewsError(
            (f"{usable} of {given} views are usable, but {FEWEST_VIEWS} are needed; take more images of the board",)
        )


def check_coverage(kept: Sequence[Fitted], board: CalibrationBoard, camera: CameraParameters) -> Coverage:
    """Return the coverage of the used views. Raises `PoorViewsError` if it is too small, or if too few are tilted."""
    coverage = Coverage()
    tilted = 0
    for fitted in kept:
        shown = traits(fitted.view, fitted.pose, camera.project(fitted.pose.apply(board.outline)))
        coverage.add(shown)
        tilted += bool(shown.tilts)
    reasons = []
    empty = [need.name for need in coverage.needs() if need.kind == "region" and not need.have]
    count = CELLS[0] * CELLS[1]
    if len(empty) > (1 - FEWEST_CELLS) * count:
        where = ", ".join(dict.fromkeys(empty))
        reasons.append(f"no corners in {len(empty)} of {count} parts of the image: {where}; show the board there")
    if tilted < FEWEST_TILTED:
        reasons.append(
            f"the board is tilted in {counted(tilted, 'view')}, but {FEWEST_TILTED} are needed: without tilt, the "
            "distance cannot be separated from the focal length; hold the board at an angle to the camera in more views"
        )
    if reasons:
        raise PoorViewsError(tuple(reasons))
    return coverage
