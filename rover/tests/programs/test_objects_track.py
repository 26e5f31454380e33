"""``roverlink objects track``: objects in images, as JSON, as a video, on ROS 2 topics, at the basestation."""

from __future__ import annotations

import json
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from needs import NO_ONNX, NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import wait_until
from programs import Start

from generated.messages import BasestationDetectedObject
from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import sensor_msgs, vision_msgs
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, Image
from roverlink.runtime.middleware import NodeIdentity, open_middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
pytest.importorskip("onnx", reason=NO_ONNX)
pytest.importorskip("onnxruntime", reason=NO_ONNX)

from roverkit.objects.detected_objects import Box, TrackedObject  # noqa: E402
from roverkit.objects.object_rows import DetectedObjectRow  # noqa: E402  # they need OpenCV
from roverkit.vision import CameraParameters  # noqa: E402

from rover.tests.vision.d435i import BEGAN_NS, COLOUR, PERIOD_NS, TOPICS  # noqa: E402
from rover.tests.vision.onnx_models import write  # noqa: E402
from rover.tests.vision.ros_images import FRAME, camera_info, image, publishing  # noqa: E402

_CAMERA = CameraParameters(np.array([[600.0, 0, 320], [0, 600, 240], [0, 0, 1]]), np.zeros(5), size=(640, 480))


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A detector that sees a rock and a dog in every image of 640x480, in an input of 320x256."""
    table = np.zeros((1, 6, 1000), np.float32)
    table[0, :, 3] = [160, 128, 40, 20, 0.9, 0]  # x' = x / 2, y' = y / 2 + 8
    table[0, :, 7] = [10, 20, 40, 20, 0, 0.8]
    names = {0: "rock", 1: "dog"}
    return write(tmp_path_factory.mktemp("model") / "m.onnx", {"output0": table}, (320, 256), {"names": names})


@pytest.fixture
def images(tmp_path: Path) -> Path:
    """A folder with five images."""
    folder = tmp_path / "images"
    folder.mkdir()
    for number in range(5):
        cv2.imwrite(str(folder / f"{number}.png"), np.full((480, 640, 3), 40 * number, np.uint8))
    return folder


@pytest.mark.slow
def test_objects_are_printed_as_json(
    images: Path, model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """From the second image on, each object with its number and its box, clipped to the image; a video shows them."""
    film = tmp_path / "out.avi"
    assert main(["objects", "track", str(images), "--model", str(model), "--json", "--save", str(film)]) == 0
    out, err = capsys.readouterr()
    entries = [json.loads(line) for line in out.splitlines()]
    assert [len(one["objects"]) for one in entries] == [0, 2, 2, 2, 2]
    rock, dog = entries[-1]["objects"]
    assert rock == {"id": 1, "class": "rock", "confidence": 0.9, "box": {"x": 280, "y": 220, "width": 80, "height": 40}}
    assert (dog["id"], dog["box"]) == (2, {"x": 0, "y": 4, "width": 60, "height": 40})
    assert "m.onnx: layout yolov8, run by CPUExecutionProvider" in err
    assert "5 frames with 2 objects: 1 rock, 2 dog" in err
    video = cv2.VideoCapture(str(film))
    frames = [frame for found, frame in iter(video.read, (False, None)) if found]
    assert len(frames) == 5
    assert np.ptp(frames[0].astype(int)) < 20  # nothing yet
    assert np.abs(frames[-1][220:224, 300:340].astype(int) - 160).max() > 60  # the upper edge of a box


def test_objects_in_single_photographs_are_printed_and_drawn(
    images: Path, model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In each image, which `track` needs two of; a photograph that the camera has turned is turned back."""
    upright = cv2.imencode(".jpg", np.zeros((640, 480, 3), np.uint8))[1].tobytes()
    exif = b"\xff\xe1\x00\x22Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0"
    (images / "turned.jpg").write_bytes(upright[:2] + exif + upright[2:])
    drawn = tmp_path / "drawn"
    words = ["objects", "detect", str(images), "--model", str(model)]
    assert main([*words, "--json", "--save", str(drawn)]) == 0
    out, err = capsys.readouterr()
    entries = [json.loads(line) for line in out.splitlines()]
    assert [Path(one["image"]).name for one in entries] == [*(f"{number}.png" for number in range(5)), "turned.jpg"]
    rock = {"class": "rock", "confidence": 0.9, "box": {"x": 280, "y": 220, "width": 80, "height": 40}}
    assert [one["objects"][0] for one in entries] == [rock] * 6
    assert "6 images with 12 objects: 6 dog, 6 rock" in err
    assert cv2.imread(str(drawn / "0.png")).max() > 100
    assert main([*words, "--score", "0.85"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == f"{images / '0.png'}: rock 0.90 at 280 220 80 40"


def _sent(row: DetectedObjectRow, *boxes: Box) -> list[BasestationDetectedObject]:
    objects = [(TrackedObject(number, box, "rock", 0.5), 1) for number, box in enumerate(boxes, 5)]
    return [cdr.decode(BasestationDetectedObject, data) for data in row.messages(objects, (640, 480))]


def test_each_object_is_one_message_of_its_frame() -> None:
    """Frames are counted; one without objects is one message with the total count 0."""
    row = DetectedObjectRow(REGISTRY)
    assert row.types["OBJECT_ROTARY_POWER_SWITCH"] == 4
    first = _sent(row, Box(10.4, 20.6, 30, 40), Box(1, 2, 3, 4))
    assert [(one.frame_id, one.total_count, one.index, one.id, one.type) for one in first] == [
        (1, 2, 0, 5, 1),
        (1, 2, 1, 6, 1),
    ]
    (empty,) = _sent(row)
    assert (empty.frame_id, empty.total_count, empty.index) == (2, 0, 0)


@pytest.mark.parametrize(
    ("box", "expected"),
    [
        (Box(10.4, 20.6, 30, 40), (10, 21, 30, 40)),
        (Box(-5, -5, 20, 20), (0, 0, 15, 15)),
        (Box(630, 470, 20, 20), (630, 470, 10, 10)),
        (Box(639.9, 479.9, 0.1, 0.1), (639, 479, 1, 1)),
        (Box(5.2, 5.2, 0.2, 0.2), (5, 5, 1, 1)),
    ],
)
def test_boxes_are_whole_pixels_inside_the_image(box: Box, expected: tuple[int, ...]) -> None:
    """At least one pixel."""
    (message,) = _sent(DetectedObjectRow(REGISTRY), box)
    found = message.bbox
    assert (found.x, found.y, found.width, found.height) == expected


def _seen(number: int) -> tuple[Image, Image, CameraInfo]:
    """The messages of a depth camera that looks at a wall at a distance of 2 m."""
    stamp = BEGAN_NS + PERIOD_NS * number
    colour, depth = np.zeros((480, 640, 3), np.uint8), np.full((480, 640), 2000, np.uint16)
    return image(colour, "rgb8", stamp), image(depth, "16UC1", stamp), camera_info(_CAMERA, stamp)


@pytest.mark.slow
@needs_dds
def test_objects_of_a_depth_camera_are_published(start: Start, model: Path) -> None:
    """Boxes, positions, the drawn image, and the messages for the basestation, all with the stamp of the image."""
    topics: dict[str, Any] = {
        "/objects/detections": vision_msgs.Detection2DArray,
        "/objects/detections_3d": vision_msgs.Detection3DArray,
        "/objects/image/compressed": sensor_msgs.CompressedImage,
        "/detected_object": BasestationDetectedObject,
    }
    with ExitStack() as held:
        node = held.enter_context(open_middleware("dds", NodeIdentity("driver")))
        heard: dict[str, list[Any]] = {topic: hear(node, topic, kind) for topic, kind in topics.items()}
        held.enter_context(publishing(node, TOPICS, _seen))
        program = start("objects", "track", f"topic:{COLOUR}", "--model", model, "--middleware", "dds")

        def whole() -> Any:
            complete = (one for one in heard["/objects/detections_3d"] if len(one.detections) == 2)
            return next(complete, None)

        solid = wait_until(whole, "positions")
        flat = wait_until(lambda: heard["/objects/detections"], "boxes")[-1]
        picture = wait_until(lambda: heard["/objects/image/compressed"], "the image")[-1]
        wait_until(lambda: len(heard["/detected_object"]) > 10, "messages for the basestation")
        assert program.interrupt() == 0
    rock = solid.detections[0]
    assert rock.results[0].hypothesis.class_id == "rock"
    first = int(rock.id)
    assert first > 1_000_000  # numbers of another run are others
    place = rock.bbox.center.position
    assert [place.x, place.y, place.z] == pytest.approx([0, 0, 2], abs=1e-5)
    assert solid.header.frame_id == FRAME
    assert (solid.header.stamp.sec * 10**9 + solid.header.stamp.nanosec - BEGAN_NS) % PERIOD_NS == 0
    box = flat.detections[0].bbox
    assert [box.center.position.x, box.center.position.y, box.size_x, box.size_y] == pytest.approx([320, 240, 80, 40])
    assert cv2.imdecode(np.frombuffer(picture.data, np.uint8), cv2.IMREAD_COLOR).shape == (480, 640, 3)
    rocks, dogs = ([one for one in heard["/detected_object"] if one.id == number] for number in (first, first + 1))
    assert (rocks[0].type, rocks[0].total_count, rocks[0].bbox.x) == (BasestationDetectedObject.OBJECT_ROCK, 2, 280)
    assert (dogs[0].type, dogs[0].index) == (BasestationDetectedObject.OBJECT_UNKNOWN, 1)
    told = "\n".join(program.errors)
    assert told.count("objects of the class 'dog' are sent as unknown") == 1
    assert "latency from the image's stamp: median" in told
