"""The ways to look for markers."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from bench.vision.scenes import Scene, scenes
from roverlink.vision.markers.detection import Detection, Detector, Image, Region
from roverlink.vision.markers.marker_set import MarkerSet

MARKERS = MarkerSet()


@pytest.fixture(scope="module")
def film() -> Sequence[Scene]:
    """Frames with markers of 64 pixels."""
    return list(scenes(64, 16, 200))


def look_around(image: Image) -> list[Detection]:
    """Look at all but the outer pixels, as a region."""
    height, width = image.shape
    return Detector(MARKERS).look(image, Region(3, 5, width - 1, height - 2))


@pytest.mark.parametrize("way", [Detector(MARKERS).scan, Detector(MARKERS).scan_quickly, look_around])
def test_corners_count_from_the_centres_of_the_frame_s_pixels(
    film: Sequence[Scene], way: Callable[[Image], list[Detection]]
) -> None:
    """No way to look shifts the corners, whatever OpenCV's version: a lost half pixel would be seen here."""
    offsets = []
    for scene in film:
        offsets += [
            (one.corners - scene.corners).mean(axis=0) for one in way(scene.frame) if one.number == scene.number
        ]
    assert len(offsets) >= len(film) - 1
    assert np.mean(offsets, axis=0) == pytest.approx([0, 0], abs=0.15)


def test_only_markers_with_a_side_are_found(film: Sequence[Scene]) -> None:
    """Where there is no side for all, other numbers are none of ours."""
    scene = film[0]
    assert Detector(MarkerSet(side=None, sides={(scene.number + 1) % 250: 0.1})).scan(scene.frame) == []
    assert Detector(MarkerSet(side=None, sides={scene.number: 0.1})).scan(scene.frame)


def test_a_region_too_small_to_hold_a_marker_has_none(film: Sequence[Scene]) -> None:
    """At the frame's rim a region may be a few pixels wide, or empty."""
    assert Detector(MARKERS).look(film[0].frame, Region(0, 0, 5, 200)) == []
    assert Detector(MARKERS).look(film[0].frame, Region(10, 10, 10, 10)) == []
