"""Detected objects: their positions, their numbers from frame to frame, the selected one, and what judges detectors."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from needs import NO_OPENCV, NO_SCIPY

pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
pytest.importorskip("scipy", reason=NO_SCIPY)

from roverkit.objects.detected_objects import Box, ObjectDetection, TrackedObject  # noqa: E402
from roverkit.objects.location import Location, locate  # noqa: E402
from roverkit.objects.metrics import average_precisions  # noqa: E402
from roverkit.objects.selection import KNOWN_NS, Scene, Selection, State  # noqa: E402
from roverkit.vision import CameraParameters, Pose  # noqa: E402  # they need OpenCV and SciPy
from roverkit.vision.poses.pose import rotation_of  # noqa: E402

if TYPE_CHECKING:
    from roverkit.objects.object_tracker import ObjectTracker

_S = 1_000_000_000


_CAMERA = CameraParameters(np.array([[600.0, 0, 320], [0, 610, 240], [0, 0, 1]]), np.array([0.1, -0.2, 0, 0, 0]))
_LENGTHS = st.floats(4, 200)


def _depth(distance: float) -> np.ndarray:
    return np.full((480, 640), distance)


@settings(max_examples=40)
@given(st.floats(0.3, 8.0), st.floats(0, 600), st.floats(0, 440), _LENGTHS, _LENGTHS)
def test_the_position_is_seen_at_the_middle_of_the_box(
    z: float, x: float, y: float, width: float, height: float
) -> None:
    """For any box in the image, whose lens bends."""
    box = Box(x, y, min(width, 640 - x), min(height, 480 - y))
    found = locate(box, _depth(z), _CAMERA)
    assert found
    assert found.point[2] == pytest.approx(z)
    assert _CAMERA.project(found.point) == pytest.approx([box.x + box.width / 2, box.y + box.height / 2], abs=1e-6)
    assert np.linalg.eigvalsh(found.covariance).min() > 0


@pytest.mark.parametrize(("missing", "value"), [(0.0, 0), (0.6, 0), (0.6, np.nan), (0.8, 0), (1.0, 0), (1.0, np.nan)])
def test_too_few_depths_give_no_position(missing: float, value: float) -> None:
    """At least 30 % of the middle must have a depth; outside a depth image that is smaller, there is none."""
    depth = _depth(2.0)
    depth[:, : round(640 * missing)] = value
    depth = np.random.default_rng(0).permuted(depth, axis=1)
    assert (locate(Box(200, 100, 200, 200), depth, _CAMERA) is None) == (missing > 0.7)
    assert locate(Box(700, 100, 20, 20), depth, _CAMERA) is None


def test_the_covariance_covers_the_error() -> None:
    """Boxes that are wrong by 5 % and depths that are wrong by 1 % give a normalized squared error of 3."""
    rng = np.random.default_rng(1)
    truth, nees = np.array([0.3, -0.2, 3.0]), []
    u, v = _CAMERA.project(truth)
    for _ in range(400):
        box = Box(u - 50 + rng.normal(0, 5), v - 30 + rng.normal(0, 3), 100, 60)
        found = locate(box, _depth(3 * (1 + rng.normal(0, 0.01))), _CAMERA)
        assert found
        error = found.point - truth
        nees.append(error @ np.linalg.solve(found.covariance, error))
    assert np.mean(nees) == pytest.approx(3, abs=0.5)


def test_a_position_goes_to_other_frames() -> None:
    """Its covariance turns with it."""
    one = Location(np.array([1.0, 2, 3]), np.diag([1.0, 4, 9]))
    other = one.through(Pose(rotation_of(np.array([0, 0, np.pi / 2])), np.array([10.0, 0, 0])))
    assert other.point == pytest.approx([8, 1, 3])
    assert np.diag(other.covariance) == pytest.approx([4, 1, 9])
    assert np.diag(one.after(2, 0.5).covariance) == pytest.approx([2, 5, 10])


_A, _B, _C = Box(0, 0, 10, 10), Box(20, 0, 10, 10), Box(40, 0, 10, 10)


@pytest.mark.parametrize(
    ("seen", "truth", "expected"),
    [
        ([(_A, "rock", 0.9), (_B, "plate", 0.3)], [("rock", _A), ("plate", _B)], {"rock": 1, "plate": 1}),
        ([(_A, "rock", 0.5), (_B, "rock", 0.9)], [("rock", _A)], {"rock": 0.5}),
        # An object that is found twice counts once; half of the objects are found: 51 of 101 recalls.
        ([(_A, "rock", 0.9), (_A, "rock", 0.8)], [("rock", _A), ("rock", _B)], {"rock": 51 / 101}),
        # Found, wrong, found, of three objects: 1 up to the recall 1/3, 2/3 up to 2/3, then 0.
        (
            [(_A, "rock", 0.9), (Box(99, 0, 9, 9), "rock", 0.8), (_B, "rock", 0.7)],
            [("rock", one) for one in (_A, _B, _C)],
            {"rock": (34 * 1 + 33 * 2 / 3) / 101},
        ),
    ],
)
def test_precision_is_interpolated_at_101_recalls(seen: list, truth: list, expected: dict[str, float]) -> None:
    """Of each class that the images show, by the scores of the detections."""
    found = average_precisions([([ObjectDetection(*one) for one in seen], truth)])
    assert found == {name: pytest.approx(one) for name, one in expected.items()}


_PERIOD_NS = 33_333_333
Frame = Sequence[tuple[int, ObjectDetection]]  # Detections of one frame, each with the true number of its object


def _seen(x: float, y: float, name: str = "rock", confidence: float = 0.8) -> ObjectDetection:
    return ObjectDetection(Box(x, y, 60.0, 60.0), name, confidence)


def _tracker() -> ObjectTracker:
    from roverkit.objects.object_tracker import ObjectTracker  # here: SciPy is a tenth of what the collection imports

    return ObjectTracker()


def _ids(frames: Iterable[Frame]) -> dict[int, set[int]]:
    """The numbers that each true object got."""
    tracker, given = _tracker(), dict[int, set[int]]()
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
        yield [
            (truth, _seen(x + rng.gauss(0, 1), y + rng.gauss(0, 1)))
            for truth, (x, y) in enumerate(((300 + way, 200), (300 - way, 205)))
            if rng.random() > 0.2 and not (truth == hidden and gap <= number < gap + 3)
        ]


def test_objects_that_cross_keep_their_numbers() -> None:
    """In 19 of 20 runs, with gaps, and with a fifth of the detections missing."""
    runs = [_ids(_crossing(random.Random(seed))) for seed in range(20)]  # noqa: S311  # no secrets
    kept = [len(given[0]) == len(given[1]) == 1 and given[0] != given[1] for given in runs]
    assert sum(kept) >= 19


def test_a_camera_that_sways_changes_no_numbers() -> None:
    """It sways by nearly an object's size, once in 2 s, and a tenth of the detections are missing."""
    rng = random.Random(3)  # noqa: S311  # no secrets
    shifts = [50 * math.sin(math.pi * max(number / 30 - 1, 0)) for number in range(200)]
    frames = (
        [
            (truth, _seen(60 + 110 * truth + shift + rng.gauss(0, 1), 200 + rng.gauss(0, 1)))
            for truth in range(5)
            if rng.random() > 0.1
        ]
        for shift in shifts
    )
    assert sorted(map(sorted, _ids(frames).values())) == [[number] for number in range(1, 6)]


