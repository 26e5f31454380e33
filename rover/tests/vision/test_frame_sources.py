"""Where frames come from, recordings that are played, in real or simulated time, and films that are written."""

from __future__ import annotations

import re
import socket
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import takewhile
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from polling import PATIENCE_S, wait_until
from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.frames import Frame, TopicSource, open_source, play
from roverkit.vision.images.film import Film

from rover.tests.vision.ros_images import image
from rover.tests.vision.webcam import Webcam
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces import builtin_interfaces
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.interfaces.sensor_msgs import Image
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_time.simulated_clock import SimulatedClock

SIZE = (96, 64)


def _image(grey: int) -> NDArray[np.uint8]:
    return np.full((SIZE[1], SIZE[0], 3), grey, np.uint8)


@pytest.fixture
def webcam() -> Iterator[Callable[[int], Webcam]]:
    webcams: list[Webcam] = []

    def start(frames: int) -> Webcam:
        webcams.append(Webcam([cv2.imencode(".jpg", _image(grey))[1].tobytes() for grey in range(200)], frames))
        return webcams[-1]

    yield start
    for one in webcams:
        one.close()


def test_a_folder_is_read_in_the_order_of_its_numbers(tmp_path: Path) -> None:
    """10 comes after 2, other files are no frames, and the stamps are the rate's. A picture is one frame."""
    for number in (10, 2, 1):
        cv2.imwrite(str(tmp_path / f"view{number}.png"), _image(number))
    (tmp_path / "notes.txt").write_text("no image")
    with open_source(str(tmp_path), CameraSettings(rate=10)) as source:
        frames = list(source)
        assert (source.live, source.total) == (False, 3)
    found = [(frame.image[0, 0, 0], frame.stamp, frame.number) for frame in frames]
    assert found == [(1, 0, 0), (2, 100_000_000, 1), (10, 200_000_000, 2)]
    with open_source(str(tmp_path / "view1.png")) as source:
        assert [frame.image.shape for frame in source] == [(SIZE[1], SIZE[0], 3)]


def test_a_video_has_the_stamps_that_are_in_it(tmp_path: Path) -> None:
    """Every frame of the file comes once, stamped by its place in the film."""
    film = tmp_path / "film.avi"
    writer = cv2.VideoWriter(str(film), cv2.VideoWriter_fourcc(*"MJPG"), 20, SIZE)
    for index in range(8):
        writer.write(_image(20 * index))
    writer.release()
    with open_source(str(film)) as source:
        frames = list(source)
        assert source.total == 8
    assert [frame.stamp for frame in frames] == [round(index * 5e7) for index in range(8)]
    assert [round(float(frame.image.mean()) / 20) for frame in frames] == list(range(8))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{folder}/empty", r"{folder}/empty.*contains no images \(known: .bmp"),
        ("{folder}/film.mp4", r"{folder}/film\.mp4.*cannot open the file as a video"),
        ("{folder}/one.png", r"{folder}/one\.png.*: cannot read the file as an image"),
        ("film.mp4", "no file or folder 'film.mp4'"),
        ("", "the number of a camera, a URL .*, topic:NAME, or gstreamer:PIPELINE"),
        ("http://[::", "http://\\[::: not a valid URL: Invalid IPv6"),
        ("99", "cannot open camera 99"),
        ("rtsp://127.0.0.1:1/live", "cannot open rtsp://127.0.0.1:1/live"),
        ("127.0.0.1:1", "cannot open http://127.0.0.1:1"),
    ],
)
def test_what_is_no_source_is_told(tmp_path: Path, text: str, expected: str) -> None:
    """A folder without images, a damaged file, a camera and a stream that are not there: each says which it is."""
    (tmp_path / "empty").mkdir()
    for name in ("film.mp4", "one.png"):
        (tmp_path / name).write_bytes(b"no image")
    match = expected.replace("{folder}", re.escape(str(tmp_path)))
    with pytest.raises(SetupError, match=match), open_source(text.replace("{folder}", str(tmp_path))) as source:
        list(source)


