"""ROS 2 topics as sources of frames, over topics in memory."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from polling import PATIENCE_S, wait_until

from roverlink.runtime import MiddlewareError, Qos, SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, CompressedImage, Image
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.vision import CameraParameters
from roverlink.vision.frames import Frame, TopicSets, TopicSource
from tests.vision.ros_images import FRAME, Camera, camera_info, header, image

_TOPIC = "/camera/image_raw"
_GREY = np.arange(24, dtype=np.uint8).reshape(4, 6)
_CAMERA = CameraParameters(np.array([[600.0, 0, 3], [0, 602, 2], [0, 0, 1]]), np.zeros(5), (6, 4))


class _Reader:
    """Somebody who takes frames on a thread of their own."""

    def __init__(self, source: Any) -> None:
        self.taken: list[Any] = []
        self.error: BaseException | None = None
        self._thread = threading.Thread(target=self._read, args=(source,))
        self._thread.start()

    def _read(self, source: Any) -> None:
        try:
            for one in source:
                self.taken.append(one)
        except (MiddlewareError, SetupError) as error:
            self.error = error

    def wait(self, count: int) -> list[Any]:
        """What was taken, as soon as it is so much."""
        wait_until(lambda: len(self.taken) >= count or self.error, f"{count} frames")
        return self.taken

    def join(self) -> None:
        """Wait for the end."""
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()


@pytest.fixture
def ros() -> Iterator[MemoryMiddleware]:
    """The node of a camera."""
    with MemoryMiddleware(Graph()) as middleware:
        yield middleware


@pytest.fixture
def said() -> list[str]:
    """What the user is told."""
    return []


@pytest.fixture
def source(ros: MemoryMiddleware, said: list[str]) -> Iterator[TopicSource]:
    """The topic as a source; it begins before the camera."""
    with TopicSource(ros, _TOPIC, said.append) as source:
        yield source


@pytest.fixture
def read(source: TopicSource) -> Iterator[_Reader]:
    """Somebody who takes its frames."""
    reader = _Reader(source)
    yield reader
    source.__exit__()
    reader.join()


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """A topic counts as silent at once, and messages as good again."""
    monkeypatch.setattr("roverlink.vision.frames.topic_sets.STALLED_S", 0.0)
    monkeypatch.setattr("roverlink.vision.frames.topic_sets._RECOVERED_S", 0.0)


def _publish_until(camera: Camera, done: Callable[[], Any], *messages: Any) -> None:
    """Publish messages again and again: what comes before the subscription is lost."""

    def try_it() -> Any:
        camera.publish(*messages)
        return done()

    wait_until(try_it, "an effect of the messages")


def test_a_frame_has_the_stamp_and_frame_of_its_image(read: _Reader, ros: MemoryMiddleware) -> None:
    """A camera that starts later is found, and its frames say what its messages say."""
    _publish_until(Camera(ros, _TOPIC), lambda: read.taken, image(_GREY, "mono8", stamp=7_000_000_008))
    frame = read.taken[0]
    assert isinstance(frame, Frame)
    assert (frame.stamp, frame.frame_id, frame.size) == (7_000_000_008, FRAME, (6, 4))
    assert np.array_equal(frame.image, _GREY)


def test_a_compressed_topic_is_a_source(read: _Reader, ros: MemoryMiddleware) -> None:
    """The type of the publisher decides, not the name of the topic."""
    import cv2

    message = CompressedImage(header(5), "png", cv2.imencode(".png", _GREY)[1].tobytes())
    _publish_until(Camera(ros, _TOPIC, CompressedImage), lambda: read.taken, message)
    assert np.array_equal(read.taken[0].image, _GREY)


def test_only_the_newest_image_is_taken(ros: MemoryMiddleware, said: list[str]) -> None:
    """Who is slower than the camera gets the newest image, and the numbers tell how many were passed over."""
    camera = Camera(ros, _TOPIC)
    with TopicSource(ros, _TOPIC, said.append) as source:
        camera.publish(*(image(_GREY, "mono8", stamp) for stamp in range(1, 4)))
        frames = iter(source)
        first = next(frames)
        camera.publish(*(image(_GREY, "mono8", stamp) for stamp in range(4, 9)))
        second = next(frames)
    assert [(frame.stamp, frame.number) for frame in (first, second)] == [(3, 2), (8, 7)]


def test_an_image_without_a_stamp_has_the_time_of_its_arrival(
    read: _Reader, ros: MemoryMiddleware, said: list[str]
) -> None:
    """It is told once."""
    before = time.time_ns()
    _publish_until(Camera(ros, _TOPIC), lambda: len(read.taken) > 1, image(_GREY, "mono8", stamp=0))
    assert before <= read.taken[0].stamp <= read.taken[1].stamp <= time.time_ns()
    assert [text for text in said if "stamps" in text] == [
        f"{_TOPIC}: the images have no stamps; using the times of their arrival"
    ]


@pytest.mark.usefixtures("soon")
def test_images_that_are_no_use_are_told_once(read: _Reader, ros: MemoryMiddleware, said: list[str]) -> None:
    """A bad image is skipped; the reason is told when it is new, and the count when good images are back."""
    camera = Camera(ros, _TOPIC)
    _publish_until(camera, lambda: any("16UC1" in text for text in said), image(_GREY.astype(np.uint16), "16UC1"))
    for _ in range(20):
        camera.publish(image(_GREY.astype(np.uint16), "16UC1"))
    _publish_until(camera, lambda: any("are good again" in text for text in said), image(_GREY, "mono8"))
    told = [text for text in said if "ignor" in text]
    assert "ignoring messages: an image with the encoding 16UC1 shows depths" in told[0]
    assert "the messages are good again; " in told[1]
    assert len(told) == 2


def test_another_image_size_is_refused(read: _Reader, ros: MemoryMiddleware, said: list[str]) -> None:
    """The camera's parameters are those of the first size; its images are still taken afterwards."""
    camera = Camera(ros, _TOPIC)
    _publish_until(camera, lambda: read.taken, image(_GREY, "mono8"))
    _publish_until(camera, lambda: any("6x4 to 4x6" in text for text in said), image(_GREY.reshape(6, 4), "mono8"))
    before = len(read.taken)
    _publish_until(camera, lambda: len(read.taken) > before, image(_GREY, "mono8"))
    assert {frame.size for frame in read.taken} == {(6, 4)}


