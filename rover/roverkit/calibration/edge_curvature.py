"""Curvature that a lens gives to the edges of a board, from the positions of the corners along them.

Straight edges stay straight in perspective, so all curvature comes from the lens. A wide lens bends an edge by some
hundredths of a pixel within the window in which a corner is fitted. The error has the same direction in all views, so
the calibration could not notice it. Measured with a fisheye lens of 137 degrees and 640x480 pixels: with straight edges
the corners near the rim were off by 0.019 px towards the centre, with curved ones by 0.005 px.
"""

from __future__ import annotations

import numpy as np

from roverkit.vision.camera.camera_model import Floats

_EQUAL = 1e-6  # metres
_LARGEST = 0.02
"""Largest plausible curvature in 1/pixel; larger ones come from corners that are wrong."""


def edge_curvatures(points: Floats, places: Floats) -> Floats:
    """Return the curvature vectors (N, 2, 2) of the two edges through each corner of a board, in 1/pixel.

    `points` (N, 2) are the corners on the board, `places` (N, 2) their pixels. The first edge of a corner runs along
    the board's y, the second along its x. A curvature vector points to the centre of the circle that touches the edge,
    and its length is 1 / radius. It is 0 if fewer than three corners on the edge are known.
    """
    found = np.zeros((len(points), 2, 2))
    for edge, (across, along) in enumerate(((0, 1), (1, 0))):
        order = np.lexsort((points[:, along], np.round(points[:, across] / _EQUAL)))
        lines = np.split(order, np.flatnonzero(np.diff(points[order, across]) > _EQUAL) + 1)
        for line in lines:
            if len(line) < 3:
                continue
            steps = np.diff(places[line], axis=0)
            lengths = np.linalg.norm(steps, axis=1)[:, None]
            with np.errstate(invalid="ignore", divide="ignore"):
                inner = 2 * np.diff(steps / lengths, axis=0) / (lengths[1:] + lengths[:-1])
            found[line, edge] = np.concatenate([inner[:1], inner, inner[-1:]])  # the ends as their neighbours
    found[~(np.linalg.norm(found, axis=2) < _LARGEST)] = 0  # true for NaN too
    return found