def test_a_webcam_is_found_by_its_address(webcam: Callable[[int], Webcam]) -> None:
    """Neither the scheme nor the path of the app's stream has to be typed; frames are stamped as they come.

    Who takes long is given what is new, not what has waited; the numbers tell what was passed over.
    """
    phone, before = webcam(10_000), time.time_ns()
    with open_source(phone.address) as source:
        frames = iter(source)
        first = [next(frames) for _ in range(5)]
        assert source.live
        sent = phone.sent
        wait_until(lambda: phone.sent > sent + 10, "ten more frames")
        next(frames)  # it came while we waited, just now
        asked = time.time_ns()
        last = next(frames)
    stamps = [before, *(frame.stamp for frame in first), last.stamp, time.time_ns()]
    assert stamps == sorted(stamps)
    numbers = [frame.number for frame in first]
    assert numbers == sorted(set(numbers))
    assert last.stamp > asked - 100_000_000
    assert last.number > numbers[-1] + 5


@pytest.mark.parametrize(("scheme", "request_"), [("http", b"GET"), ("rtsp", b"OPT")])
def test_a_stream_is_asked_for_a_connection_first(scheme: str, request_: bytes) -> None:
    """FFmpeg, which waits long for an answer, sends its request after a connection that was accepted and closed."""

    def first_bytes(_: int) -> bytes:
        with server.accept()[0] as connection:
            return connection.recv(3)

    with socket.create_server(("127.0.0.1", 0)) as server, ThreadPoolExecutor(1) as pool:
        server.settimeout(PATIENCE_S)
        received = pool.map(first_bytes, range(2))
        with pytest.raises(SetupError, match="cannot open"):
            open_source(f"{scheme}://127.0.0.1:{server.getsockname()[1]}/video")
        assert list(received) == [b"", request_]


@pytest.mark.parametrize("hangs", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_stream_that_goes_is_opened_again(webcam: Callable[[int], Webcam], hangs: bool) -> None:
    """It says that the stream ended or stalled, and that it is back; the frames go on and so do their numbers."""
    phone, said = webcam(5), list[str]()
    phone.hang = hangs
    with open_source(phone.address, say=said.append) as source:
        frames = iter(source)
        numbers = [frame.number for frame in takewhile(lambda _: phone.visits < 2, frames)]
        numbers.append(next(frames).number)
    assert ("has stalled: no frame for 3 s" if hangs else "has ended") in said[0]
    assert "is back after" in said[1]
    assert numbers == sorted(set(numbers))


@pytest.mark.slow
def test_a_stream_that_stays_away_is_asked_for_until_it_is_back(webcam: Callable[[int], Webcam]) -> None:
    """Every half second, so that its picture is back soon, but it says so only once; closing the source ends it."""
    phone, said, attempts = webcam(5), list[str](), list[int]()
    with open_source(phone.address, say=said.append) as source:
        connect = source._connect
        source._connect = lambda: attempts.append(1) or connect()
        phone.close()
        wait_until(lambda: len(attempts) >= 5, "five attempts")
    assert [text.partition(" is ")[2] for text in said[1:]] == ["not available; trying again every 0.5 s"]
    assert list(source) == []


MS = 1_000_000


def _greys(path: Path) -> list[int]:
    capture, found = cv2.VideoCapture(str(path)), []
    while capture.grab():
        found.append(round(float(capture.retrieve()[1].mean()) / 10))
    return found


@pytest.mark.parametrize("name", ["film.mp4", "film.avi"])
def test_a_film_is_as_fast_as_its_images_came(tmp_path: Path, name: str) -> None:
    """Where an image is late the one before stands still, of two at once one is left out, and an hour is cut out."""
    path = tmp_path / name
    with Film(path, 10) as film:
        for place, stamp in enumerate((0, 100, 400, 410, 500)):
            film.add(_image(40 * place), stamp * MS)
        assert list(tmp_path.glob("film*")) == []
    assert _greys(path) == [0, 4, 8, 8, 8, 16]
    assert [one.name for one in tmp_path.iterdir()] == [name]
    assert cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FPS) == 10
    with Film(path, 10) as film:
        for place, stamp in enumerate((0, 3_600_000, 3_600_100)):
            film.add(_image(40 * place), stamp * MS)
    assert (len(_greys(path)), _greys(path)[-1]) == (22, 8)


