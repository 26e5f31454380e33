"""What the bench measures, with few poses and wide margins; the slow tests measure as much as was promised."""

from __future__ import annotations

from statistics import mean

import cv2
import numpy as np
import pytest
from needs import NO_ONNX
from roverkit.vision import CameraParameters, MarkerSet, Pose, Tracker, read_parameters
from roverkit.vision.poses.pose import rotation_of

from rover.bench.vision import nothing
from rover.bench.vision.accuracy import OURS, measure_size, nees_band
from rover.bench.vision.consistency import DEGRADATIONS, GOAL, IMAGE, measure_degradation
from rover.bench.vision.finding import found_share, new_waits
from rover.bench.vision.lenses import measure_runs as measure_lenses
from rover.bench.vision.photographs import PHOTOS, finder, fit

GOALS = {24: (95, 0.3, 1.5, 0.7, np.inf), 48: (99, 0.08, 0.25, 0.12, 0.6), 96: (99, 0.04, 0.10, 0.06, 0.25)}
"""By side in pixels: detected %, translation median and p95 in %, rotation median and p95 in degrees."""
ROOM = PHOTOS / "room"  # Photographs that nobody of this project took
CASES = PHOTOS.parent / "cases" / "vision"
APRILTAG = "OpenCV APRILTAG"
BY_NAME = {one.name: one for one in DEGRADATIONS}


@pytest.mark.parametrize(
    ("side_px", "poses"),
    [pytest.param(48, 12, marks=pytest.mark.slow)]
    + [pytest.param(side_px, 200, marks=pytest.mark.exhaustive) for side_px in GOALS],
)
def test_poses_are_as_accurate_as_promised(side_px: int, poses: int) -> None:
    """Two hundred poses reach the goals, and the NEES its band; of a dozen, one may be missed."""
    (found,) = (one for one in measure_size(side_px, poses, names=[OURS]) if one.contestant == OURS)
    detected, *goals = GOALS[side_px]
    assert found.detected >= (detected if poses == 200 else 100 * 11 / 12 - 0.01)
    assert found.false_ids == 0
    assert found.flips <= (0 if side_px >= 48 else 3)  # %; below, one frame cannot always decide
    figures = found.translation_median, found.translation_p95, found.rotation_median, found.rotation_p95
    assert np.less(figures, goals).all(), figures
    low, high = nees_band(poses)
    assert poses < 200 or 6 - 1.7 * (6 - low) < found.nees < 6 + 1.7 * (high - 6)  # the band, widened to 99.9 %


@pytest.mark.opencv
@pytest.mark.slow
@pytest.mark.skipif(not ROOM.is_dir(), reason="need the photographs of a room (../shared/photos)")
def test_markers_in_photographs_are_seen_and_nothing_else() -> None:
    """On the walls of a room, at one photograph a second: more than OpenCV finds, no other, and of others none."""
    camera = CameraParameters(np.array([[700.0, 0, 408], [0, 700, 306], [0, 0, 1]]), np.zeros(5), (816, 612))
    listed = [line.split() for line in (ROOM / "markers.txt").read_text(encoding="utf-8").splitlines()]
    tags, others = Tracker(camera, MarkerSet("DICT_APRILTAG_36h11")), Tracker(camera, MarkerSet())
    plain, found = finder("OpenCV", "DICT_APRILTAG_36h11", camera), []
    for second, (name, *ids) in enumerate(listed):
        image = cv2.imread(str(ROOM / name), cv2.IMREAD_GRAYSCALE)
        seen = {str(one.id) for one in tags.track(image, second * 10**9)}
        assert seen <= set(ids), name
        assert others.track(image, second * 10**9) == (), name
        found.append((len(seen), len({*map(str, plain(image))} & set(ids)), len(ids)))
    ours, theirs, there = np.sum(found, axis=0)
    assert ours > max(theirs, 0.87 * there)


@pytest.mark.slow
@pytest.mark.skipif(not PHOTOS.is_dir(), reason="need the photographs of a board (../shared/photos)")
def test_corners_in_photographs_are_those_of_the_printed_board() -> None:
    """Every marker is found, to a third of a pixel; on all photographs it is 0.275, and OpenCV's best has 0.377."""
    found = fit(PHOTOS / "board", OURS, stride=4)
    assert found.markers >= 11 * 20 - 2
    assert found.rms < 0.32


@pytest.mark.skipif(not CASES.is_dir(), reason="need the rendered cases (../shared/cases/vision)")
@pytest.mark.parametrize(
    ("case", "number", "wrong", "right"),
    [("penumbra_flip_32px", 176, 47, (2.41, -1.55, 0.0)), ("motion_flip_24px", 226, 38, None)],
)
def test_a_pose_that_may_be_the_other_one_says_so(
    case: str, number: int, wrong: float, right: tuple[float, float, float] | None
) -> None:
    """The chosen pose was wrong by so many degrees, and claimed one; it is now that of APRILTAG, or says so."""
    tracker = Tracker(read_parameters(CASES / "camera_render.yml"), MarkerSet(side=0.15))
    (found,) = tracker.track(cv2.imread(str(CASES / case / "0.png"), cv2.IMREAD_GRAYSCALE), 0)
    assert found.id == number
    if right is None:
        assert 3 * np.degrees(np.sqrt(np.trace(found.covariance[3:, 3:]))) > wrong
    else:
        assert found.pose.angle_to(Pose(rotation_of(np.array(right)), found.pose.translation)) < np.radians(5)