class _Tracked:
    """A tracker that is shown the same detections for some frames; the number of the frame goes on."""

    def __init__(self) -> None:
        self._tracker, self.number = _tracker(), 0

    def show(self, frames: int, *detections: ObjectDetection) -> list[TrackedObject]:
        for _ in range(frames):
            shown = self._tracker.track(detections, self.number * _PERIOD_NS)
            self.number += 1
        return shown


def test_numbers_rise_from_1_and_are_never_used_again() -> None:
    """0 is what a selection has if none is set. What returns after it was forgotten, or after a jump back, is new."""
    tracked = _Tracked()
    ids = [one.id for place in range(3) for one in tracked.show(2, _seen(200 * place, 100))]
    assert tracked.show(40) == []
    ids += [one.id for one in tracked.show(3, _seen(0, 100))]
    tracked.number = 0
    ids += [one.id for one in tracked.show(2, _seen(0, 100))]
    assert ids == [1, 2, 3, 4, 5]


@pytest.mark.parametrize("seconds", [1, 2, 5])
def test_a_slow_detector_sees_the_same_objects(seconds: int) -> None:
    """Objects are forgotten after three periods, if that is longer than a second."""
    tracker, detections = _tracker(), [_seen(100 + 150 * place, 100) for place in range(3)]
    shown = [tracker.track(detections, number * seconds * _S) for number in range(5)]
    assert [[one.id for one in objects] for objects in shown] == [[], *[[1, 2, 3]] * 4]


def test_an_error_of_one_frame_is_no_object() -> None:
    """Neither is what the detector never was certain of."""
    tracked = _Tracked()
    assert tracked.show(1, _seen(100, 100)) == []
    assert tracked.show(5, _seen(300, 100, confidence=0.25)) == []


