"""ROS 2 topics as sources of frames, over topics in memory, and the synchronization of several topics."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polling import PATIENCE_S, wait_until
from roverkit.vision import CameraParameters
from roverkit.vision.frames import TopicSets, TopicSource
from roverkit.vision.frames.synchronization import RESTART_NS, Synchronizer

from rover.tests.vision.ros_images import FRAME, Camera, camera_info, header, image
from roverlink.runtime import MiddlewareError, Qos, SetupError
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, CompressedImage, Image
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware

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
            self.taken.extend(source)
        except (MiddlewareError, SetupError) as error:
            self.error = error

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
    monkeypatch.setattr("roverkit.vision.frames.topic_sets.STALLED_S", 0.0)
    monkeypatch.setattr("roverkit.vision.frames.topic_sets._RECOVERED_S", 0.0)


def _publish_until(camera: Camera, done: Callable[[], Any], *messages: Any) -> None:
    """Publish messages again and again: what comes before the subscription is lost."""

    def try_it() -> Any:
        camera.publish(*messages)
        return done()

    wait_until(try_it, "an effect of the messages")


def test_a_compressed_topic_is_a_source(read: _Reader, ros: MemoryMiddleware) -> None:
    """The type of the publisher decides, not the name of the topic."""
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


def test_another_image_size_is_refused(read: _Reader, ros: MemoryMiddleware, said: list[str]) -> None:
    """The camera's parameters are those of the first size; its images are still taken afterwards."""
    camera = Camera(ros, _TOPIC)
    _publish_until(camera, lambda: read.taken, image(_GREY, "mono8"))
    _publish_until(camera, lambda: any("6x4 to 4x6" in text for text in said), image(_GREY.reshape(6, 4), "mono8"))
    before = len(read.taken)
    _publish_until(camera, lambda: len(read.taken) > before, image(_GREY, "mono8"))
    assert {frame.size for frame in read.taken} == {(6, 4)}


@pytest.mark.slow
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


def test_a_topic_of_another_type_is_refused(read: _Reader, ros: MemoryMiddleware) -> None:
    """It will never have images."""
    Camera(ros, _TOPIC, CameraInfo)
    wait_until(lambda: read.error, "an error")
    text = "has messages of the type sensor_msgs/msg/CameraInfo; a topic with sensor_msgs/msg/Image or"
    assert text in str(read.error)


def test_the_parameters_come_from_the_topic_beside_the_images(source: TopicSource, ros: MemoryMiddleware) -> None:
    """A change is noticed once. For a camera that is not calibrated, the error names the topic, and what to do."""
    topic = source.camera_info_topic
    camera = Camera(ros, "/camera/camera_info", CameraInfo)
    with source.camera_infos(topic) as infos:
        reader = _Reader(infos.first() for _ in range(1))
        _publish_until(camera, lambda: reader.taken, camera_info(_CAMERA))
        reader.join()
        assert reader.taken[0].matrix.tolist() == _CAMERA.matrix.tolist()
        camera.publish(camera_info(_CAMERA, stamp=2))
        assert infos.changed() is None
        zoomed = replace(_CAMERA, matrix=_CAMERA.matrix * np.array([[2], [2], [1]]))
        camera.publish(camera_info(zoomed, stamp=3))
        found = infos.changed()
        assert found
        assert (found.matrix.tolist(), infos.changed()) == (zoomed.matrix.tolist(), None)
        camera.publish(CameraInfo(width=6, height=4))
        with pytest.raises(SetupError, match=rf"{topic}: the camera is not calibrated: K .*--parameters"):
            infos.changed()


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
        wait_until(lambda: reader.taken, "the second set")
    reader.join()
    assert [one[0].stamp for one in reader.taken] == [2]
    assert "unknown image encoding 'mono9'" in said[0]


Arrival = tuple[int, int]  # A message that arrives: the index of its topic, and its stamp
Sets = list[tuple[int, ...]]

_END = 10_000


