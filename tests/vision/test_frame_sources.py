"""Where frames come from."""

from __future__ import annotations

import contextlib
import re
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from polling import wait_until

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.camera.camera_settings import CameraSettings
from roverlink.vision.frames import open_source
from tests.vision.webcam import Webcam

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
    """10 comes after 2, other files are no frames, and the stamps are the rate's."""
    for number in (10, 2, 1):
        cv2.imwrite(str(tmp_path / f"view{number}.png"), _image(number))
    (tmp_path / "notes.txt").write_text("no image")
    with open_source(str(tmp_path), CameraSettings(rate=10)) as source:
        frames = list(source)
        assert (source.live, source.total) == (False, 3)
    assert [int(frame.image[0, 0, 0]) for frame in frames] == [1, 2, 10]
    assert [frame.stamp for frame in frames] == [0, 100_000_000, 200_000_000]
    assert [frame.number for frame in frames] == [0, 1, 2]


def test_a_single_image_is_a_source(tmp_path: Path) -> None:
    """A picture is a recording of one frame."""
    cv2.imwrite(str(tmp_path / "one.png"), _image(7))
    with open_source(str(tmp_path / "one.png")) as source:
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
    ("name", "contents", "expected"),
    [
        ("empty", None, r"contains no images \(known: .bmp"),
        ("film.mp4", b"no film", "cannot open the file as a video"),
        ("one.png", b"no image", ": cannot read the file as an image"),
    ],
)
def test_what_is_no_recording_is_told(tmp_path: Path, name: str, contents: bytes | None, expected: str) -> None:
    """A folder without images and a file that is damaged are named."""
    path = tmp_path / name
    if contents is None:
        path.mkdir()
    else:
        path.write_bytes(contents)
    with pytest.raises(SetupError, match=f"{re.escape(str(path))}.*{expected}"), open_source(str(path)) as source:
        list(source)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("film.mp4", "no file or folder 'film.mp4'"),
        ("frames/run1", "no file or folder 'frames/run1'"),
        ("", "the number of a camera, a URL .*, topic:NAME, or gstreamer:PIPELINE"),
        ("ftp://rover/film", "unknown scheme 'ftp'"),
        ("http://[::", "http://\\[::: not a valid URL: Invalid IPv6"),
        ("99", "cannot open camera 99"),
        ("/dev/video98", "cannot open camera 98"),
        ("rtsp://127.0.0.1:1/live", "cannot open rtsp://127.0.0.1:1/live"),
        ("127.0.0.1:1", "cannot open http://127.0.0.1:1"),
    ],
)
def test_what_is_not_there_is_told(text: str, expected: str) -> None:
    """A name that stands for nothing, a camera and a stream that are not there: each says which it is."""
    with pytest.raises(SetupError, match=expected):
        open_source(text)


def test_a_webcam_is_found_by_its_address(webcam: Callable[[int], Webcam]) -> None:
    """Neither the scheme nor the path of the app's stream has to be typed; frames are stamped as they come."""
    before = time.time_ns()
    with open_source(webcam(10_000).address) as source:
        frames = [frame for _, frame in zip(range(5), source)]
        assert source.live
    stamps = [before, *(frame.stamp for frame in frames), time.time_ns()]
    assert stamps == sorted(stamps)
    numbers = [frame.number for frame in frames]
    assert numbers == sorted(set(numbers))


def test_only_the_newest_frame_waits(webcam: Callable[[int], Webcam]) -> None:
    """Who takes long is given what is new, not what has waited; the numbers tell what was passed over."""
    phone = webcam(10_000)
    with open_source(phone.address) as source:
        frames = iter(source)
        first = next(frames)
        sent = phone.sent
        wait_until(lambda: phone.sent > sent + 10, "ten more frames")
        next(frames)  # it came while we waited, just now
        asked = time.time_ns()
        second = next(frames)
    assert second.stamp > asked - 100_000_000
    assert second.number > first.number + 5


@pytest.mark.parametrize("hangs", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_stream_that_goes_is_opened_again(webcam: Callable[[int], Webcam], hangs: bool) -> None:
    """It says that the stream ended or stalled, and that it is back; the frames go on and so do their numbers."""
    phone, said = webcam(5), list[str]()
    phone.hang = hangs
    with open_source(phone.address, say=said.append) as source:
        numbers = []
        for frame in source:
            numbers.append(frame.number)
            if phone.visits == 2:
                break
    assert ("has stalled: no frame for 3 s" if hangs else "has ended") in said[0]
    assert "is back after" in said[1]
    assert numbers == sorted(set(numbers))


def test_a_stream_that_stays_away_is_asked_for_less_and_less(webcam: Callable[[int], Webcam]) -> None:
    """The pauses double, and it says so; closing the source ends the wait at once."""
    phone, said = webcam(5), list[str]()
    source = open_source(phone.address, say=said.append)
    with source:
        phone.close()
        wait_until(lambda: len(said) == 3, "two attempts")
        closing = time.monotonic()
    assert time.monotonic() - closing < 1.5  # the wait that it ends has two seconds
    assert [text.rpartition("trying again ")[2] for text in said[1:3]] == ["in 1 s", "in 2 s"]
    assert list(source) == []


# --- RTSP, against GStreamer's server -------------------------------------------------------------------------------

_SERVER = Path(__file__).with_name("rtsp_server.py")
_SYSTEM_PYTHON = "/usr/bin/python3"
_NO_SERVER = "need gst-rtsp-server (apt-get install gir1.2-gst-rtsp-server-1.0 gstreamer1.0-plugins-good python3-gi)"


def _has_server() -> bool:
    check = "import gi; gi.require_version('GstRtspServer', '1.0'); from gi.repository import Gst; Gst.init(None); "
    check += "exit(not (Gst.ElementFactory.find('rtpjpegpay') and Gst.ElementFactory.find('jpegenc')))"
    try:
        return subprocess.run([_SYSTEM_PYTHON, "-c", check], capture_output=True).returncode == 0
    except FileNotFoundError:
        return False


@contextlib.contextmanager
def _rtsp(port: int) -> Iterator[subprocess.Popen[str]]:
    with subprocess.Popen(
        [_SYSTEM_PYTHON, str(_SERVER), str(port)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as server:
        assert server.stdout
        assert server.stdout.readline() == "ready\n"
        try:
            yield server
        finally:
            server.kill()


@pytest.mark.slow
@pytest.mark.skipif(not _has_server(), reason=_NO_SERVER)
def test_a_camera_with_rtsp_is_read_and_read_again() -> None:
    """Frames of a real server come as they are; when it has gone and is back, they go on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    said = list[str]()
    with contextlib.ExitStack() as servers:
        server = servers.enter_context(_rtsp(port))
        source = servers.enter_context(open_source(f"rtsp://127.0.0.1:{port}/live", say=said.append))
        frames = iter(source)
        first = next(frames)
        assert first.size == (320, 240)
        assert first.image.reshape(-1, 3).mean(axis=0) == pytest.approx([0, 255, 0], abs=25)
        server.kill()
        server.wait()
        wait_until(lambda: any("opening it again" in text for text in said), "the loss of the stream")
        servers.enter_context(_rtsp(port))
        wait_until(lambda: any("is back after" in text for text in said), "the stream")
        last = first.number
        assert next(frame.number for frame in frames if frame.number > last) > last