@pytest.mark.usefixtures("soon")
def test_a_camera_that_goes_comes_back(read: _Reader, ros: MemoryMiddleware, said: list[str]) -> None:
    """The user is told that nobody publishes, that images stopped, that the camera has gone, and that it is back."""
    wait_until(lambda: said, "a message")
    assert said == [f"waiting: nothing publishes on {_TOPIC} yet"]
    with MemoryMiddleware(ros._graph) as node:
        camera = Camera(node, _TOPIC)
        _publish_until(camera, lambda: read.taken, image(_GREY, "mono8"))
        wait_until(lambda: any("has stalled: no message came" in text for text in said), "the stall")
        _publish_until(camera, lambda: any("is back after" in text for text in said), image(_GREY, "mono8"))
        del said[:]
    wait_until(lambda: any("has ended: it has no publisher any more" in text for text in said), "the end")
    count = len(read.taken)
    _publish_until(Camera(ros, _TOPIC), lambda: len(read.taken) > count, image(_GREY, "mono8"))


def test_a_source_that_is_closed_leaves_nothing_behind(ros: MemoryMiddleware, said: list[str]) -> None:
    """Its iteration ends, also where somebody waits for a frame, and the topic has no subscriber any more."""
    publisher = ros.publisher(_TOPIC, Image, Qos())
    with TopicSource(ros, _TOPIC, said.append) as source:
        reader = _Reader(source)
        assert publisher.has_subscribers()
    reader.join()
    assert list(source) == []
    assert not publisher.has_subscribers()


@pytest.mark.usefixtures("soon")
def test_a_misspelled_topic_is_told(read: _Reader, ros: MemoryMiddleware, said: list[str]) -> None:
    """While nothing publishes, the topics with images are named, and no others."""
    Camera(ros, "/camera/image_rw")
    Camera(ros, "/camera/camera_info", CameraInfo)
    wait_until(lambda: said, "a message")
    assert said[0].startswith(f"waiting: nothing publishes on {_TOPIC} yet")
    with TopicSource(ros, "/camera/image", said.append) as source:
        other = _Reader(source)
        wait_until(lambda: any("on /camera/image yet; did you mean '/camera/image_rw'?" in text for text in said), "it")
    other.join()


def test_a_topic_of_another_type_is_refused(read: _Reader, ros: MemoryMiddleware) -> None:
    """It will never have images."""
    Camera(ros, _TOPIC, CameraInfo)
    wait_until(lambda: read.error, "an error")
    assert "has messages of the type sensor_msgs/msg/CameraInfo; a topic with sensor_msgs/msg/Image or" in str(
        read.error
    )


