"""Quality of detectors: average precision, by hand and by known cases."""

from __future__ import annotations

import pytest
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverlink.vision.objects.detected_objects import Box, Detection
from roverlink.vision.objects.metrics import average_precisions, overlap

_A, _B, _C = Box(0, 0, 10, 10), Box(20, 0, 10, 10), Box(40, 0, 10, 10)


def _seen(box: Box, score: float, name: str = "rock") -> Detection:
    return Detection(box, name, score)


@pytest.mark.parametrize(
    ("other", "expected"),
    [(_A, 1), (_B, 0), (Box(5, 0, 10, 10), 1 / 3), (Box(0, 0, 5, 5), 0.25), (Box(10, 0, 10, 10), 0)],
)
def test_overlap_is_intersection_over_union(other: Box, expected: float) -> None:
    """Of any two boxes, in both orders."""
    assert overlap(_A, other) == pytest.approx(expected)
    assert overlap(other, _A) == pytest.approx(expected)


def test_a_perfect_detector_has_the_precision_1() -> None:
    """Of each class that the images show."""
    images = [([_seen(_A, 0.9), _seen(_B, 0.3, "plate")], [("rock", _A), ("plate", _B)])]
    assert average_precisions(images) == {"rock": 1.0, "plate": 1.0}


def test_a_wrong_detection_counts_by_its_score() -> None:
    """Above all right ones it halves the precision; below all of them, it costs nothing."""
    truth = [("rock", _A)]
    assert average_precisions([([_seen(_A, 0.9), _seen(_B, 0.1)], truth)]) == {"rock": 1.0}
    assert average_precisions([([_seen(_A, 0.5), _seen(_B, 0.9)], truth)]) == {"rock": 0.5}


def test_an_object_that_is_found_twice_counts_once() -> None:
    """The second box is a wrong detection. Half of the objects are found: the recalls 0 to 0.5 are 51 of 101."""
    images = [([_seen(_A, 0.9), _seen(_A, 0.8)], [("rock", _A), ("rock", _B)])]
    assert average_precisions(images) == {"rock": pytest.approx(51 / 101)}


def test_precision_is_interpolated_at_101_recalls() -> None:
    """Found, wrong, found, of three objects: 1 up to the recall 1/3, 2/3 up to 2/3, then 0."""
    images = [([_seen(_A, 0.9), _seen(Box(99, 0, 9, 9), 0.8), _seen(_B, 0.7)], [("rock", one) for one in (_A, _B, _C)])]
    assert average_precisions(images) == {"rock": pytest.approx((34 * 1 + 33 * 2 / 3) / 101)}


def test_the_same_class_is_needed() -> None:
    """A class that no image shows has no precision."""
    assert average_precisions([([_seen(_A, 0.9, "plate")], [("rock", _A)])]) == {"rock": 0.0}
    assert average_precisions([([], [])]) == {}
