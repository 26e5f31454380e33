"""Text output of a calibration: lines for people, or JSON lines for scripts."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from rich.console import Console
from rich.table import Table

from roverkit.calibration import Calibration, Collection, Need, Offer, PoorViewsError, Verdict, View
from roverkit.calibration.report import parameters
from roverlink.console import print_error, print_note
from roverlink.numerals import counted

_HINT_S = 2.0
"""Shortest time in seconds between two hints about frames that were not taken."""
_KINDS = {"region": "parts of the image", "distance": "distances", "tilt": "tilts"}
_GRID = (32, 24)
"""Number of columns and rows of the grid of pixels at which the uncertainty is computed."""


class CalibrationText(Protocol):
    """Output of ``roverlink aruco calibrate``. The command calls a method for each event of the calibration."""

    def note(self, message: str) -> None:
        """Show a message about the source of frames to the user."""

    def begins(self, collection: Collection) -> None:
        """Report that the collection of views begins. The command calls this once, before the first frame."""

    def offered(self, offer: Offer, collection: Collection) -> None:
        """Report that a frame was examined.

        The command calls this for each frame; ``offer`` tells if its view was taken.
        """

    def refused(self, error: PoorViewsError, views: Sequence[View]) -> None:
        """Report that the calibration has failed because the views are not sufficient."""

    def calibrated(self, calibration: Calibration, path: Path, report: Path) -> None:
        """Report the calibration. Its parameters are already written to ``path``, and its report to ``report``."""


class PlainText:
    """Output for people: the result on standard output, everything else on standard error."""

    def __init__(self) -> None:
        self._told = -_HINT_S

    def note(self, message: str) -> None:
        """Print a message about the source of frames."""
        print_note(message)

    def begins(self, collection: Collection) -> None:
        """Print instructions for the user when the collection of views begins."""
        print_note(
            "Move the board through the whole image: near, far, and tilted to all sides. Hold it still now and then."
        )
        print_note(f"Useful views are taken automatically, at least {collection.wanted}. Ctrl-C ends the collection.")

    def offered(self, offer: Offer, collection: Collection) -> None:
        """Print each view that was taken, and which views are missing; at intervals, print why no view is taken."""
        now = time.monotonic()
        if offer.taken:
            count = len(collection.views)
            print_note(f"view {count} ({offer.view.name}): {counted(len(offer.view.ids), 'corner')}, {offer.reason}")
            if missing := missing_words(collection.missing):
                print_note(f"  missing: {missing}")
        elif now - self._told > _HINT_S:
            print_note(f"  {offer.reason}")
        else:
            return
        self._told = now

    def refused(self, error: PoorViewsError, views: Sequence[View]) -> None:
        """Print the unusable views, and each reason why the views are not sufficient."""
        for view in views:
            if view.flaw:
                print_note(f"{view.name}: {view.flaw}")
        for reason in error.reasons:
            print_error(f"the views are not sufficient for a calibration: {reason}")

    def calibrated(self, calibration: Calibration, path: Path, report: Path) -> None:
        """Print the views, the camera's parameters, their uncertainty, the judgement, and the two written files."""
        console = Console(highlight=False, markup=False, soft_wrap=True)
        console.print(_view_table(calibration))
        console.print()
        console.print(_parameter_table(calibration))
        mean, most = spread(calibration)
        dropped = sum(bool(fitted.dropped) for fitted in calibration.views)
        console.print(
            f"\nreprojection error {calibration.rms:.3f} px (root mean square), {counted(dropped, 'view')} dropped\n"
            f"uncertainty of a direction {mean:.3f} px on average, {most:.3f} px at most (standard deviation)"
        )
        judgement = calibration.judgement
        console.print(f"judgement: {judgement.verdict.value}")
        for doubt in judgement.doubts:
            console.print(f"  - {doubt.text}")
        console.print(f"wrote {path} and the report {report}")
        if judgement.verdict is Verdict.UNUSABLE:
            console.print("the file has another name, so that it replaces no good one; rename it to use it anyway")


