"""Judgement of a calibration: good, usable, or not to be used, with a reason and a remedy for each doubt.

The module knows no cameras or images: it compares the numbers of an `Evidence` with limits.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

BENT, BENT_BADLY = 0.002, 0.02
"""Bend of the board, as a share of its width, from which a calibration is only usable, and not to be used."""
STRETCHED, STRETCHED_BADLY = 0.001, 0.03
"""Difference between the stretch of the print along its sides, as a fraction, with the same meaning."""
MOVED, MOVED_BADLY = 0.3, 3.0
"""Motion in pixels during the readout of an image, with the same meaning."""
MOTION = 0.25
"""Least share of the squared residuals that motion must explain, to be the reason."""
MISFIT = 1.0
"""Difference in pixels between the lens model and a better one from which a calibration is not to be used."""
UNCERTAIN, UNKNOWN = 0.5, 2.0
"""Standard deviation of a direction in pixels, with the same meaning as `BENT`."""
UNEXPLAINED, VISIBLE = 4.0, 0.1
"""Ratio of the residuals to the image noise, and size of the residuals in pixels, above which a reason is missing."""
DROPPED = 1 / 3
"""Share of dropped views, or of rejected corners, above which a calibration is only usable."""


class Verdict(str, Enum):
    """Verdict on a calibration."""

    GOOD = "good"
    USABLE = "usable"
    """The parameters serve, but something could be better."""
    UNUSABLE = "do not use"


@dataclass(frozen=True, slots=True)
class Doubt:
    """Reason why a calibration is not good, as a sentence with the remedy."""

    verdict: Verdict
    """Best verdict that this reason allows."""
    text: str


@dataclass(frozen=True, slots=True)
class Judgement:
    """Verdict on a calibration: it is good if there are no doubts."""

    doubts: tuple[Doubt, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """Worst verdict of all doubts."""
        worst = {doubt.verdict for doubt in self.doubts}
        return next((verdict for verdict in (Verdict.UNUSABLE, Verdict.USABLE) if verdict in worst), Verdict.GOOD)


@dataclass(frozen=True, slots=True)
class BetterModel:
    """Lens model that predicts views better than the one that was used."""

    name: str
    error: float
    """Error in pixels with which the model predicts views that it has not seen (root mean square)."""
    own_error: float
    """Same error of the model that was used."""
    difference: float
    """Distance in pixels between the directions of the two models at the corners (root mean square)."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """Numbers on which a judgement is based. Lengths in the image are in pixels."""

    model: str
    """Lens model that was used."""
    rms: float
    """Root mean square of the residuals of all used corners."""
    noise: float
    """Root mean square of the residuals that the noise of the images explains."""
    uncertainty: float
    """Standard deviation of a direction at the corners (root mean square)."""
    bend: float = 0.0
    """Height of the board above a plane in metres; 0 if it is not significant."""
    width: float = 1.0
    """Width of the board in metres."""
    stretch: float = 0.0
    """Stretch of the print in height against its width, as a fraction; 0 if it is not significant."""
    better: BetterModel | None = None
    motion: float = 0.0
    """Motion from the first to the last row while an image was read out."""
    motion_explains: float = 0.0
    """Share (0 to 1) of the squared residuals that this motion explains."""
    empty: tuple[str, ...] = ()
    """Parts of the image without corners, by name."""
    parts: int = 24
    """Number of all parts of the image."""
    dropped: float = 0.0
    """Share of the views that were dropped because they do not fit the others."""
    rejected: float = 0.0
    """Share of the corners that were left out of the used views."""


def judge(evidence: Evidence) -> Judgement:
    """Return the judgement that follows from the evidence, with the worst doubts first."""
    doubts = sorted(_doubts(evidence), key=lambda doubt: doubt.verdict is not Verdict.UNUSABLE)
    return Judgement(tuple(doubts))


def _doubts(evidence: Evidence) -> Iterator[Doubt]:
    explained = False
    if better := evidence.better:
        explained = True
        yield Doubt(
            Verdict.UNUSABLE if better.difference >= MISFIT else Verdict.USABLE,
            f"the lens does not follow the model {evidence.model}: it predicts views that it has not seen with an "
            f"error of {better.own_error:.2g} px, {better.name} with {better.error:.2g} px; calibrate again with "
            f"--model {better.name}",
        )
    share = evidence.bend / evidence.width
    if share >= BENT:
        yield Doubt(
            _level(share, BENT_BADLY),
            f"the board is bent by {evidence.bend * 1000:.1f} mm: the parameters allow for a simple bend, but a flat "
            "board gives better ones; glue it to something flat, such as glass",
        )
    if abs(evidence.stretch) >= STRETCHED:
        longer, shorter = ("higher", "wide") if evidence.stretch > 0 else ("wider", "high")
        yield Doubt(
            _level(abs(evidence.stretch), STRETCHED_BADLY),
            f"the squares of the print are {100 * abs(evidence.stretch):.2g} % {longer} than {shorter}: the "
            "parameters allow for this, but their size is not the one that you gave; measure many squares in both "
            "directions, and print without scaling",
        )
    if not explained and evidence.motion >= MOVED and evidence.motion_explains >= MOTION:
        explained = True
        yield Doubt(
            _level(evidence.motion, MOVED_BADLY),
            f"the picture moves by {evidence.motion:.1f} px between the first and the last row: the camera has a "
            "rolling shutter, and the board was not still; put the board or the camera down for each view",
        )
    if not explained and evidence.rms >= max(UNEXPLAINED * evidence.noise, VISIBLE):
        yield Doubt(
            Verdict.USABLE,
            f"the corners are off by {evidence.rms:.2f} px, and the noise of the images explains only "
            f"{evidence.noise:.2f} px: the board may be uneven, or printed inexactly; use another board",
        )
    if evidence.uncertainty >= UNCERTAIN:
        yield Doubt(
            _level(evidence.uncertainty, UNKNOWN),
            f"directions are known to {evidence.uncertainty:.1f} px only (standard deviation); take more views, with "
            "more tilt, and with the board nearer",
        )
    if evidence.empty:
        names = ", ".join(dict.fromkeys(evidence.empty))
        yield Doubt(
            Verdict.USABLE,
            f"no corners in {len(evidence.empty)} of {evidence.parts} parts of the image, so the lens is unknown "
            f"there: {names}; show the board there",
        )
    if max(evidence.dropped, evidence.rejected) > DROPPED:
        share, what = max((evidence.dropped, "views"), (evidence.rejected, "corners"))
        yield Doubt(
            Verdict.USABLE,
            f"{100 * share:.0f} % of the {what} do not fit the others; take sharp images of a flat board that is still",
        )


def _level(value: float, limit: float) -> Verdict:
    return Verdict.UNUSABLE if value >= limit else Verdict.USABLE
