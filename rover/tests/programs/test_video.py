"""``roverlink video``: from cameras to the basestation's page, files and topics, and what is said about mistakes."""

from __future__ import annotations

import json
import socket
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from needs import NO_AV, NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import PATIENCE_S, wait_until
from programs import Program, Start
from running import Called

from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import sensor_msgs
from roverlink.runtime.middleware import NodeIdentity, open_middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)
av = pytest.importorskip("av", reason=NO_AV)

from roverkit.video import setting  # noqa: E402  # they need OpenCV
from roverkit.video.link_quality import LinkQuality  # noqa: E402
from roverkit.video.overlay import link_text  # noqa: E402

from rover.tests.vision.browsing import visiting  # noqa: E402
from rover.tests.vision.ros_images import image  # noqa: E402
from roverlink.runtime.ros_time.headers import stamp_of  # noqa: E402  # they need OpenCV

_SEND, _RECEIVE = ("video", "send"), ("video", "receive")
_ALONE = ("--middleware", "none")


@pytest.fixture
def images(tmp_path: Path) -> Path:
    """A folder with ten images of 321x241: each is a brighter grey than the one before."""
    folder = tmp_path / "images"
    folder.mkdir()
    for number in range(10):
        cv2.imwrite(str(folder / f"{number}.png"), np.full((241, 321, 3), 20 + 20 * number, np.uint8))
    return folder


def _receiver(start: Start, names: str, *options: object) -> tuple[Program, list[int]]:
    """Start a receiver of streams on free ports, and return it with their ports."""
    program = start(*_RECEIVE, *(f"{name}=0" for name in names.split()), "--json", *options)
    return program, [one["port"] for one in json.loads(program.wait_for("streams", program.output))["streams"]]


def _write_streams(images: Path, **streams: object) -> Path:
    """Write a file of streams beside the images, and return it."""
    file = images.parent / "video.yaml"
    file.write_text(json.dumps({"host": "127.0.0.1", "streams": streams}))
    return file


def _when(
    program: Program, condition: Callable[[dict[str, Any]], object], what: str, stream: int = 0, *, after: int = 0
) -> dict[str, Any]:
    """Wait until the receiver has printed a state of a stream with a condition, and return it.

    The first lines, of the number `after`, do not count.
    """

    def found() -> dict[str, Any] | None:
        states = [json.loads(line)["streams"][stream] for line in program.output[after:]]
        return next(filter(condition, states), None)

    return wait_until(found, what) or {}


@pytest.mark.slow
def test_images_arrive_and_are_saved(start: Start, images: Path, tmp_path: Path) -> None:
    """The receiver tells where they come from, and counts; the file can be played, and its images have even sides."""
    receiver, (port,) = _receiver(start, "front", "--save", tmp_path / "today", "--page", "0")
    url = receiver.wait_for("page: http://127.0.0.1:").rpartition("page: ")[2]
    sender = start(*_SEND, images, "--port", port, "--loop", "--overlay", "time", *_ALONE)
    state = _when(receiver, lambda one: one["rate"] > 10, "images")
    assert state | {"name": "front", "port": port, "size": [320, 240], "stale": False} == state
    assert 0 <= state["latency"] < 60
    receiver.wait_for("front: images come from 127.0.0.1:")
    for path, headers, status in (
        ("video/front", {"Sec-Fetch-Site": "cross-site"}, 403),
        ("video/front", {"Host": "evil.example"}, 403),
        ("video/arm", {}, 404),
    ):
        with pytest.raises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(urllib.request.Request(url + path, headers=headers), timeout=PATIENCE_S)
        assert caught.value.code == status
    assert sender.interrupt() == 0
    receiver.wait_for("front: no image for a second")
    assert receiver.interrupt() == 0
    with av.open(str(tmp_path / "today" / "front.mkv")) as container:
        frames = list(container.decode(video=0))
    assert len(frames) > 10
    assert (frames[0].width, frames[0].height) == (320, 240)