@pytest.mark.slow
def test_a_recording_is_played_at_its_pace(tmp_path: Path) -> None:
    """Frames come when they are due, stamped with that time; in a loop the stamps and the numbers go on."""
    for number in range(3):
        cv2.imwrite(str(tmp_path / f"{number}.png"), _image(number))
    began = time.time_ns()
    with open_source(str(tmp_path), CameraSettings(rate=20)) as source:
        frames = [(frame, time.time_ns()) for _, frame in zip(range(7), play(source, loop=True))]
        assert len(list(play(source))) == 3  # without a loop, it ends
    stamps = [frame.stamp for frame, _ in frames]
    assert np.diff(stamps).tolist() == [50 * MS] * 6
    assert began <= stamps[0]
    assert all(came >= frame.stamp for frame, came in frames)
    assert [(frame.number, frame.image[0, 0, 0]) for frame, _ in frames] == [(one, one % 3) for one in range(7)]


Tick = Callable[[float], object]


@pytest.fixture
def graph() -> Graph:
    return Graph()


@pytest.fixture
def tick(graph: Graph) -> Tick:
    """Publishes a time in seconds on /clock."""
    publisher = MemoryMiddleware(graph).publisher("/clock", Clock, Qos())

    def tick(seconds: float) -> None:
        ns = round(seconds * 1e9)
        publisher.publish([cdr.encode(Clock(builtin_interfaces.Time(ns // 10**9, ns % 10**9)))])

    return tick


@pytest.fixture
def clock(graph: Graph, tick: Tick) -> SimulatedClock:
    """A clock that shows 10 s."""
    clock = SimulatedClock(MemoryMiddleware(graph), "/clock", print)
    assert clock.now() == 0
    tick(10)
    clock.wait()
    return clock


@pytest.mark.parametrize(
    ("ticks", "stamps"), [((10.02, 10.04, 11), [10.0, 10.033, 10.067]), ((2, 2, 2.1), [10.0, 2.0, 2.033])]
)
def test_a_recording_is_played_in_the_time_of_the_simulation(
    clock: SimulatedClock, tick: Tick, tmp_path: Path, ticks: tuple[float, ...], stamps: list[float]
) -> None:
    """A frame comes when the simulation has reached its time, not the wall clock; after a restart, at the new time."""
    for number in range(3):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.full((8, 8), number, np.uint8))
    shown: list[Frame] = []

    def run() -> None:
        with open_source(str(tmp_path)) as source:  # 30 Hz
            shown.extend(play(source, clock=clock))

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    wait_until(lambda: len(shown) == 1, "the first frame")
    tick(ticks[0])
    assert len(shown) == 1 or ticks[0] < 10
    tick(ticks[1])
    wait_until(lambda: len(shown) == 2, "the second frame")
    tick(ticks[2])
    thread.join(PATIENCE_S)
    assert [round(frame.stamp / 1e9, 3) for frame in shown] == stamps


def test_images_without_stamps_get_the_time_of_the_simulation(graph: Graph, clock: SimulatedClock, tick: Tick) -> None:
    """A stamp that an image has is kept."""
    publisher = MemoryMiddleware(graph).publisher("/image", Image, Qos())
    tick(20)
    pixels = np.zeros((4, 6, 3), np.uint8)
    with TopicSource(MemoryMiddleware(graph), "/image", print, clock) as source:
        frames = iter(source)
        publisher.publish([cdr.encode(image(pixels, "rgb8", 0))])
        assert next(frames).stamp == 20_000_000_000
        publisher.publish([cdr.encode(image(pixels, "rgb8", 7))])
        assert next(frames).stamp == 7