@pytest.mark.skipif(not CASES.is_dir(), reason="need the rendered cases (../shared/cases/vision)")
def test_a_highlight_on_a_part_of_a_marker_does_not_move_it() -> None:
    """The translation is better than that of APRILTAG's corners, which is off by 0.07 %; it was off by 0.29 %."""
    tracker = Tracker(read_parameters(CASES / "camera_render.yml"), MarkerSet(side=0.15))
    (found,) = tracker.track(cv2.imread(str(CASES / "glare_48px" / "0.png"), cv2.IMREAD_GRAYSCALE), 0)
    truth = np.array([0.69931, -0.51353, 1.91781])
    assert np.linalg.norm(found.pose.translation - truth) < 0.0006 * np.linalg.norm(truth)


@pytest.mark.slow
@pytest.mark.opencv
@pytest.mark.parametrize("frames", [8, pytest.param(500, marks=pytest.mark.exhaustive)])
def test_nothing_is_seen_where_nothing_is(frames: int) -> None:
    """Rendered textures, boxes and chequers are no markers."""
    assert nothing.measure(frames, lambda _: None).data["false_ids"][OURS] == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["white balance, clipped", "JPEG q20", "print of 100 px", "side 1 % too small", "highlight 0.7"]
)
def test_covariances_are_never_far_too_confident(name: str) -> None:
    """The mean NEES of some markers of 48 px stays below that of standard deviations that are 4 times too small."""
    (ours,) = measure_degradation(BY_NAME[name], 48, 5, (OURS,))
    assert ours.count == 5
    assert ours.too_confident < GOAL


@pytest.mark.slow
@pytest.mark.parametrize("name", ["motion blur 6 px", "highlight 0.3"])
def test_corners_are_better_than_those_of_apriltag(name: str) -> None:
    """A blur along one direction, and light that varies over the marker, are part of the model of the edge fit."""
    ours, other = measure_degradation(BY_NAME[name], 96, 6, (IMAGE, APRILTAG))
    assert ours.translation_median < other.translation_median
    assert ours.rotation_median < other.rotation_median


@pytest.mark.slow
def test_markers_are_found_soon_though_covered_or_blurred() -> None:
    """A patch over a part of a marker's interior, and a new marker out of focus, which is seen within three frames."""
    assert found_share("patched", 96, 8).ours >= 75
    assert new_waits("defocus 2 px", 24, 3)[0].soon == 100


@pytest.mark.exhaustive
def test_the_intervals_of_all_lenses_hold_the_truth() -> None:
    """From images, with a narrow, a wide and a fisheye lens."""
    ours = [run for run in measure_lenses(2) if run.contestant == OURS]
    assert np.mean([run.inside for run in ours]) >= 0.9
    assert max(run.projection for run in ours) < 0.3


def test_the_shipped_model_is_small_and_names_its_classes() -> None:
    """So it needs no classes.yaml."""
    pytest.importorskip("onnxruntime", reason=NO_ONNX)
    from roverkit.objects.detector import ObjectDetector
    from roverkit.objects.scenes import CLASSES
    from roverkit.objects.shipped_model import PATH

    assert PATH.stat().st_size < 5_000_000
    assert ObjectDetector(PATH).class_names == CLASSES


@pytest.mark.exhaustive
def test_the_shipped_model_finds_the_objects_of_other_scenes() -> None:
    """With another seed than that of the training, mAP50 is at least 0.9 and IDF1 0.95.

    If a fifth of the boxes is missing, IDF1 is at least 0.8 (0.89 is the largest possible).
    """
    for module in ("onnx", "onnxruntime", "scipy"):
        pytest.importorskip(module, reason=NO_ONNX)
    from roverkit.objects.detector import ObjectDetector
    from roverkit.objects.metrics import average_precisions
    from roverkit.objects.object_tracker import ObjectTracker
    from roverkit.objects.scenes import scenes
    from roverkit.objects.shipped_model import PATH

    from rover.bench.vision.objects import detected, idf1, perfect, sequences

    all_of, sure = ObjectDetector(PATH, score=0.01), ObjectDetector(PATH)
    truths = ((scene.image, [(one.class_name, one.box) for one in scene.objects]) for scene in scenes(77, 150))
    assert mean(average_precisions((all_of.detect(image), truth) for image, truth in truths).values()) >= 0.9
    films = list(sequences(4, 45))
    assert mean(idf1(detected(film, sure), ObjectTracker(certain=sure.certain)) for film in films) >= 0.95
    assert min(idf1(perfect(film, 0.2), ObjectTracker()) for film in films) >= 0.8