def test_an_object_is_what_most_detections_say_where_the_newest_one_is() -> None:
    """Its confidence falls slowly, and one wrong class does not change it; its box is not smoothed."""
    tracked = _Tracked()
    tracked.show(5, _seen(100, 100, "socket", 0.9))
    (one,) = tracked.show(5, _seen(100, 100, "socket", 0.3))
    assert (one.id, 0.6 < one.confidence < 0.9) == (1, True)
    moved = _seen(104, 97, "switch", 0.99)
    (one,) = tracked.show(1, moved)
    assert (one.id, one.class_name, one.box is moved.box) == (1, "socket", True)


_BASE, _MAP = (Pose(np.eye(3), np.array([x, 0, 0])) for x in (0.5, 10.0))
"""From the camera to the rover, and to the field."""


def _scene(*numbers: int, to_map: Pose | None = _MAP) -> Scene:
    return Scene({one: Location(np.array([one, 0.0, 1.0]), np.eye(3) / 100) for one in numbers}, _BASE, to_map)


def _selected(number: int, scene: Scene, hold_s: int = 5) -> Selection:
    selection = Selection(hold_s * _S)
    selection.see(scene, 0)
    assert selection.select(number, 0)
    return selection


def test_a_hidden_object_stays_on_the_field() -> None:
    """The rover drives on, the covariance grows, and after the time to hold it is lost."""
    selection = _selected(3, _scene(3))
    assert (selection.object, selection.state) == (3, State.VISIBLE)
    assert selection.place(0, None).in_base.point == pytest.approx([3.5, 0, 1])
    for tenth in range(1, 21):
        selection.see(_scene(), tenth * _S // 10)
    assert selection.state is State.HELD
    place = selection.place(2 * _S, Pose(np.eye(3), np.array([-11.0, 0, 0])))
    assert place.in_map.point == pytest.approx([13, 0, 1])
    assert place.in_base.point == pytest.approx([2, 0, 1])
    assert np.diag(place.in_map.covariance) == pytest.approx([0.05] * 3)
    selection.update(5 * _S)
    assert selection.state is State.HELD
    selection.update(5 * _S + 1)
    assert selection.state is State.LOST


def test_an_unknown_object_is_refused() -> None:
    """The selection stays as it was; an object can be selected for a while after it was seen, and is then forgotten."""
    selection = _selected(3, _scene(3), 60)
    assert not selection.select(4, 0)
    assert selection.object == 3
    for tenth in range(20):
        selection.see(_scene(4), 1 + tenth * _S // 10)
    selection.see(_scene(5), KNOWN_NS + 1)
    assert selection.known(KNOWN_NS + 1) == [4, 5]
    assert not selection.select(3, KNOWN_NS + 1)
    assert (selection.object, selection.state) == (3, State.HELD)
    assert selection.select(4, KNOWN_NS + 1)
    selection.clear()
    assert (selection.object, selection.state) == (None, State.NONE)
    for number in range(3, 103):
        selection.see(_scene(number), number * _S)
    assert len(selection.known(102 * _S)) == 4  # of three periods


def test_a_slow_detector_keeps_its_object_visible() -> None:
    """With an image in 2 s, an object is visible between the images, and not held, or lost after 1 s."""
    selection, states = _selected(3, _scene(3), 1), set()
    selection.see(_scene(3), 2 * _S)
    for number in range(2, 9):
        selection.update(2 * number * _S - 1)
        states.add(selection.state)
        selection.see(_scene(3), 2 * number * _S)
    assert states == {State.VISIBLE}


@pytest.mark.parametrize(
    ("xs", "to_map", "state"),
    [
        ((3.05, 3.0, 3.1), _MAP, State.VISIBLE),
        ((1.0, 1.0, 1.0), _MAP, State.LOST),
        ((1.0, 1.0, 1.0), None, State.LOST),
        ((1.0, 1.0, 3.0), _MAP, State.VISIBLE),  # a depth that was wrong twice
        ((3.15, 3.3, 3.45), None, State.VISIBLE),  # the rover drives 1.5 m/s
    ],
)
def test_an_object_that_is_suddenly_elsewhere_is_lost(xs: Sequence[float], to_map: Pose | None, state: State) -> None:
    """The tracker has taken another object for it: an arm must not grip that one."""
    selection = _selected(3, _scene(3, to_map=to_map))
    for number, x in enumerate(xs, 1):
        scene = Scene({3: Location(np.array([x, 0.0, 1.0]), np.eye(3) / 1e4)}, _BASE, to_map)
        assert selection.see(scene, number * _S // 10) == (abs(x - 3) < 1)
    assert selection.state is state
