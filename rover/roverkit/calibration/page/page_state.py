"""State of the calibration page as JSON. All texts are made here; the page itself only arranges them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from roverkit.calibration.collection import Collection
from roverkit.calibration.coverage import CELLS, Need
from roverkit.calibration.report import parameters
from roverkit.calibration.solution import Calibration, Fitted
from roverkit.calibration.views import View
from roverlink.numerals import counted


@dataclass(frozen=True, slots=True, eq=False)
class Taken:
    """View that was taken, with its number on the page and its thumbnail as JPEG."""

    number: int
    view: View
    thumbnail: bytes


def collected(collection: Collection, taken: Sequence[Taken], calibration: Calibration | None) -> dict[str, Any]:
    """Return JSON values for the page: the coverage, the goals, the taken views, and the result of the calibration."""
    fitted_views = {id(fitted.view): fitted for fitted in calibration.views} if calibration else {}
    return {
        "coverage": _coverage(collection),
        "goals": list(_goals(collection)),
        "views": [
            _view(shown, fitted_views.get(id(shown.view)), calibrated=calibration is not None) for shown in taken
        ],
        "result": calibration and _result(calibration, taken),
    }


def advice(needs: Sequence[Need]) -> str:
    """Return an instruction for the user: how to meet the first need, or to take more views if there is no need."""
    if not needs:
        return "Next: take a few more views from other directions."
    first = needs[0]
    where = {"region": f"move the board to the {first.name} of the image", "tilt": f"tilt the board: {first.name}"}
    distances = {"near": "move the board closer", "far": "move the board further away"}
    todo = where.get(first.kind) or distances.get(first.name, "move the board to where it fills half of the image")
    return f"Next: {todo}, and hold it still."


def _coverage(collection: Collection) -> dict[str, Any]:
    columns, rows = CELLS
    cells = [need.cell for need in collection.missing if need.cell]
    return {"columns": columns, "rows": rows, "missing": [row * columns + column for column, row in cells]}


def _goals(collection: Collection) -> Iterator[dict[str, Any]]:
    """Yield the goals that the page shows, as JSON values: number of views, parts of the image, distances, tilts."""
    needs = collection.coverage.needs()
    have, regions = len(collection.views), [need for need in needs if need.kind == "region"]
    met = sum(need.met for need in regions)
    yield _goal("Views", [(f"{have} of {collection.wanted}", have >= collection.wanted)])
    yield _goal("Image", [(f"{met} of {len(regions)} parts", met == len(regions))])
    for kind in ("distance", "tilt"):
        chosen = [need for need in needs if need.kind == kind]
        yield _goal(kind.capitalize(), [(_counted(need), need.met) for need in chosen])


def _counted(need: Need) -> str:
    return need.name if need.met else f"{need.name} {need.have}/{need.wanted}"


def _goal(name: str, parts: Sequence[tuple[str, bool]]) -> dict[str, Any]:
    return {"name": name, "parts": [{"text": text, "done": done} for text, done in parts]}


def _view(taken: Taken, fitted: Fitted | None, *, calibrated: bool) -> dict[str, Any]:
    lines = [taken.view.name, counted(len(taken.view.ids), "corner")]
    if fitted is not None:
        lines.append(f"dropped: {fitted.dropped}" if fitted.dropped else f"error {fitted.rms:.3f} px")
        if fitted.rejected:
            lines.append(f"{counted(fitted.rejected, 'corner')} rejected")
    elif calibrated:
        lines.append("not used yet")
    return {"number": taken.number, "lines": lines, "bad": bool(fitted and fitted.dropped)}


def _result(calibration: Calibration, taken: Sequence[Taken]) -> dict[str, Any]:
    numbers = [[parameter.name, parameter.value, f"± {parameter.interval}"] for parameter in parameters(calibration)]
    kept = sum(not fitted.dropped for fitted in calibration.views)
    judgement = calibration.judgement
    remarks = [f"Judgement: {judgement.verdict.value}.", *(f"{doubt.text}." for doubt in judgement.doubts)]
    remarks += [f"RMS {calibration.rms:.3f} px over {counted(kept, 'view')}; ± is the 95 % interval."]
    if {id(shown.view) for shown in taken} != {id(fitted.view) for fitted in calibration.views}:
        remarks.append("The views have changed since the calibration: calibrate again.")
    return {"numbers": numbers, "remarks": remarks}