def test_a_recording_that_ends_ends_the_sender(
    images: Path, peer: socket.socket, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without --loop. Some builds of PyAV have no encoder: nothing is sent, and the user learns which one has."""
    words = [*_SEND, str(images), "--port", str(peer.getsockname()[1]), "--rate", "60", *_ALONE]
    assert main(words) == 0
    assert peer.recv(2000)
    capsys.readouterr()
    monkeypatch.setattr(av, "codecs_available", set())
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "this PyAV has no encoder for H.264 (libx264); install PyAV from PyPI" in error
    assert error.count("\n") == 1


@pytest.mark.slow
def test_the_page_shows_all_streams(start: Start, images: Path) -> None:
    """The newest image of each; a stream that has ended is marked as stale, and one that never came says its port."""
    receiver, (port, _) = _receiver(start, "front arm", "--page", "0")
    url = receiver.wait_for("page: ").rpartition("page: ")[2]
    sender = start(*_SEND, images, "--port", port, "--loop", *_ALONE)
    with visiting() as visitor:
        visitor.open(url)
        front, arm = (f'section[aria-label="{name}"]' for name in ("front", "arm"))
        visitor.until(lambda: visitor.count(front) and "images/s" in visitor.text(front))
        visitor.until(lambda: visitor.run(f"return document.querySelector('{front} img').naturalWidth") == 320)
        assert not visitor.shown(f"{front} .age")
        assert "no image yet on UDP port" in visitor.text(f"{arm} .age")
        sender.interrupt()
        visitor.until(lambda: visitor.shown(f"{front} .age") and "STALE: last image" in visitor.text(f"{front} .age"))
        assert visitor.complaints() == []
        receiver.interrupt()
        visitor.until(lambda: "NO CONNECTION" in visitor.text("#connection"))


@pytest.mark.slow
@needs_dds
def test_images_of_a_topic_come_out_of_a_topic(start: Start) -> None:
    """A sender on one topic, a receiver on another; the stamps are those of the camera."""
    receiver, (port,) = _receiver(start, "front", "--topic", "--middleware", "dds", "--no-page")
    sender = start(*_SEND, "topic:/camera", "--port", port, "--middleware", "dds")
    with open_middleware("dds", NodeIdentity("camera")) as node:
        arrived = hear(node, "/video/front/compressed", sensor_msgs.CompressedImage)
        camera = node.publisher("/camera", sensor_msgs.Image, Qos())
        strange = cdr.encode(image(np.full((48, 64, 3), 70, np.uint8), "yuv999"))

        def told() -> list[str]:
            camera.publish([strange])
            return [line for line in list(sender.errors) if "yuv999" in line]

        wait_until(told, "the warning")
        stamp = 7_000_000_000
        for grey, (width, height) in ((70, (64, 48)), (90, (96, 64))):
            pixels = np.full((height, width, 3), grey, np.uint8)
            arrived.clear()

            def shown(shape: tuple[int, int] = (height, width), pixels: Any = pixels) -> Any:
                nonlocal stamp
                stamp += 40_000_000
                camera.publish([cdr.encode(image(pixels, stamp=stamp))])
                return next((one for one in list(arrived) if _pixels(one).shape[:2] == shape), None)

            found = wait_until(shown, "the image on its topic")
            assert 7_000_000_000 < stamp_of(found.header) <= stamp
            assert stamp_of(found.header) % 40_000_000 == 0
            assert found.header.frame_id == "front_optical_frame"
            assert abs(int(_pixels(found)[5, 5, 0]) - grey) < 6
    assert receiver.interrupt() == 0
    assert sender.interrupt() == 0
    assert len([line for line in sender.errors if "yuv999" in line]) == 1


@pytest.mark.slow
@needs_dds
def test_running_streams_are_changed(start: Start, called: Called, images: Path) -> None:
    """Stopped, started, and given another size and another camera, by the name of the stream."""
    other = images.parent / "other"
    other.mkdir()
    cv2.imwrite(str(other / "0.png"), np.full((64, 96, 3), 90, np.uint8))
    receiver, (front, arm) = _receiver(start, "front arm", "--no-page")
    front_stream = {"source": "images", "port": front}
    file = _write_streams(images, front=front_stream, arm={"source": "images", "port": arm, "running": False})
    start(*_SEND, file, "--loop", "--middleware", "dds")

    def changed(*words: str) -> list[str]:
        code, output, errors = called("video", "set", *words, "--middleware", "dds")
        assert (code, errors) == (0, "")
        return output.splitlines()

    _when(receiver, lambda one: one["rate"] > 10, "images")
    assert changed("arm.running=true", "front.size=160x120") == ["arm.running: true", 'front.size: "160x120"']
    _when(receiver, lambda one: one["size"] == [160, 120], "the other size")
    _when(receiver, lambda one: one["rate"] > 10, "the other stream", 1)
    changed("arm.running=false", "front.size=", f"front.source={other}")
    _when(receiver, lambda one: one["size"] == [96, 64], "the other camera")
    _when(receiver, lambda one: one["stale"], "the end of the other stream", 1, after=len(receiver.output))
    expected = {"running": False, "source": str(images), "port": arm, "rate": 30.0, "min_bitrate": 150.0}
    assert json.loads(*changed("--json"))["arm"].items() >= expected.items()
    assert "front.rate: 30.0" in changed()
    for change, problem in (
        ("front.bitrate=5", "stream front: the bitrate is 5 and the least one 150 kbit/s; both must be from 10"),
        ("frotn.rate=5", "no sender has a stream 'frotn'; did you mean 'front'?"),
    ):
        code, _, errors = called("video", "set", change, "--middleware", "dds")
        assert code == 2
        assert errors.startswith(f"roverlink: {problem}")


def test_without_a_sender_nothing_is_set(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The user learns where it was looked for."""
    monkeypatch.setattr(setting, "FIND_S", 0.1)
    assert main(["video", "set", "front.rate=5", "--middleware", "memory", "--ros-args", "-r", "__ns:=/rover"]) == 2
    assert "no sender of video was found on /rover/video/streams; start" in capsys.readouterr().err


def _pixels(message: sensor_msgs.CompressedImage) -> Any:
    return cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("streams: {}", "no streams found under the key 'streams'"),
        ("streams: {front: {port: 1}}", "video.yaml:1:18: stream front has no source; add 'source: topic:/camera"),
        ("streams: {front: {source: images}}", "stream front: there is no host; name the basestation's address"),
        ("host: a\nstreams: {Front: {source: images}}", "the name 'Front' becomes a part of topics"),
        ("host: a\nstreams: {f: {source: x, prt: 1}}", "stream f has an unknown key 'prt'; did you mean 'port'?"),
        ("host: a\nstreams: {f: {source: x, port: x}}", "stream f: port is x; it must be a whole number"),
        ("host: a\nstreams: {f: {source: x}, g: {source: y}}", "stream g and stream f have the same port 4500"),
        ("host: a\nlink_rate: 0\nstreams: {f: {source: x}}", "video.yaml:2:12: the link rate is 0 kbit/s; it must be"),
        ("host: a\nstreams: {f: {source: x, overlay: time}}", "stream f: overlay is time; it must be a list"),
        ("host: a\nstreams: {f: {source: x, running: 3}}", "stream f: running is 3; it must be true or false"),
        ("host: a\nstreams: {f: {source: x, size: [1, 2, 3]}}", "size is a list of 3; it must be a list of 2"),
    ],
)
def test_mistakes_in_the_file_have_their_place(tmp_path: Path, called: Called, text: str, message: str) -> None:
    """File, line and column."""
    (tmp_path / "video.yaml").write_text(text)
    code, _, error = called(*_SEND, "video.yaml", *_ALONE, folder=tmp_path)
    assert code == 2
    assert message in error
    assert error.startswith("roverlink: video.yaml:")


def test_the_line_about_the_link_has_what_is_known() -> None:
    """The loss, and the round trip."""
    assert link_text(None) == "link: unknown"
    assert link_text(LinkQuality(0.125, None)) == "link: 12% lost"
    assert link_text(LinkQuality(0.0, 0.0234)) == "link: 0% lost, 23 ms"
