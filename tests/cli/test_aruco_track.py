"""`roverlink aruco track`, from frames of known truth to whoever wants to know."""

from __future__ import annotations

import contextlib
import io
import json
import os
import socket
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from needs import NO_OPENCV, needs_dds
from polling import PATIENCE_S, wait_until

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)

from bench.vision.circling_film import FOLDER, Film, render_film, rover_position  # noqa: E402  # they need OpenCV
from roverlink.demo.field import SIDE, landmarks, write_cameras, write_field  # noqa: E402
from roverlink.runtime.interfaces import geometry_msgs, sensor_msgs, tf2_msgs, vision_msgs  # noqa: E402

_FRAMES = 6

Start = Callable[..., Any]


@dataclass(frozen=True)
class Field:
    """A drive on a field as files, and its truth."""

    folder: Path
    film: Film

    def words(self, *more: object) -> list[str]:
        """The command line that tracks it."""
        given = (
            "--parameters",
            self.folder / "camera.yml",
            "--side",
            SIDE,
            "--landmarks",
            self.folder / "landmarks.yaml",
        )
        return ["aruco", "track", *map(str, (self.folder / "frames", *given, "--rate", 10, *more))]

    def off(self, number: int, position: Sequence[float]) -> float:
        """Metres from a position to where the camera was in a frame."""
        return float(np.linalg.norm(self.film.truth[number % _FRAMES].translation - position))


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Field:
    """A short drive."""
    folder = tmp_path_factory.mktemp("field")
    film = render_film(_FRAMES)
    (folder / "frames").mkdir()
    for frame in film:
        cv2.imwrite(str(folder / "frames" / f"{frame.number}.png"), frame.image)
    write_field(folder)
    return Field(folder, film)


