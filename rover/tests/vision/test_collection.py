"""What is taken from a stream, and what is said to be missing."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from roverkit.calibration import Collection, Offer
from roverkit.calibration.coverage import CELLS

from rover.tests.vision.board_frames import BOARD, PLACES, frame, frames

FRAME_NS = 33_000_000
MIDDLE = (0.5, 0.5)


class Hands:
    """Somebody who holds a board before the camera, each time for two frames."""

    def __init__(self, wanted: int = 20) -> None:
        self.collection = Collection(BOARD, wanted)
        self._stamp = 0

    def hold(self, image: NDArray[np.uint8]) -> Offer:
        """What became of the second frame."""
        self._stamp += 10**9
        assert not self.collection.offer(image, self._stamp).taken  # nobody knows yet that the board is still
        return self.collection.offer(image, self._stamp + FRAME_NS)


@pytest.mark.slow
def test_views_are_taken_until_nothing_is_missing() -> None:
    """What each adds is no longer missing; when all is there, the collection is complete and takes no more."""
    hands = Hands(wanted=10)
    for image in frames(24):
        before = hands.collection.missing
        offer = hands.hold(image)
        if offer.taken and len(hands.collection.views) > 10:
            assert set(offer.adds) <= set(before)
            assert offer.adds
        if hands.collection.complete:
            break
    assert hands.collection.complete
    assert 10 <= len(hands.collection.views) < 24
    assert hands.collection.coverage.cells.shape == CELLS[::-1]
    assert hands.collection.coverage.cells.min() >= 2
    assert "adds nothing" in hands.hold(frame((10, -25), (0.4, 0.6), 0.5)).reason


@pytest.mark.slow
def test_the_same_view_is_not_taken_twice() -> None:
    """But it is where somebody asks for it. A view that is discarded is missing again."""
    hands = Hands()
    untouched = hands.collection.missing
    assert hands.hold(frame((0, 20), MIDDLE, 0.3)).taken
    assert "same as a view taken before" in hands.hold(frame((0, 20), MIDDLE, 0.3, seed=1)).reason
    assert hands.collection.take(frame((0, 20), MIDDLE, 0.3, seed=2), 0, "by hand").taken
    assert [view.name for view in hands.collection.views] == ["", "by hand"]
    assert hands.collection.missing != untouched
    for view in hands.collection.views:
        hands.collection.discard(view)
    assert (hands.collection.missing, hands.collection.views) == (untouched, ())


@pytest.mark.parametrize(
    ("tilt", "name"),
    [
        ((0, 30), "right edge nearer"),
        ((0, -30), "left edge nearer"),
        ((-30, 0), "bottom edge nearer"),
        ((30, 0), "top edge nearer"),
    ],
)
def test_tilts_are_told_by_the_edge_that_is_nearer(tilt: tuple[float, float], name: str) -> None:
    """A turn about the image's y, which points down, brings the right edge to the camera."""
    assert Collection(BOARD).take(frame(tilt, MIDDLE, 0.45), 0).traits.tilts == {name}


@pytest.mark.parametrize(("distance", "name"), [(0.3, "near"), (0.45, "middle"), (0.65, "far")])
def test_distances_are_told_by_the_part_of_the_image(distance: float, name: str) -> None:
    """A board that fills most of the image is near, whatever the camera; one in the lower right adds that region."""
    traits = Collection(BOARD).take(frame((0, 0), MIDDLE, distance), 0).traits
    assert (traits.distance, traits.tilts) == (name, frozenset())
    offer = Collection(BOARD).take(frame((0, 0), PLACES[4], 0.62), 0)
    names = {need.name for need in offer.adds if need.kind == "region"}
    assert "lower right" in names
    assert not names & {"upper left", "upper", "left"}


@pytest.mark.slow
def test_frames_without_use_say_why() -> None:
    """No board; an image of another size than the views so far."""
    hands = Hands()
    assert hands.hold(np.full((480, 640), 128, np.uint8)).reason == "no board found"
    image = frame((0, 20), MIDDLE, 0.45)
    assert hands.hold(image).taken
    reason = hands.hold(cv2.resize(image, (320, 240))).reason
    assert "the image has 320x240 pixels, but the other views have 640x480" in reason
