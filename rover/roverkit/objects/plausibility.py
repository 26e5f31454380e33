"""Check that a detector's boxes and scores for a grey image are possible: a wrong layout gives others."""

from __future__ import annotations

import numpy as np

from roverkit.objects.layouts import Candidates

_SLACK = 1e-3  # half precision rounds scores
_AROUND = 0.5
"""Part of the image by which the middle of a box may be outside of it; untrained cells at the border reach that far."""
_MOST = 0.5
"""Largest part of the boxes that may be impossible."""
_PARTS = 2.0
"""Largest coordinate in pixels of boxes that are parts of the image instead, from 0 to 1."""


def objection(found: Candidates, size: tuple[int, int]) -> str | None:
    """Return why these boxes and scores are impossible; None if they are possible.

    `size` is the width and height of the network's input in pixels.
    """
    if not found.scores.size:
        return None
    low, high = float(np.min(found.scores)), float(np.max(found.scores))
    if not -_SLACK <= low <= high <= 1 + _SLACK:  # false for NaN, too
        return f"scores are {low:.3g} to {high:.3g}, and not 0 to 1"
    if not np.isfinite(found.boxes).all():
        return "boxes are not finite"
    corners = found.boxes.reshape(-1, 2, 2).astype(float)
    if 0 < np.abs(corners).max() <= _PARTS:
        return f"no coordinate of a box is above {np.abs(corners).max():.3g} pixels; they may be parts of the image"
    if np.mean((corners[:, 1] < corners[:, 0]).any(axis=1)) > _MOST:
        return "boxes end before they begin"
    middles = corners.mean(axis=1) / size
    outside = np.mean((np.abs(middles - 0.5) > 0.5 + _AROUND).any(axis=1))
    return f"{outside:.0%} of the boxes lie outside of the image" if outside > _MOST else None
