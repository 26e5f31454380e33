"""Which dictionary the visible markers are of, if not of the chosen one."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest

from bench.vision.contestants import camera_of
from bench.vision.scenes import SIDE, lens, random_pose
from roverlink.vision import MarkerSet
from roverlink.vision.images.rendering import Grey, marker_print, render, texture
from roverlink.vision.markers.dictionaries import other_dictionary

SIZE = (320, 240)
LENS = lens(*SIZE)


def photograph(dictionary: str, numbers: Sequence[int]) -> Grey:
    rng = np.random.default_rng(8)
    prints = [marker_print(getattr(cv2.aruco, dictionary), number, SIDE, texels=8) for number in numbers]
    planes = [(plane, random_pose(LENS, 50, rng)) for plane in prints]
    return render(LENS, texture(SIZE, rng), planes, rng)


@pytest.mark.parametrize(
    ("shown", "number", "expected"),
    [
        ("DICT_4X4_50", 3, "DICT_4X4_50"),
        ("DICT_6X6_1000", 120, "DICT_6X6_250"),
        ("DICT_5X5_1000", 700, "DICT_5X5_1000"),
        ("DICT_APRILTAG_36h11", 20, "DICT_APRILTAG_36h11"),
        ("DICT_ARUCO_ORIGINAL", 60, "DICT_ARUCO_ORIGINAL"),
    ],
)
def test_it_is_the_smallest_that_has_them(shown: str, number: int, expected: str) -> None:
    """The dictionaries of a family contain each other; the smallest one mistakes the fewest squares for markers."""
    assert other_dictionary(photograph(shown, [number]), camera_of(LENS), MarkerSet()) == (expected, [number])


@pytest.mark.parametrize("numbers", [[], [30]])
def test_without_other_markers_there_is_none(numbers: Sequence[int]) -> None:
    """Neither the texture of the background nor a marker of the chosen dictionary makes one."""
    assert other_dictionary(photograph("DICT_5X5_250", numbers), camera_of(LENS), MarkerSet("DICT_5X5_100")) is None
