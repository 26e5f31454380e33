"""``roverlink video``: from cameras to the basestation's page, files and topics, and what is said about mistakes."""

from __future__ import annotations

import json
import re
import socket
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from needs import NO_AV, NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import wait_until
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

from roverlink.runtime.ros_time.headers import stamp_of  # noqa: E402  # they need OpenCV
from roverlink.video import setting  # noqa: E402  # they need OpenCV
from tests.vision.browsing import visiting  # noqa: E402
from tests.vision.ros_images import image  # noqa: E402
from tests.vision.webcam import Webcam  # noqa: E402

_SEND, _RECEIVE = ("video", "send"), ("video", "receive")
_NAVIGATION = Path(__file__).parents[2] / "navigation"
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


_JPEG = cv2.imencode(".jpg", np.full((48, 64, 3), 90, np.uint8))[1].tobytes()


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


def test_images_arrive_and_are_saved(start: Start, images: Path, tmp_path: Path) -> None:
    """The receiver tells where they come from, and counts; the file can be played, and its images have even sides.

    A page of another site may not embed them; and nobody gets a stream that does not exist.
    """
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
            urllib.request.urlopen(urllib.request.Request(url + path, headers=headers), timeout=30)
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


@needs_dds
def test_images_of_a_topic_come_out_of_a_topic(start: Start) -> None:
    """A sender on one topic, a receiver on another; the stamps are those of the camera.

    The size may change. Images with an unknown encoding are told once, and left out.
    """
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
def test_a_camera_that_disappears_comes_back(start: Start) -> None:
    """The receiver marks its stream as old meanwhile."""
    webcam = Webcam([_JPEG], pause_s=0.03)
    receiver, (port,) = _receiver(start, "front", "--no-page")
    sender = start(*_SEND, f"http://{webcam.address}/video", "--port", port, *_ALONE)
    _when(receiver, lambda one: one["rate"] > 5, "images")
    webcam.close()
    sender.wait_for("has ended; opening it again")
    _when(receiver, lambda one: one["stale"], "the end of the images", after=len(receiver.output))
    webcam = Webcam([_JPEG], pause_s=0.03, port=webcam.port)
    sender.wait_for("is back after")
    _when(receiver, lambda one: one["rate"] > 5, "images", after=len(receiver.output))
    assert sender.interrupt() == 0
    webcam.close()


@pytest.mark.slow
def test_the_launch_file_starts_three_streams(start: Start, images: Path) -> None:
    """Those of its file, with the cameras and bitrates of its arguments; an argument that is empty changes nothing."""
    *arguments, group = yaml.safe_load((_NAVIGATION / "launch" / "video_launch.yaml").read_text())["launch"]
    values = {one["arg"]["name"]: one["arg"]["default"] for one in arguments}
    values |= {f"{name}_source": str(images) for name in ("front", "arm", "mast")} | {"mast_bitrate": "300"}

    def said(text: str) -> str:
        text = re.sub(r"\$\(var (\w+)\)", lambda found: values[found[1]], text)
        return text.replace("$(dirname)", str(_NAVIGATION / "launch"))

    *parameters, node = (next(iter(action.items())) for action in group["group"][1:])
    assert (node[0], node[1]["exec"]) == ("node", "video_send")
    receiver, ports = _receiver(start, "front arm mast", "--no-page")
    ros = []
    for kind, one in parameters:
        assert kind == "set_parameter"
        if "if" not in one or said(one["if"]) != "$(eval \"'' != ''\")":
            ros += ["-p", f"{one['name']}:={yaml.safe_load(said(one['value']))}"]  # as launch_ros does
    ros += [word for name, port in zip(("front", "arm", "mast"), ports) for word in ("-p", f"{name}.port:={port}")]
    sender = start(*_SEND, *said(node[1]["args"]).split(), "--loop", *_ALONE, "--ros-args", *ros)
    for stream in range(3):
        _when(receiver, lambda one: one["rate"] > 3 and one["size"] == [640, 480], "images", stream)
    assert [word for word in ros if "bitrate" in word] == ["mast.bitrate:=300"]
    assert sender.interrupt() == 0
    assert [line for line in sender.errors if "[WARN]" in line] == []


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
    assert json.loads(*changed("--json"))["arm"] == {
        "running": False,
        "source": str(images),
        "host": "127.0.0.1",
        "port": arm,
        "size": "",
        "rate": 30.0,
        "bitrate": 1000.0,
        "min_bitrate": 150.0,
        "overlay": "",
        "pipeline": "",
    }
    assert "front.rate: 30.0" in changed()


@pytest.mark.slow
@needs_dds
def test_a_stream_whose_recording_has_ended_gets_another_source(start: Start, called: Called, images: Path) -> None:
    """As long as another stream keeps the sender running."""
    webcam = Webcam([_JPEG], pause_s=0.03)
    receiver, (front, arm) = _receiver(start, "front arm", "--no-page")
    arm_stream = {"source": f"http://{webcam.address}/video", "port": arm}
    file = _write_streams(images, front={"source": "images", "port": front}, arm=arm_stream)
    sender = start(*_SEND, file, "--middleware", "dds")
    _when(receiver, lambda one: one["size"] == [320, 240], "images")
    _when(receiver, lambda one: one["stale"], "the end of the recording", after=len(receiver.output))
    assert called("video", "set", f"front.source=http://{webcam.address}/video", "--middleware", "dds")[0] == 0
    _when(receiver, lambda one: one["size"] == [64, 48], "the other camera")
    assert sender.interrupt() == 0
    webcam.close()


@pytest.mark.slow
@needs_dds
def test_a_change_that_is_not_possible_is_told(start: Start, images: Path, peer: socket.socket, called: Called) -> None:
    """In one line, with exit code 2; the streams stay as they are."""
    sender = start(*_SEND, images, "--port", peer.getsockname()[1], "--loop", "--middleware", "dds")
    sender.wait_for("video: images go to 127.0.0.1:")
    for change, problem in (
        ("video.bitrate=5", "stream video: the bitrate is 5 and the least one 150 kbit/s; both must be from 10"),
        ("video.size=big", "the parameter 'video.size' is wrong: 'big' is not an image size"),
        ("video.running=no", "the parameter 'video.running' is 'no'; it must be true or false"),
        ("video.bitrat=5", "unknown parameter 'video.bitrat'; did you mean 'video.bitrate'?"),
        ("vidoe.rate=5", "no sender has a stream 'vidoe'; did you mean 'video'?"),
    ):
        code, output, errors = called("video", "set", change, "--middleware", "dds")
        assert (code, output, errors.count("\n")) == (2, "", 0)
        assert errors.startswith(f"roverlink: {problem}")
    assert sender.interrupt() == 0
    assert not any("is now" in line for line in sender.errors)


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


@pytest.mark.slow
def test_a_camera_that_is_missing_does_not_stop_the_others(start: Start, images: Path) -> None:
    """It is tried again and again; an address that the network refuses is told, too, and the rest goes on."""
    receiver, (port,) = _receiver(start, "front", "--no-page")
    front, mast = {"source": "images", "port": port}, {"source": "images", "host": "255.255.255.255"}
    arm = {"source": 7, "port": port, "host": "127.0.0.2"}
    sender = start(*_SEND, _write_streams(images, front=front, arm=arm, mast=mast), "--loop", *_ALONE)
    sender.wait_for("arm: cannot open camera 7; check that it exists, and that no other program uses it; trying again")
    sender.wait_for("mast: cannot send to 255.255.255.255:4500: Permission denied; check the address and the network")
    _when(receiver, lambda one: one["rate"] > 10, "images")
    assert sender.interrupt() == 0
