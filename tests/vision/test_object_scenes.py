"""Rendered scenes: the same for a seed, and with true boxes, depths and positions."""

from __future__ import annotations

import pytest
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)

from roverlink.vision.objects.location import locate  # noqa: E402  # they need OpenCV
from roverlink.vision.objects.scenes import CAMERA, CLASSES, RenderedScene, scenes, sequence  # noqa: E402
from roverlink.vision.objects.scenes.panel_parts import PARTS, draw_part  # noqa: E402


@pytest.fixture(scope="module")
def some() -> list[RenderedScene]:
    return list(scenes(5, 12))


def test_a_seed_gives_the_same_scenes(some: list[RenderedScene]) -> None:
    """Pixel by pixel; another seed gives others."""
    again, other = next(scenes(5, 1)), next(scenes(6, 1))
    assert (again.image == some[0].image).all()
    assert [(one.class_name, one.box) for one in again.objects] == [
        (one.class_name, one.box) for one in some[0].objects
    ]
    assert (other.image != some[0].image).any()


def test_there_are_rocks_and_all_parts_of_panels(some: list[RenderedScene]) -> None:
    """Every image has an object, and boxes lie inside the image."""
    assert {one.class_name for scene in some for one in scene.objects} == set(CLASSES)
    for scene in some:
        assert scene.image.shape == (480, 640, 3)
        assert scene.objects
        for one in scene.objects:
            assert 0 <= one.box.x < one.box.x + one.box.width <= 640
            assert 0 <= one.box.y < one.box.y + one.box.height <= 480
            assert min(one.box.width, one.box.height) >= 9


def test_the_classes_are_types_of_the_proto() -> None:
    """So the shipped model needs no classes.yaml."""
    from generated.messages import BasestationDetectedObject

    assert all(hasattr(BasestationDetectedObject, f"OBJECT_{name.upper()}") for name in CLASSES)


@pytest.mark.parametrize("panel", [True, False])
def test_objects_keep_their_numbers_and_places_in_a_sequence(panel: bool) -> None:
    """The camera moves; the place of each object in the world does not, and it is where the depth image says."""
    places: dict[int, list[object]] = {}
    for scene in sequence(3, 6, panel=panel):
        for one in scene.objects:
            places.setdefault(one.number, []).append(scene.camera.apply(one.position))
            whole = (
                one.box.x > 0 and one.box.x + one.box.width < 640 and one.box.y > 0 and one.box.y + one.box.height < 480
            )
            found = locate(one.box, scene.depth, CAMERA)
            if whole and panel:
                assert found
                assert found.point == pytest.approx(one.position, abs=0.04)
    assert places
    for number, seen in places.items():
        assert np.ptp(np.array(seen), axis=0).max() < 1e-9, number


def test_a_depth_is_where_the_ray_meets_the_ground(some: list[RenderedScene]) -> None:
    """At the lower edge of an image of rocks, the point has the height 0."""
    for scene in some:
        if scene.objects[0].class_name == "rock" and not any(one.box.y + one.box.height > 470 for one in scene.objects):
            pixel = np.array([320.0, 479.0])
            ray = np.append(CAMERA.undistort(pixel[None])[0], 1.0) * scene.depth[479, 320]
            assert scene.camera.apply(ray)[2] == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("name", PARTS)
def test_a_part_fits_its_canvas(name: str) -> None:
    """In any of its looks, with a margin for turning and scaling."""
    for seed in range(30):
        _, mask = draw_part(name, np.random.default_rng(seed))
        rows, columns = np.nonzero(mask)
        assert rows.size > 200
        assert min(rows.min(), columns.min()) > 2
        assert max(rows.max(), columns.max()) < 158