def _lines(capsys: pytest.CaptureFixture[str], words: list[str]) -> list[Any]:
    assert main(words) == 0
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_json_says_what_is_where(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """A line a frame: stamps of the recording, each landmark to 2 % of its distance, the camera at its true place."""
    views = _lines(capsys, field.words("--json"))
    assert [(view["stamp"], view["frame"]) for view in views] == [(index * 10**8, index) for index in range(_FRAMES)]
    for view in views:
        camera = field.film.truth[view["frame"]].inverse()
        assert [one["id"] for one in view["markers"]] == [7, 8, 9, 10]
        for one in view["markers"]:
            there = camera.apply(landmarks().places[one["id"]].pose.translation)
            assert np.linalg.norm(one["position"] - there) < 0.02 * np.linalg.norm(there)
            assert np.shape(one["corners"]) == (4, 2)
        assert field.off(view["frame"], view["camera"]["position"]) < 0.01
        assert view["camera"]["frame"] == "map"
        assert view["camera"]["used"] == [7, 8, 9, 10]
        assert np.linalg.eigvalsh(np.reshape(view["camera"]["covariance"], (6, 6))).min() > 0


def test_the_same_frames_give_the_same_lines(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing of a recording's account depends on the time; `--count` ends it early."""
    first, second = (_lines(capsys, field.words("--json", "--count", 2)) for _ in range(2))
    assert first == second
    assert len(first) == 2


def test_a_landmark_that_was_moved_is_named(field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It is left out, and said once."""
    moved = tmp_path / "moved.yaml"
    text = (field.folder / "landmarks.yaml").read_text()
    moved.write_text(text.replace("9: {position: [2.6, -0.5", "9: {position: [2.6, -0.2"))
    assert main(field.words("--json", "--landmarks", moved)) == 0
    told = capsys.readouterr()
    assert all(json.loads(line)["camera"]["rejected"] == [9] for line in told.out.splitlines())
    assert told.err.count("9 is not at the position in the landmarks file") == 1


def test_markers_that_share_a_number_are_told_and_no_landmarks(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each has its pose, the position comes from the others, and the log warns once."""
    image = field.film.frames[0].copy()
    image[150:202, 350:402] = image[150:202, 176:228]  # a second marker 7
    frames = tmp_path / "frames"
    frames.mkdir()
    for number in range(2):
        cv2.imwrite(str(frames / f"{number}.png"), image)
    assert main([word.replace(str(field.folder / "frames"), str(frames)) for word in field.words("--json")]) == 0
    told = capsys.readouterr()
    for view in map(json.loads, told.out.splitlines()):
        assert [(one["id"], one["shared"]) for one in view["markers"]] == [
            (number, number == 7) for number in (7, 7, 8, 9, 10)
        ]
        assert (view["camera"]["used"], view["camera"]["rejected"]) == ([8, 9, 10], [])
    assert told.err.count("several markers with the number 7 are visible") == 1


def test_another_dictionary_is_suggested(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Once, if markers are visible and none is of the chosen dictionary."""
    assert main(field.words("--json", "--dictionary", "DICT_6X6_250")) == 0
    expected = (
        "no marker of DICT_6X6_250 was found, but the image shows 4 markers of DICT_5X5_50 (7, 8, 9, 10); "
        "use --dictionary DICT_5X5_50"
    )
    assert capsys.readouterr().err.count(expected) == 1


def test_new_markers_are_searched_for_as_often_as_asked(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With `--scan-every 2` in every second frame."""
    for number, image in enumerate([np.full_like(field.film.frames[0], 128), *field.film.frames[:3]]):
        cv2.imwrite(str(tmp_path / f"{number}.png"), image)
    words = [word.replace(str(field.folder / "frames"), str(tmp_path)) for word in field.words("--json")]
    assert [len(view["markers"]) for view in _lines(capsys, [*words, "--scan-every", "2"])] == [0, 0, 4, 4]


def test_a_film_is_saved_without_ros(field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It has every frame, and what was seen drawn into it; the sums are told."""
    film = tmp_path / "seen.avi"
    assert main(field.words("--save", film)) == 0
    capture = cv2.VideoCapture(str(film))
    images = []
    while capture.grab():
        images.append(capture.retrieve()[1].astype(int))
    assert len(images) == _FRAMES
    coloured = np.ptp(images[0], axis=2) > 80  # the frames are grey
    assert 300 < coloured.sum() < 20_000
    assert f"{_FRAMES} frames, {_FRAMES} of them with landmarks (10, 7, 8, 9)" in capsys.readouterr().err


def _resized(field: Field, folder: Path, size: tuple[int, int]) -> Path:
    folder.mkdir()
    image = cv2.resize(field.film.frames[0], size, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(folder / "0.png"), image)
    return folder


def test_another_image_size_is_refused_or_scaled(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Parameters of another size are refused; `--rescale` takes them, says so, and distances are still true."""
    frames = _resized(field, tmp_path / "small", (480, 360))
    words = [word.replace(str(field.folder / "frames"), str(frames)) for word in field.words("--json")]
    assert main(words) == 2
    assert "for images of 640x480 pixels, but the images have 480x360; calibrate at this" in capsys.readouterr().err
    assert main([*words, "--rescale"]) == 0
    told = capsys.readouterr()
    assert "the parameters were scaled from images of 640x480 pixels to 480x360" in told.err
    assert field.off(0, json.loads(told.out)["camera"]["position"]) < 0.02


def test_a_cut_image_is_not_scaled(field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Where width and height have another ratio no scale is right."""
    frames = _resized(field, tmp_path / "cut", (640, 360))
    words = [word.replace(str(field.folder / "frames"), str(frames)) for word in field.words("--json", "--rescale")]
    assert main(words) == 2
    assert "they were cropped or stretched" in capsys.readouterr().err


def test_parameters_without_a_size_are_taken_and_told(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The rover's own file says no size."""
    text = (field.folder / "camera.yml").read_text()
    (tmp_path / "old.yml").write_text("\n".join(line for line in text.splitlines() if "image_" not in line))
    assert main(field.words("--json", "--parameters", tmp_path / "old.yml")) == 0
    assert "old.yml names no image size; assuming 640x480" in capsys.readouterr().err


_ROVER = """%YAML:1.0
---
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1163.311, 0., 941.628, 0., 1168.458, 618.535, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 0.100096, -0.256227, 0.00111085, 0.000269882, 0.203651 ]
"""


@pytest.mark.parametrize(
    ("centre", "size", "told"),
    [
        (
            "941.628 618.535",
            None,
            "rover.yml: the principal point (941.6, 618.5) is outside the image of 640x480 pixels; its parameters are "
            "likely for images of 1920x1200; calibrate at this size; or add image_width and image_height to the file",
        ),
        ("400.0 239.5", None, "is far from the centre of the image of 640x480 pixels; its parameters are likely for"),
        ("200.0 900.0", None, "its parameters are likely for images of about 401x1801; calibrate"),
        ("700.0 239.5", (640, 480), "is outside the image of 640x480 pixels; its parameters are likely for images of"),
        ("460.0 239.5", (640, 480), "if the camera does not crop its images, calibrate again"),
    ],
)
def test_a_principal_point_that_does_not_fit_is_told(
    field: Field,
    centre: str,
    size: tuple[int, int] | None,
    told: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Parameters of other images are refused with a likely size; those for this size are only doubted inside it."""
    text = _ROVER
    for old, new in zip(("941.628", "618.535"), centre.split(), strict=True):
        text = text.replace(old, new)
    if size is not None:
        text = text.replace("camera_matrix", "image_width: {}\nimage_height: {}\ncamera_matrix".format(*size))
    (tmp_path / "rover.yml").write_text(text)
    code = main(field.words("--json", "--parameters", tmp_path / "rover.yml"))
    assert code == (0 if "if the camera" in told else 2)
    assert told in capsys.readouterr().err


def test_a_recording_is_not_replaced_by_its_film(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Somebody who gives the same name twice keeps the recording."""
    recording = field.folder / "drive.avi"
    assert main(field.words("--save", recording)) == 0
    before = recording.read_bytes()
    again = ("--parameters", field.folder / "camera.yml", "--save", recording)
    assert main(["aruco", "track", str(recording), *map(str, again)]) == 2
    assert "drive.avi is the source of the images; give --save another name" in capsys.readouterr().err
    assert recording.read_bytes() == before


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (("--parameters", "none.yml"), "none.yml: no such file with camera parameters"),
        (("--dictionary", "DICT_5X5_25"), "unknown dictionary 'DICT_5X5_25'; did you mean 'DICT_5X5_250'?"),
        (("--side", "300=0.1"), "DICT_5X5_250 has no marker 300"),
        (("--boards", "none.yaml"), "cannot read the boards"),
        (("--landmarks", "none.yaml"), "cannot read the landmarks"),
        (("--covariance-scale", "0"), "covariance_scale is 0.0; it must be positive"),
        (("--save", "film.gif"), "the name must end with .mp4 or .avi"),
        (
            ("--ros-args", "-p", "rate:=10"),
            "unknown parameter 'rate'; known: dictionary, side, sides, landmarks, use_sim_time",
        ),
        (("--ros-args", "-p", "side:=wide"), "the parameter 'side' is 'wide'; it must be a number, such as 0.15"),
        (("--ros-args", "-p", "sides:=0.1"), "the parameter 'sides' is 0.1; it must be a text"),
        (("--ros-args", "-p", "sides:='7=wide'"), "the parameter 'sides': '7=wide' is not METRES or ID=METRES"),
        (("--ros-args", "-p", "sides:='7=0.1, 0.2'"), "'0.2' names no marker; write 7=0.1, or use 'side'"),
        (("--ros-args", "-p", "landmarks:=none.yaml"), "cannot read the landmarks"),
        (("--ros-args", "-p", "use_sim_time:=1"), "the parameter 'use_sim_time' is 1; it must be true or false"),
    ],
)
def test_what_cannot_be_is_told(
    field: Field, more: Sequence[str], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is missing or wrong is named, with exit code 2 and nothing on standard output."""
    assert main(field.words("--json", *more)) == 2
    told = capsys.readouterr()
    assert expected in told.err
    assert told.out == ""


@pytest.mark.parametrize("side", ["x", "0", "-1", "7=", "a=1", "nan"])
def test_a_side_that_cannot_be_is_told(side: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`--side` is metres, or a marker's number and metres."""
    with pytest.raises(SystemExit):
        main(["aruco", "track", "--side", side])
    assert "is not METRES or ID=METRES" in capsys.readouterr().err


@pytest.mark.parametrize("option", ["--side-sigma", "--corner-floor", "--covariance-scale", "--readout-time"])
@pytest.mark.parametrize("value", ["x", "-1", "nan", "inf"])
def test_an_uncertainty_that_cannot_be_is_told(option: str, value: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The options of the covariances are finite numbers that are not negative."""
    with pytest.raises(SystemExit):
        main(["aruco", "track", f"{option}={value}"])
    assert "is not a finite number of at least 0" in capsys.readouterr().err


def test_the_options_of_the_covariance_are_used(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Each one changes the covariances, and no pose."""
    found = {}
    for option, value in [("", ""), ("--side-sigma", "0.05"), ("--corner-floor", "1"), ("--covariance-scale", "9")]:
        assert main(field.words("--json", "--count", "1", *filter(None, (option, value)))) == 0
        found[option] = json.loads(capsys.readouterr().out.splitlines()[0])["markers"]
    plain = found.pop("")
    for markers in found.values():
        for before, after in zip(plain, markers, strict=True):
            assert after["position"] == pytest.approx(before["position"])
            assert after["covariance"][14] > 2 * before["covariance"][14]


def test_landmarks_have_to_be_what_can_be_seen(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A board that nobody described, and a marker that is part of a board, are no landmarks."""
    boards = tmp_path / "boards.yaml"
    boards.write_text("boards: {gate: {side: 0.15, markers: {7: {position: [0, 0, 0], rpy: [0, 0, 0]}}}}")
    assert main(field.words("--json", "--boards", boards)) == 2
    assert "landmark 7 is not a known single marker" in capsys.readouterr().err
    wall = tmp_path / "wall.yaml"
    wall.write_text("landmarks: {wall: {position: [0, 0, 0], rpy: [0, 0, 0]}}")
    assert main(field.words("--json", "--landmarks", wall)) == 2
    assert "landmark 'wall' is not a known board" in capsys.readouterr().err


def test_a_board_is_one_landmark(field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two markers of the field, taken as one board, have one pose, which is more exact than a marker's."""
    boards, gate = tmp_path / "boards.yaml", tmp_path / "gate.yaml"
    # the board's axes are the field's turned like every print here, about landmark 7: right is -y, up is z, out is -x
    dx, dy, dz = landmarks().places[8].pose.translation - landmarks().places[7].pose.translation
    boards.write_text(
        "boards: {gate: {side: 0.15, markers: {7: {position: [0, 0, 0], rpy: [0, 0, 0]}, "
        f"8: {{position: [{-dy}, {dz}, {-dx}], rpy: [0, 0, 0]}}}}}}}}"
    )
    gate.write_text("landmarks: {gate: {position: [3.0, 0.9, 0.9], rpy: [90, 0, -90]}}")
    view, *_ = _lines(capsys, field.words("--json", "--boards", boards, "--landmarks", gate, "--count", 1))
    assert {one["id"] for one in view["markers"]} == {"gate", 9, 10}
    assert field.off(0, view["camera"]["position"]) < 0.02


# --- ROS 2 ------------------------------------------------------------------------------------------------------


@pytest.fixture
def own_domain(monkeypatch: pytest.MonkeyPatch, environment: dict[str, str]) -> None:
    """DDS on this host alone, as the programs of these tests have it."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])


class Listener:
    """A ROS 2 node that listens."""

    def __init__(self, middleware: Middleware) -> None:
        self._middleware = middleware
        self.heard: dict[str, list[Any]] = {}

    def listen(self, topic: str, message_type: type[Message]) -> None:
        """Keep what comes on a topic."""
        kept = self.heard.setdefault(topic, [])
        self._middleware.subscribe(
            topic, message_type, Qos(), lambda many: kept.extend(cdr.decode(message_type, one) for one in many)
        )

    def wait(self, least: int) -> None:
        """Wait until every topic has said so much."""
        wait_until(lambda: min(map(len, self.heard.values())) >= least, f"{least} messages of each topic")


@needs_dds
@pytest.mark.usefixtures("own_domain")
def test_ros_2_hears_what_is_seen(field: Field) -> None:
    """Over DDS each topic has its message, under the names that were asked for, stamped with the time of the frame."""
    topics = {
        "/tf": tf2_msgs.TFMessage,
        "/front/aruco/mark_7/pose": geometry_msgs.PoseWithCovarianceStamped,
        "/front/seen": vision_msgs.Detection3DArray,
        "/front/aruco/camera_info": sensor_msgs.CameraInfo,
        "/front/aruco/image/compressed": sensor_msgs.CompressedImage,
        "/front/aruco/camera_pose": geometry_msgs.PoseWithCovarianceStamped,
    }
    began = time.time_ns()
    ros = ("-r", "__ns:=/front", "-r", "aruco/detections:=seen")
    names = ("--camera-frame", "eye", "--marker-frame", "mark_", "--middleware", "dds", "--count", 20, "--loop")
    with open_middleware("dds", NodeIdentity("listener")) as middleware:
        listener = Listener(middleware)
        for topic, message_type in topics.items():
            listener.listen(topic, message_type)
        assert main(field.words(*names, "--ros-args", *ros)) == 0
        listener.wait(1)
    transforms = [one for message in listener.heard["/tf"] for one in message.transforms]
    assert {(one.header.frame_id, one.child_frame_id) for one in transforms} == {
        ("eye", f"mark_{number}") for number in (7, 8, 9, 10)
    }
    stamps = {one.header.stamp.sec * 10**9 + one.header.stamp.nanosec for one in transforms}
    assert began < min(stamps) <= max(stamps) < time.time_ns()
    for message in listener.heard["/front/aruco/camera_pose"]:
        place = message.pose.pose.position
        assert min(field.off(number, (place.x, place.y, place.z)) for number in range(_FRAMES)) < 0.01
    image = cv2.imdecode(np.frombuffer(listener.heard["/front/aruco/image/compressed"][0].data, np.uint8), 1)
    assert image.shape == (480, 640, 3)


@needs_dds
@pytest.mark.slow
def test_the_basestation_hears_where_the_rover_is(field: Field, start: Start) -> None:
    """From the camera's frames over ROS 2 and the bridge to the basestation's UDP port, as programs of their own."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as basestation:
        basestation.bind(("127.0.0.1", 0))
        basestation.settimeout(PATIENCE_S)
        port = f"dst_a_port:={basestation.getsockname()[1]}"
        bridge = start("run", "--middleware", "dds", "--ros-args", "-p", "listen_port:=0", "-p", port)
        bridge.wait_for("on UDP port")
        write_cameras(field.folder, FOLDER)
        given = ("--side", SIDE, "--landmarks", field.folder / "landmarks.yaml")
        tracker = start(*("aruco", "track", field.folder / "cameras.yaml", *given, "--middleware", "dds", "--loop"))
        for _ in range(20):
            envelope = REGISTRY.envelope.FromString(basestation.recv(2000))
            place = envelope.rover_localization
            off = [rover_position(pose) - (place.x, place.y, place.z) for pose in field.film.truth]
            assert np.linalg.norm(off, axis=1).min() < 0.01
        assert tracker.interrupt() == 0
        assert "of them with landmarks (10, 7, 8, 9)" in str(tracker)
        assert bridge.interrupt() == 0


# --- which source -----------------------------------------------------------------------------------------------


def _typed(answer: str, monkeypatch: pytest.MonkeyPatch, words: list[str]) -> tuple[int, str]:
    """Run a command at a terminal at which somebody types a line; its exit code, and what the terminal showed."""
    ours, theirs = os.openpty()
    shown: list[bytes] = []

    def read() -> None:
        with contextlib.suppress(OSError):  # nobody writes any more
            while text := os.read(ours, 1000):
                shown.append(text)

    reader = threading.Thread(target=read)
    reader.start()
    with open(theirs, closefd=False) as stdin, open(theirs, "w", buffering=1, closefd=False) as stderr:
        monkeypatch.setattr(sys, "stdin", stdin)
        monkeypatch.setattr(sys, "stderr", stderr)
        os.write(ours, f"{answer}\n".encode())
        code = main(words)
    os.close(theirs)
    reader.join(PATIENCE_S)
    os.close(ours)
    return code, b"".join(shown).decode()


def _without_source(field: Field) -> list[str]:
    return [word for word in field.words("--json") if word != str(field.folder / "frames")]


@pytest.mark.parametrize(
    ("answer", "expected"), [("", "cannot open camera 0"), ("97", "cannot open camera 97"), ("{}", "640x480")]
)
def test_it_asks_for_the_source(
    field: Field, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], answer: str, expected: str
) -> None:
    """ENTER is camera 0, a number another; anything else that is a source will do."""
    code, shown = _typed(answer.format(field.folder / "frames"), monkeypatch, _without_source(field))
    assert "Camera number, URL, topic:NAME, video file or folder (ENTER for camera 0): " in shown
    assert expected in shown
    assert code == (0 if answer == "{}" else 2)
    assert len(capsys.readouterr().out.splitlines()) == (_FRAMES if answer == "{}" else 0)


def test_without_a_terminal_it_is_camera_0(
    field: Field, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nobody can be asked, so it says what it takes."""
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    assert main(_without_source(field)) == 2
    told = capsys.readouterr().err
    assert "no source given; using camera 0" in told
    assert "cannot open camera 0" in told