def _run(arrivals: Sequence[Arrival], topics: int, slop: int, queue: int = 1000) -> Sets:
    """The sets of a synchronizer whose messages are their own stamps."""
    synchronizer = Synchronizer[int](topics, slop, queue)
    return [one for topic, stamp in arrivals for one in synchronizer.add(topic, stamp, stamp)]


def _flushed(arrivals: Sequence[Arrival], topics: int) -> list[Arrival]:
    """The messages, and a last one of each topic, after which nothing waits."""
    return [*arrivals, *((topic, _END) for topic in range(topics))]


def _nearest(stamps: set[int], stamp: int) -> int:
    return min(stamps, key=lambda one: (abs(one - stamp), one))


_COUNTS = st.integers(2, 4)
_SLOP = st.integers(0, 12)


@st.composite
def _in_order(draw: st.DrawFn) -> tuple[int, list[Arrival]]:
    """Messages of topics that are delayed against each other; each topic is in order, and has lost some."""
    topics = draw(_COUNTS)
    streams = [sorted(draw(st.sets(st.integers(0, 60), max_size=14))) for _ in range(topics)]
    arrivals: list[Arrival] = []
    while left := [topic for topic, stream in enumerate(streams) if stream]:
        topic = draw(st.sampled_from(left))
        arrivals.append((topic, streams[topic].pop(0)))
    return topics, arrivals


@pytest.mark.slow
@settings(max_examples=50)
@given(_in_order(), _SLOP)
def test_sets_do_not_depend_on_delays(drawn: tuple[int, list[Arrival]], slop: int) -> None:
    """However late a topic is, the sets are those of the mutually nearest stamps within the slop, oldest first."""
    topics, arrivals = drawn
    streams = [{stamp for index, stamp in _flushed(arrivals, topics) if index == topic} for topic in range(topics)]
    mutual = [
        (stamp, *near)
        for stamp in sorted(streams[0])
        if (near := [_nearest(stream, stamp) for stream in streams[1:]]) is not None
        and all(abs(one - stamp) <= slop and _nearest(streams[0], one) == stamp for one in near)
    ]
    assert _run(_flushed(arrivals, topics), topics, slop) == mutual


def test_equal_stamps_do_not_wait() -> None:
    """A set of equal stamps is complete with its last message; a lost message costs its own set alone."""
    synchronizer = Synchronizer[str](3)
    assert synchronizer.add(2, 7, "info") == []
    assert synchronizer.add(0, 7, "colour") == []
    assert synchronizer.add(1, 7, "depth") == [("colour", "depth", "info")]
    assert _run([(0, 10), (0, 20), (1, 20), (0, 30), (1, 30)], 2, 0) == [(20, 20), (30, 30)]
    late = [(0, 10), (1, 14), (1, 11), (0, 9), (0, 20), (1, 20), (0, 8), (1, 8), (0, 30), (1, 30)]
    assert _run(late, 2, 4) == [(10, 11), (20, 20), (30, 30)]  # a late message is used until its set is decided


def test_a_silent_topic_does_not_fill_the_memory() -> None:
    """Of what waits for a topic that says nothing, the newest messages stay, and find their partners later."""
    waiting = [(0, stamp) for stamp in range(100)]
    assert _run([*waiting, (1, 94), (1, 96)], 2, 0, queue=5) == [(96, 96)]
    assert _run([*waiting, (1, 97)], 2, 0, queue=5) == [(97, 97)]
    assert _run([*((1, stamp) for stamp in range(100)), (0, 94), (0, 96)], 2, 0, queue=5) == [(96, 96)]


@pytest.mark.parametrize("slop", [0, 5])
def test_a_recording_that_starts_again_is_synchronized_again(slop: int) -> None:
    """After a jump back of the stamps, sets continue, although all stamps are older than before."""
    late, early = 100 * RESTART_NS, 3
    arrivals = [(topic, late + stamp) for stamp in (0, 10) for topic in (0, 1)]
    again = [(topic, early + stamp) for stamp in (0, 10) for topic in (0, 1)]
    assert _run([*arrivals, *again], 2, slop)[-2:] == [(3, 3), (13, 13)]
