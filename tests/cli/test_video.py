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
from polling import wait_until
from programs import Program, Start

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


@pytest.fixture
def port() -> int:
    """A free UDP port."""
    return _free_port()


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        return int(sock.getsockname()[1])


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


def test_images_arrive_and_are_saved(start: Start, images: Path, port: int, tmp_path: Path) -> None:
    """The receiver tells where they come from, and counts; the file can be played, and its images have even sides."""
    receiver = start(*_RECEIVE, f"front={port}", "--json", "--save", tmp_path / "today", "--page", "0")
    receiver.wait_for("page: http://127.0.0.1:")
    sender = start(*_SEND, images, "--port", port, "--loop", "--overlay", "time", *_ALONE)
    state = _when(receiver, lambda one: one["rate"] > 10, "images")
    assert state | {"name": "front", "port": port, "size": [320, 240], "stale": False} == state
    assert 0 <= state["latency"] < 60
    receiver.wait_for("front: images come from 127.0.0.1:")
    assert sender.interrupt() == 0
    receiver.wait_for("front: no image for a second")
    assert receiver.interrupt() == 0
    with av.open(str(tmp_path / "today" / "front.mkv")) as container:
        frames = list(container.decode(video=0))
    assert len(frames) > 10
    assert (frames[0].width, frames[0].height) == (320, 240)


def test_a_recording_that_ends_ends_the_sender(images: Path, port: int) -> None:
    """Without --loop."""
    assert main([*_SEND, str(images), "--port", str(port), "--rate", "60", *_ALONE]) == 0


@pytest.mark.slow
def test_the_page_shows_all_streams(start: Start, images: Path, port: int) -> None:
    """The newest image of each; a stream that has ended is marked as stale, and one that never came says its port."""
    receiver = start(*_RECEIVE, f"front={port}", "arm=0", "--page", "0")
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


def test_other_sites_do_not_see_the_images(start: Start, port: int) -> None:
    """A page of another site may not embed them; and nobody gets a stream that does not exist."""
    receiver = start(*_RECEIVE, f"front={port}", "--page", "0")
    url = receiver.wait_for("page: ").rpartition("page: ")[2]
    for path, headers, status in (
        ("video/front", {"Sec-Fetch-Site": "cross-site"}, 403),
        ("video/front", {"Host": "evil.example"}, 403),
        ("video/arm", {}, 404),
    ):
        request = urllib.request.Request(url + path, headers=headers)
        with pytest.raises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(request, timeout=30)
        assert caught.value.code == status


