"""Report of a calibration: one HTML file without links to other files, to be kept with the camera's parameters.

Equal calibrations give equal bytes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from roverkit.calibration import figures
from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.coverage import Coverage, traits
from roverkit.calibration.solution import Calibration, Fitted
from roverlink.runtime.atomic_files import write_whole

_TEMPLATES = Path(__file__).with_name("templates")
_TEMPLATE = "calibration.html.j2"


@dataclass(frozen=True, slots=True)
class Parameter:
    """Parameter of the camera, with name, value and interval as text."""

    name: str
    value: str
    interval: str
    """Half the width of the 95 % interval."""


@dataclass(frozen=True, slots=True)
class _Row:
    """Row of the table of views in the report."""

    fitted: Fitted
    used: str
    left_out: str
    judged: bool
    """True if the board's pose in the view is known; otherwise `worst`, `distance` and `tilt` mean nothing."""
    worst: float
    """Longest residual of a used corner in pixels; of all corners for a dropped view."""
    distance: float
    """Distance from the camera to the board's centre in metres."""
    tilt: float
    """Angle between board and image plane in degrees."""


def parameters(calibration: Calibration) -> list[Parameter]:
    """Return the camera's parameters as text, with as many digits as their confidence intervals justify."""
    halves = (calibration.interval * calibration.deviations).tolist()
    return [
        Parameter(name, f"{value:.{digits}f}", f"{half:.{digits}f}")
        for name, value, half in zip(calibration.names, calibration.values.tolist(), halves)
        for digits in [_digits(half)]
    ]


def report(calibration: Calibration, board: CalibrationBoard, versions: Mapping[str, str]) -> str:
    """Return the report as HTML: parameters, figures of residuals, uncertainty and coverage, and a table of all views.

    `versions` maps the names of the programs that made the calibration to their versions.
    """
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        # A misspelt name in a template must fail, not print an empty cell.
        undefined=StrictUndefined,
    )
    coverage, size = _coverage(calibration, board), calibration.views[0].view.size
    cells = np.arange(coverage.cells.size).reshape(coverage.cells.shape)
    return environment.get_template(_TEMPLATE).render(
        calibration=calibration,
        board=board,
        parameters=parameters(calibration),
        size=size,
        date=_date(calibration.views),
        versions=versions,
        residuals=figures.residuals(calibration),
        uncertainty=figures.uncertainty(calibration),
        bounds=figures.BOUNDS,
        cells=list(zip(figures.fields(cells, size), coverage.cells.ravel().tolist())),
        needs=[need for need in coverage.needs() if need.cell is None],
        rows=[_row(fitted, board) for fitted in calibration.views],
        kept=[fitted for fitted in calibration.views if not fitted.dropped],
        dropped=[fitted for fitted in calibration.views if fitted.dropped],
    )


def write_report(path: Path, calibration: Calibration, board: CalibrationBoard, versions: Mapping[str, str]) -> None:
    """Write the report to a file, completely or not at all. Raises `SetupError` if the file cannot be written."""
    write_whole(path, report(calibration, board, versions).encode())


def _digits(half: float) -> int:
    """Return the number of decimals with which half the width of an interval is shown with two significant digits."""
    return max(0, 1 - math.floor(math.log10(half))) if 0 < half < math.inf else 1


def _date(views: Sequence[Fitted]) -> str:
    """Return the times (UTC) of the first and last view as text; "unknown" if no view has a time."""
    stamps = [fitted.view.stamp_ns for fitted in views if fitted.view.stamp_ns]
    if not stamps:
        return "unknown"
    first, last = (datetime.fromtimestamp(stamp // 1_000_000_000, timezone.utc) for stamp in (min(stamps), max(stamps)))
    until = f" to {last:%H:%M:%S}" if last.date() == first.date() else f" to {last:%Y-%m-%d %H:%M:%S}"
    return f"{first:%Y-%m-%d %H:%M:%S}{until if last != first else ''} UTC"


def _coverage(calibration: Calibration, board: CalibrationBoard) -> Coverage:
    """Return the coverage of the used views: the parts of the image, the distances and the tilts that they show."""
    coverage = Coverage()
    for fitted in calibration.views:
        if not fitted.dropped:
            outline = calibration.camera.project(fitted.pose.apply(board.outline))
            coverage.add(traits(fitted.view, fitted.pose, outline))
    return coverage


def _row(fitted: Fitted, board: CalibrationBoard) -> _Row:
    lengths = np.linalg.norm(fitted.residuals[fitted.used if fitted.used.any() else slice(None)], axis=1)
    return _Row(
        fitted,
        figures.dots(fitted.view.corners[fitted.used]),
        figures.dots(fitted.view.corners[~fitted.used]),
        bool(np.isfinite(fitted.pose.translation).all()),
        float(np.max(lengths, initial=0)),
        float(np.linalg.norm(fitted.pose.apply(board.outline.mean(axis=0)))),
        math.degrees(math.acos(min(1.0, abs(float(fitted.pose.rotation[2, 2]))))),
    )
