"""Numbers of detected objects: they stay with an object, and are never used again."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st
from needs import NO_SCIPY

pytest.importorskip("numpy", reason=NO_SCIPY)
pytest.importorskip("scipy", reason=NO_SCIPY)

from roverlink.vision.objects.detected_objects import Box, Detection, TrackedObject
from roverlink.vision.objects.object_tracker import CERTAIN, ObjectTracker

_PERIOD_NS = 33_333_333
_SIDE = 60.0

Frame = Sequence[tuple[int, Detection]]
"""Detections of one frame, each with the true number of its object."""


def _seen(x: float, y: float, name: str = "rock", confidence: float = 0.8) -> Detection:
    return Detection(Box(x, y, _SIDE, _SIDE), name, confidence)


def _ids(frames: Iterable[Frame]) -> dict[int, set[int]]:
    """The numbers that each true object got."""
    tracker = ObjectTracker()
    given: dict[int, set[int]] = {}
    for number, frame in enumerate(frames):
        for one in tracker.track([detection for _, detection in frame], number * _PERIOD_NS):
            truth = next(truth for truth, detection in frame if detection.box is one.box)
            given.setdefault(truth, set()).add(one.id)
    return given


def _crossing(rng: random.Random) -> Iterator[Frame]:
    """Two objects that pass each other; every fifth detection is missing, and three frames in succession of one."""
    speed, gap, hidden = rng.uniform(200, 500), rng.randrange(20, 70), rng.randrange(2)
    for number in range(90):
        way = speed * (number / 90 - 0.5)
        places = ((300 + way, 200), (300 - way, 205))
        yield [
            (truth, _seen(x + rng.gauss(0, 1), y + rng.gauss(0, 1)))
            for truth, (x, y) in enumerate(places)
            if rng.random() > 0.2 and not (truth == hidden and gap <= number < gap + 3)
        ]


def test_objects_that_cross_keep_their_numbers() -> None:
    """Also with gaps, and with a fifth of the detections missing."""
    for seed in range(60):
        given = _ids(_crossing(random.Random(seed)))  # noqa: S311  # no secrets
        assert [len(ids) for ids in given.values()] == [1, 1], seed
        assert given[0] != given[1], seed


@pytest.mark.parametrize(("pixels", "hertz"), [(50, 0.5), (100, 1.0), (50, 2.0)])
def test_a_camera_that_shakes_changes_no_numbers(pixels: float, hertz: float) -> None:
    """What most objects have in common is the motion of the camera."""
    rng = random.Random(3)  # noqa: S311  # no secrets

    def frames() -> Iterator[Frame]:
        for number in range(200):
            shift = pixels * math.sin(2 * math.pi * hertz * max(number / 30 - 1, 0))
            yield [
                (truth, _seen(60 + 110 * truth + shift + rng.gauss(0, 1), 200 + rng.gauss(0, 1)))
                for truth in range(5)
                if rng.random() > 0.1
            ]

    assert sorted(map(sorted, _ids(frames()).values())) == [[number] for number in range(1, 6)]


def _shown(tracker: ObjectTracker, detections: Sequence[Detection], frames: int, since: int = 0) -> list[TrackedObject]:
    for number in range(since, since + frames):
        shown = tracker.track(detections, number * _PERIOD_NS)
    return shown


def test_a_number_is_never_used_again() -> None:
    """An object that returns after it was forgotten is a new one."""
    tracker = ObjectTracker()
    (first,) = _shown(tracker, [_seen(100, 100)], 3)
    assert _shown(tracker, [], 40, since=3) == []
    (second,) = _shown(tracker, [_seen(100, 100)], 3, since=43)
    assert (first.id, second.id) == (1, 2)


def test_an_error_of_one_frame_is_no_object() -> None:
    """Neither is what the detector never was certain of."""
    tracker = ObjectTracker()
    assert tracker.track([_seen(100, 100)], 0) == []
    assert _shown(tracker, [_seen(300, 100, confidence=CERTAIN / 2)], 5, since=1) == []


def test_an_object_stays_while_the_detector_is_uncertain() -> None:
    """Its confidence falls slowly."""
    tracker = ObjectTracker()
    _shown(tracker, [_seen(100, 100, confidence=0.9)], 5)
    (one,) = _shown(tracker, [_seen(100, 100, confidence=0.3)], 5, since=5)
    assert (one.id, 0.6 < one.confidence < 0.9) == (1, True)


def test_the_class_is_that_of_most_detections() -> None:
    """One wrong class does not change it."""
    tracker = ObjectTracker()
    _shown(tracker, [_seen(100, 100, "socket")], 5)
    (one,) = tracker.track([_seen(100, 100, "switch", 0.99)], 5 * _PERIOD_NS)
    assert (one.id, one.class_name) == (1, "socket")


def test_the_box_is_that_of_the_detection() -> None:
    """It is not smoothed: the operator sees it in the image."""
    tracker = ObjectTracker()
    tracker.track([_seen(100, 100)], 0)
    moved = _seen(104, 97)
    (one,) = tracker.track([moved], _PERIOD_NS)
    assert one.box is moved.box


def test_a_clock_that_jumps_back_begins_anew() -> None:
    """Predictions across the jump would be wrong; the numbers go on."""
    tracker = ObjectTracker()
    _shown(tracker, [_seen(100, 100)], 3, since=100)
    (one,) = _shown(tracker, [_seen(100, 100)], 2)
    assert one.id == 2


_BOXES = st.tuples(st.floats(0, 600), st.floats(0, 400), st.floats(1, 200), st.floats(1, 200))


@given(st.lists(st.lists(st.tuples(_BOXES, st.floats(0, 1)), max_size=6), max_size=12))
def test_each_detection_has_at_most_one_number(frames: list[list[tuple[tuple[float, ...], float]]]) -> None:
    """Whatever is detected, the numbers of a frame differ, and each box is one of those that were detected."""
    tracker = ObjectTracker()
    for number, frame in enumerate(frames):
        detections = [Detection(Box(*box), "rock", confidence) for box, confidence in frame]
        shown = tracker.track(detections, number * _PERIOD_NS)
        assert len({one.id for one in shown}) == len({id(one.box) for one in shown}) == len(shown)
        assert {id(one.box) for one in shown} <= {id(one.box) for one in detections}


def test_the_numbers_of_a_run_rise() -> None:
    """From 1, because 0 is what a selection has if none is set."""
    tracker = ObjectTracker()
    ids = [one.id for place in range(3) for one in _shown(tracker, [_seen(200 * place, 100)], 2, since=2 * place)]
    assert ids == [1, 2, 3]
