"""Edge fit of detected markers, with tests of the result, and at a lower resolution if the full one fails.

The edge fit compares pixels that are at most one pixel away from the expected edges. If the edges are farther away, it
fails: if the corners were found several pixels off, or if the modules of a large marker were printed with unequal
sizes. In an image of half the size, they are only half as far away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.markers.detection import Image
from roverkit.vision.markers.edges import Fit, Guess, fit_edges
from roverkit.vision.opencv import cv2

EXPLAINED = 0.75
"""Least share of the pixels' variance that a marker's pattern must explain; patterns that are no markers stay below."""
DOUBTFUL_EXPLAINED = 0.9
"""The same for a marker that was read with many wrong cells."""
CONTRAST = 8.0
"""Least difference between white and black of a marker, in grey levels."""
SHRUNK = (1, 2, 4)
"""Factors by which the image is made smaller, one after the other, until the fit succeeds."""
LEAST_SIDE = 40.0
"""Extent in pixels that a marker must keep in a smaller image."""


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """Good fit of a marker, with its corners (4, 2) in pixels of the whole image."""

    fit: Fit
    corners: Floats
    shrunk: int
    """Factor by which the image was made smaller for the fit."""
    blur: float
    """Standard deviation of the blur in pixels of the whole image."""


def fit_markers(image: Image, camera: CameraParameters, guesses: Sequence[Guess]) -> list[Fitted | None]:
    """Fit the edges of markers in a grey image (H, W); the result for a marker is None if it has no good fit."""
    fitted: list[Fitted | None] = [None] * len(guesses)
    for shrunk in SHRUNK:
        left = [
            place
            for place, guess in enumerate(guesses)
            if fitted[place] is None and (shrunk == 1 or extent(guess.corners) >= LEAST_SIDE * shrunk)
        ]
        if not left:
            break
        smaller, its_camera = _smaller(image, camera, shrunk)
        fits = fit_edges(smaller, its_camera, [_in_smaller(guesses[place], shrunk) for place in left])
        good = {
            place: fit
            for place, fit in zip(left, fits)
            if fit
            and fit.explained > (DOUBTFUL_EXPLAINED if guesses[place].doubtful else EXPLAINED)
            and fit.contrast > CONTRAST
        }
        rays = np.array([fit.rays for fit in good.values()]).reshape(-1, 4, 2)
        for (place, fit), corners in zip(good.items(), camera.distort(rays)):
            fitted[place] = Fitted(fit, corners, shrunk, fit.blur * shrunk)
    return fitted


def extent(corners: Floats) -> float:
    """Return the mean of width and height in pixels of a marker with these corners (4, 2)."""
    return float((corners.max(axis=0) - corners.min(axis=0)).mean())


def _smaller(image: Image, camera: CameraParameters, shrunk: int) -> tuple[Image, CameraParameters]:
    if shrunk == 1:
        return image, camera
    height, width = (pixels // shrunk for pixels in image.shape)
    whole = image[: height * shrunk, : width * shrunk]
    smaller: Image = cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA)
    return smaller, replace(camera, size=(width * shrunk, height * shrunk)).scaled((width, height))


def _in_smaller(guess: Guess, shrunk: int) -> Guess:
    if shrunk == 1:
        return guess
    # the first pixel of the smaller image has its centre between the first `shrunk` pixels of each row
    return replace(guess, corners=(guess.corners + 0.5) / shrunk - 0.5, blur=guess.blur / shrunk)
