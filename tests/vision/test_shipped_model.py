"""The model that ships with roverlink, on rendered scenes that it has not learnt."""

from __future__ import annotations

from statistics import mean

import pytest
from needs import NO_ONNX, NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("onnxruntime", reason=NO_ONNX)
pytest.importorskip("scipy", reason=NO_ONNX)

from bench.vision.objects import detected, idf1, perfect, sequences  # they need OpenCV
from roverlink.vision.objects.detector import ObjectDetector
from roverlink.vision.objects.metrics import average_precisions
from roverlink.vision.objects.object_tracker import ObjectTracker
from roverlink.vision.objects.scenes import CLASSES, scenes
from roverlink.vision.objects.shipped_model import PATH


@pytest.fixture(scope="module")
def detector() -> ObjectDetector:
    return ObjectDetector(PATH, score=0.01)


def test_it_is_small_and_names_its_classes(detector: ObjectDetector) -> None:
    """So it needs no classes.yaml."""
    assert PATH.stat().st_size < 5_000_000
    assert detector.class_names == CLASSES


@pytest.mark.slow
def test_it_finds_the_objects_of_other_scenes(detector: ObjectDetector) -> None:
    """mAP50 is at least 0.9 with another seed than that of the training."""
    results = (
        (detector.detect(scene.image), [(one.class_name, one.box) for one in scene.objects])
        for scene in scenes(77, 150)
    )
    assert mean(average_precisions(results).values()) >= 0.9


@pytest.mark.slow
def test_objects_keep_their_numbers_in_rendered_sequences() -> None:
    """IDF1 is at least 0.95; if a fifth of the boxes is missing, it is at least 0.8 (0.89 is the largest possible)."""
    detector = ObjectDetector(PATH)
    found = [(idf1(detected(film, detector), ObjectTracker()), film) for film in sequences(4, 45)]
    assert mean(value for value, _ in found) >= 0.95
    for _, film in found:
        assert idf1(perfect(film, 0.2), ObjectTracker()) >= 0.8