class JsonText:
    """Output for scripts: JSON lines on standard output.

    There is one line for each view that is taken, and then one for the calibration or for the reasons why it failed.
    """

    def note(self, message: str) -> None:
        """Print a message about the source on standard error, because it is for people."""
        print_note(message)

    def begins(self, collection: Collection) -> None:
        """Print nothing when the collection of views begins: scripts need no instructions."""

    def offered(self, offer: Offer, collection: Collection) -> None:
        """Print a JSON line for a view that was taken."""
        if offer.taken:
            adds = [need.name for need in offer.adds]
            missing = [{"kind": need.kind, "name": need.name} for need in collection.missing]
            _line(
                {"view": offer.view.name, "corners": len(offer.view.ids), "adds": _distinct(adds), "missing": missing}
            )

    def refused(self, error: PoorViewsError, views: Sequence[View]) -> None:
        """Print a JSON line with the reasons why the views are not sufficient."""
        useless = {view.name: view.flaw for view in views if view.flaw}
        _line({"refused": list(error.reasons), "views": len(views), "useless": useless})

    def calibrated(self, calibration: Calibration, path: Path, report: Path) -> None:
        """Print a JSON line with the calibration."""
        _line(as_dict(calibration) | {"file": str(path), "report": str(report)})


def missing_words(needs: Iterable[Need]) -> str:
    """Return requirements as text for the user, such as ``distances: near, far``; an empty text if there are none."""
    found: dict[str, list[str]] = {}
    for need in needs:
        found.setdefault(_KINDS[need.kind], []).append(need.name)
    return "; ".join(f"{kind}: {', '.join(_distinct(names))}" for kind, names in found.items())


def as_dict(calibration: Calibration) -> dict[str, Any]:
    """Return a calibration as JSON values. Errors and uncertainties are in pixels; a `deviation` is a standard one."""
    mean, most = spread(calibration)
    return {
        "model": calibration.model.value,
        "size": list(calibration.views[0].view.size),
        "rms": calibration.rms,
        "parameters": {
            name: {"value": value, "deviation": deviation}
            for name, value, deviation in zip(
                calibration.names, calibration.values.tolist(), calibration.deviations.tolist()
            )
        },
        "uncertainty": {"mean": mean, "max": most},
        "judgement": {
            "verdict": calibration.judgement.verdict.value,
            "doubts": [{"verdict": doubt.verdict.value, "text": doubt.text} for doubt in calibration.judgement.doubts],
        },
        "views": [
            {
                "name": fitted.view.name,
                "corners": len(fitted.view.ids),
                "used": int(fitted.used.sum()),
                "rms": fitted.rms if np.isfinite(fitted.rms) else None,
                "dropped": fitted.dropped,
            }
            for fitted in calibration.views
        ],
    }


def spread(calibration: Calibration) -> tuple[float, float]:
    """Return the mean and the largest uncertainty of a calibration over the image, in pixels.

    The uncertainty is the standard deviation of the pixel at which the calibrated camera expects a direction.
    """
    width, height = calibration.views[0].view.size
    places = np.stack(np.meshgrid(np.linspace(0, width - 1, _GRID[0]), np.linspace(0, height - 1, _GRID[1])), axis=-1)
    deviations = calibration.uncertainty(places)
    return float(np.nanmean(deviations)), float(np.nanmax(deviations))


def _view_table(calibration: Calibration) -> Table:
    table = Table(box=None, pad_edge=False)
    table.add_column("view", no_wrap=True)
    for name in ("corners", "left out", "error px"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("")
    for fitted in calibration.views:
        error = f"{fitted.rms:.3f}" if np.isfinite(fitted.rms) else ""
        rejected = str(fitted.rejected) if fitted.rejected else ""
        table.add_row(
            fitted.view.name,
            str(len(fitted.view.ids)),
            rejected,
            error,
            fitted.dropped and f"dropped: {fitted.dropped}",
        )
    return table


def _parameter_table(calibration: Calibration) -> Table:
    table = Table(box=None, pad_edge=False)
    table.add_column("parameter", no_wrap=True)
    for name in ("value", "95 % interval"):
        table.add_column(name, justify="right", no_wrap=True)
    for parameter in parameters(calibration):
        table.add_row(parameter.name, parameter.value, f"± {parameter.interval}")
    return table


def _line(facts: dict[str, Any]) -> None:
    print(json.dumps(facts), flush=True)


def _distinct(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))