# --- the camera's parameters ----------------------------------------------------------------------------------------


def _camera_of(source: TopicSource, topic: str, camera: Camera, *messages: Any) -> CameraParameters:
    """What the source reads while a driver publishes."""
    reader = _Reader(source.read_camera(topic) for _ in range(1))
    _publish_until(camera, lambda: reader.taken or reader.error, *messages)
    reader.join()
    if reader.error:
        raise reader.error
    found: CameraParameters = reader.taken[0]
    return found


@pytest.mark.parametrize("given", ["", "/elsewhere/info"])
def test_the_parameters_come_from_the_topic_beside_the_images(
    source: TopicSource, ros: MemoryMiddleware, given: str
) -> None:
    """Or from the one that is given."""
    camera = Camera(ros, given or "/camera/camera_info", CameraInfo)
    found = _camera_of(source, given or source.camera_info_topic, camera, camera_info(_CAMERA))
    assert found.matrix.tolist() == _CAMERA.matrix.tolist()


def test_a_camera_that_is_not_calibrated_is_told(source: TopicSource, ros: MemoryMiddleware) -> None:
    """The error names the topic, and what to do."""
    camera = Camera(ros, "/camera/camera_info", CameraInfo)
    with pytest.raises(SetupError, match=r"/camera/camera_info: the camera is not calibrated: K .*--parameters"):
        _camera_of(source, source.camera_info_topic, camera, CameraInfo(width=6, height=4))


# --- several topics -------------------------------------------------------------------------------------------------

_TOPICS = (_TOPIC, "/camera/depth", "/camera/camera_info")


@pytest.fixture
def rig(ros: MemoryMiddleware) -> tuple[Camera, Camera, Camera]:
    """A colour image, a depth image and the parameters, on the topics of `_TOPICS`."""
    return Camera(ros, _TOPICS[0]), Camera(ros, _TOPICS[1]), Camera(ros, _TOPICS[2], CameraInfo)


@pytest.mark.parametrize(("shift", "slop"), [(0, 0), (2_000_000, 3_000_000)])
def test_messages_that_belong_together_come_together(
    ros: MemoryMiddleware, rig: tuple[Camera, Camera, Camera], said: list[str], shift: int, slop: int
) -> None:
    """Colour, depth and parameters of a stamp, or of the nearest ones, are one set, in the order of the topics."""
    colour, depth, infos = rig
    distances = np.full((4, 6), 1500, np.uint16)
    with TopicSets(ros, _TOPICS, said.append, slop_ns=slop) as sets:
        reader = iter(sets)
        for stamp in range(33_000_000, 330_000_000, 33_000_000):
            colour.publish(image(_GREY, "mono8", stamp))
            depth.publish(image(distances, "16UC1", stamp + shift))
            infos.publish(camera_info(_CAMERA, stamp))
        seen, far, info = next(reader)
    assert isinstance(info, CameraInfo)
    assert not isinstance(seen, CameraInfo)
    assert not isinstance(far, CameraInfo)
    assert far.stamp - seen.stamp == shift
    assert (seen.frame_id, far.encoding, info.width) == (FRAME, "16UC1", 6)
    assert np.array_equal(far.pixels, distances)


def test_a_set_with_a_bad_message_is_left_out(
    ros: MemoryMiddleware, rig: tuple[Camera, Camera, Camera], said: list[str]
) -> None:
    """The next set comes, and the reason is told."""
    colour, depth, infos = rig
    with TopicSets(ros, _TOPICS, said.append) as sets:
        reader = _Reader(sets)
        for stamp, encoding in ((1, "mono9"), (2, "mono8")):
            colour.publish(image(_GREY, encoding, stamp))
            depth.publish(image(_GREY, "mono8", stamp))
            infos.publish(camera_info(_CAMERA, stamp))
            wait_until(lambda: said or reader.taken, "the first set")
        reader.wait(1)
    reader.join()
    assert [one[0].stamp for one in reader.taken] == [2]
    assert "unknown image encoding 'mono9'" in said[0]


def test_a_single_image_type_is_enough(ros: MemoryMiddleware, said: list[str]) -> None:
    """One topic is a set of one, and needs no stamps."""
    camera = Camera(ros, _TOPIC, Image)
    with TopicSets(ros, [_TOPIC], said.append) as sets:
        camera.publish(image(_GREY, "mono8", stamp=0))
        (only,) = next(iter(sets))
    assert not isinstance(only, CameraInfo)
    assert np.array_equal(only.pixels, _GREY)