@needs_dds
def test_images_of_a_topic_come_out_of_a_topic(
    start: Start, port: int, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sender on one topic, a receiver on another; the stamps are those of the camera.

    The size may change. Images with an unknown encoding are told once, and left out.
    """
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])
    receiver = start(*_RECEIVE, f"front={port}", "--topic", "--middleware", "dds", "--no-page")
    sender = start(*_SEND, "topic:/camera", "--port", port, "--middleware", "dds")
    arrived: list[sensor_msgs.CompressedImage] = []
    with open_middleware("dds", NodeIdentity("camera")) as node:
        node.subscribe(
            "/video/front/compressed",
            sensor_msgs.CompressedImage,
            Qos(),
            lambda messages: arrived.extend(cdr.decode(sensor_msgs.CompressedImage, one) for one in messages),
        )
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
def test_a_camera_that_disappears_comes_back(start: Start, port: int) -> None:
    """The receiver marks its stream as old meanwhile."""
    jpeg = cv2.imencode(".jpg", np.full((48, 64, 3), 90, np.uint8))[1].tobytes()
    webcam = Webcam([jpeg], pause_s=0.03)
    receiver = start(*_RECEIVE, f"front={port}", "--json", "--no-page")
    sender = start(*_SEND, f"http://{webcam.address}/video", "--port", port, *_ALONE)
    _when(receiver, lambda one: one["rate"] > 5, "images")
    webcam.close()
    sender.wait_for("has ended; opening it again")
    _when(receiver, lambda one: one["stale"], "the end of the images", after=len(receiver.output))
    webcam = Webcam([jpeg], pause_s=0.03, port=webcam.port)
    sender.wait_for("is back after")
    _when(receiver, lambda one: one["rate"] > 5, "images", after=len(receiver.output))
    assert sender.interrupt() == 0
    webcam.close()


def test_without_an_encoder_nothing_is_sent(
    images: Path, port: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Some builds of PyAV have none; the user learns which one has."""
    monkeypatch.setattr(av, "codecs_available", set())
    assert main([*_SEND, str(images), "--port", str(port), *_ALONE]) == 2
    error = capsys.readouterr().err
    assert "this PyAV has no encoder for H.264 (libx264); install PyAV from PyPI" in error
    assert error.count("\n") == 1


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
    ros, ports = [], {name: _free_port() for name in ("front", "arm", "mast")}
    for kind, one in parameters:
        assert kind == "set_parameter"
        if "if" not in one or said(one["if"]) != "$(eval \"'' != ''\")":
            ros += ["-p", f"{one['name']}:={yaml.safe_load(said(one['value']))}"]  # as launch_ros does
    ros += [word for name, port in ports.items() for word in ("-p", f"{name}.port:={port}")]
    receiver = start(*_RECEIVE, *(f"{name}={port}" for name, port in ports.items()), "--json", "--no-page")
    sender = start(*_SEND, *said(node[1]["args"]).split(), "--loop", *_ALONE, "--ros-args", *ros)
    for stream in range(3):
        _when(receiver, lambda one: one["rate"] > 3 and one["size"] == [640, 480], "images", stream)
    assert [word for word in ros if "bitrate" in word] == ["mast.bitrate:=300"]
    assert sender.interrupt() == 0
    assert [line for line in sender.errors if "[WARN]" in line] == []


@pytest.mark.slow
@needs_dds
def test_running_streams_are_changed(start: Start, done: Start, images: Path, port: int) -> None:
    """Stopped, started, and given another size and another camera, by the name of the stream."""
    other = images.parent / "other"
    other.mkdir()
    cv2.imwrite(str(other / "0.png"), np.full((64, 96, 3), 90, np.uint8))
    arm = _free_port()
    streams = {"front": {"source": "images", "port": port}, "arm": {"source": "images", "port": arm, "running": False}}
    (images.parent / "video.yaml").write_text(json.dumps({"host": "127.0.0.1", "streams": streams}))
    receiver = start(*_RECEIVE, f"front={port}", f"arm={arm}", "--json", "--no-page")
    start(*_SEND, images.parent / "video.yaml", "--loop", "--middleware", "dds")

    def changed(*words: str) -> list[str]:
        code, output, errors = done("video", "set", *words, "--middleware", "dds")  # type: ignore[misc]
        assert (code, errors) == (0, "")
        return str(output).splitlines()

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
def test_a_stream_whose_recording_has_ended_gets_another_source(
    start: Start, done: Start, images: Path, port: int
) -> None:
    """As long as another stream keeps the sender running."""
    webcam = Webcam([cv2.imencode(".jpg", np.full((48, 64, 3), 90, np.uint8))[1].tobytes()], pause_s=0.03)
    streams = {
        "front": {"source": "images", "port": port},
        "arm": {"source": f"http://{webcam.address}/video", "port": _free_port()},
    }
    (images.parent / "video.yaml").write_text(json.dumps({"host": "127.0.0.1", "streams": streams}))
    receiver = start(*_RECEIVE, f"front={port}", "--json", "--no-page")
    _when(receiver, lambda one: one["port"] == port, "the receiver")  # before the short recording
    sender = start(*_SEND, images.parent / "video.yaml", "--middleware", "dds")
    _when(receiver, lambda one: one["size"] == [320, 240], "images")
    _when(receiver, lambda one: one["stale"], "the end of the recording", after=len(receiver.output))
    words = ("video", "set", f"front.source=http://{webcam.address}/video", "--middleware", "dds")
    assert done(*words)[0] == 0  # type: ignore[index]
    _when(receiver, lambda one: one["size"] == [64, 48], "the other camera")
    assert sender.interrupt() == 0
    webcam.close()


@pytest.mark.slow
@needs_dds
def test_a_change_that_is_not_possible_is_told(
    start: Start,
    images: Path,
    port: int,
    environment: dict[str, str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """In one line, with exit code 2; the streams stay as they are."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])
    sender = start(*_SEND, images, "--port", port, "--loop", "--middleware", "dds")
    sender.wait_for("video: images go to 127.0.0.1:")
    for change, problem in (
        ("video.bitrate=5", "stream video: the bitrate is 5 and the least one 150 kbit/s; both must be from 10"),
        ("video.size=big", "the parameter 'video.size' is wrong: 'big' is not an image size"),
        ("video.running=no", "the parameter 'video.running' is 'no'; it must be true or false"),
        ("video.bitrat=5", "unknown parameter 'video.bitrat'; did you mean 'video.bitrate'?"),
        ("vidoe.rate=5", "no sender has a stream 'vidoe'; did you mean 'video'?"),
    ):
        assert main(["video", "set", change, "--middleware", "dds"]) == 2
        said = capsys.readouterr()
        assert said.out == ""
        assert said.err.startswith(f"roverlink: {problem}")
        assert said.err.count("\n") == 1
    assert sender.interrupt() == 0
    assert not any("is now" in line for line in sender.errors)


def test_without_a_sender_nothing_is_set(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The user learns where it was looked for."""
    monkeypatch.setattr(setting, "FIND_S", 0.1)
    assert main(["video", "set", "front.rate=5", "--middleware", "memory", "--ros-args", "-r", "__ns:=/rover"]) == 2
    assert "no sender of video was found on /rover/video/streams; start" in capsys.readouterr().err


def _pixels(message: sensor_msgs.CompressedImage) -> Any:
    return cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)


_FILE = "host: 127.0.0.1\nstreams:\n  front: {source: images, port: 4500}\n"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["nothing.mp4"], "no file or folder 'nothing.mp4'"),
        (["7"], "cannot open camera 7; check that it exists"),
        (["images", "--host", "nowhere.invalid"], "the destination 'nowhere.invalid' does not resolve"),
        (["images", "--size", "641x480"], "the size is 641x480; width and height must be even"),
        (["images", "--overlay", "tim"], "unknown overlay 'tim'; did you mean 'time'?"),
        (["images", "--overlay", "link"], "the overlays 'objects' and 'link' come from ROS 2"),
        (["images", "--bitrate", "5"], "the bitrate is 5 and the least one 150 kbit/s; both must be from 10"),
        (["images", "--link-rate", "0"], "the link rate is 0 kbit/s; it must be from 10 to 10000000"),
        (["images", "--pipeline", "x264enc $speed"], "the pipeline has a wrong placeholder ('speed'); known are $host"),
        (
            ["video.yaml", "--size", "64x48"],
            "--size has no effect with a file of streams; write 'size' into video.yaml",
        ),
        (["images", "--ros-args", "-p", "video.bitrat:=1"], "unknown parameter 'video.bitrat'; did you mean"),
        (
            ["images", "--ros-args", "-p", "video.size:=big"],
            "the parameter 'video.size' is wrong: 'big' is not an image",
        ),
        (["images", "--ros-args", "-p", "video.rate:=0"], "stream video: the rate is 0; it must be from 0.1 to 240"),
    ],
)
def test_mistakes_are_told(
    images: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str], text: str
) -> None:
    """In one line, with exit code 2."""
    monkeypatch.chdir(images.parent)
    if "--pipeline" in words:
        _needs_gstreamer()
    Path("video.yaml").write_text(_FILE)
    own, _, ros = " ".join(words).partition(" --ros-args") if "--ros-args" in words else ("", "", "")
    given = [*own.split(), *_ALONE, "--ros-args", *ros.split()] if own else [*words, *_ALONE]
    assert main([*_SEND, *given]) == 2
    error = capsys.readouterr().err
    assert text in error
    assert error.count("\n") == 1


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
        (
            "host: a\nstreams: {f: {source: x, size: [1, 2, 3]}}",
            "stream f: size is a list of 3; it must be a list of 2",
        ),
    ],
)
def test_mistakes_in_the_file_have_their_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], text: str, message: str
) -> None:
    """File, line and column."""
    monkeypatch.chdir(tmp_path)
    Path("video.yaml").write_text(text)
    assert main([*_SEND, "video.yaml", *_ALONE]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.startswith("roverlink: video.yaml:")


def test_the_receiver_tells_mistakes(port: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A port in use, streams with one name, a folder that cannot be, and options without effect."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("", port))
        assert main([*_RECEIVE, str(port), "--no-page"]) == 2
    (tmp_path / "file").write_text("")
    assert main([*_RECEIVE, f"a={port}", f"b={port}"]) == 2
    assert main([*_RECEIVE, str(port), "--no-page", "--save", str(tmp_path / "file")]) == 2
    assert main([*_RECEIVE, str(port), "--mp4"]) == 2
    assert main([*_RECEIVE, str(port), "--topic", *_ALONE]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.partition(": ")[2][:40] for line in lines] == [
        text[:40]
        for text in (
            f"UDP port {port} on 0.0.0.0 is in use by another program; stop",
            f"the streams a={port} and b={port} must have different names",
            f"{tmp_path / 'file'}: cannot make the folder: File exists",
            "--mp4 has no effect without --save FOLDER",
            "--topic needs ROS 2; leave --middleware none out",
        )
    ]


@pytest.mark.slow
def test_a_camera_that_is_missing_does_not_stop_the_others(start: Start, images: Path, port: int) -> None:
    """It is tried again and again; an address that the network refuses is told, too, and the rest goes on."""
    streams = {
        "front": {"source": "images", "port": port},
        "arm": {"source": 7, "port": port},
        "mast": {"source": "images", "host": "255.255.255.255"},
    }
    streams["arm"]["host"] = "127.0.0.2"
    (images.parent / "video.yaml").write_text(json.dumps({"host": "127.0.0.1", "streams": streams}))
    receiver = start(*_RECEIVE, f"front={port}", "--json", "--no-page")
    sender = start(*_SEND, images.parent / "video.yaml", "--loop", *_ALONE)
    sender.wait_for("arm: cannot open camera 7; check that it exists, and that no other program uses it; trying again")
    sender.wait_for("mast: cannot send to 255.255.255.255:4500: Permission denied; check the address and the network")
    _when(receiver, lambda one: one["rate"] > 10, "images")
    assert sender.interrupt() == 0


def _needs_gstreamer() -> None:
    import shutil

    if shutil.which("gst-launch-1.0") is None:
        pytest.skip("need GStreamer (apt-get install gstreamer1.0-tools)")
