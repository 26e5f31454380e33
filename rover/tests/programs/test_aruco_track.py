"""`roverlink aruco track`, from frames of known truth to whoever wants to know."""

from __future__ import annotations

import io
import sys
import time
from pathlib import Path

import pytest
from needs import NO_OPENCV, needs_dds
from node_in_memory import hear
from polling import wait_until

from roverlink.__main__ import main
from roverlink.runtime.middleware import NodeIdentity, open_middleware

cv2 = pytest.importorskip("cv2", reason=NO_OPENCV)
np = pytest.importorskip("numpy", reason=NO_OPENCV)

from driven_film import Field, lines  # noqa: E402  # they need OpenCV
from roverkit.demo.field import landmarks  # noqa: E402

from roverlink.runtime.interfaces import geometry_msgs, sensor_msgs, tf2_msgs, vision_msgs  # noqa: E402

_FRAMES = 6


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Field:
    """A short drive."""
    return Field.written(tmp_path_factory.mktemp("field"), _FRAMES)


@pytest.mark.slow
@pytest.mark.opencv
def test_json_says_what_is_where(field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A line a frame has stamp, landmarks to 2 % of their distance, and camera; a film does not replace its source."""
    film = tmp_path / "seen.avi"
    views, told = lines(capsys, field.words("--json", "--save", film))
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
    assert f"{_FRAMES} frames, {_FRAMES} of them with landmarks (10, 7, 8, 9)" in told
    capture = cv2.VideoCapture(str(film))
    images = [image.astype(int) for found, image in iter(capture.read, (False, None)) if found]
    assert len(images) == _FRAMES
    coloured = np.ptp(images[0], axis=2) > 80  # the frames are grey
    assert 300 < coloured.sum() < 20_000
    assert lines(capsys, field.words("--json", "--count", 2))[0] == views[:2]  # nothing depends on the time
    before = film.read_bytes()
    again = ("--parameters", field.folder / "camera.yml", "--save", film)
    assert main(["aruco", "track", str(film), *map(str, again)]) == 2
    assert "seen.avi is the source of the images; give --save another name" in capsys.readouterr().err
    assert film.read_bytes() == before


@pytest.mark.slow
def test_a_landmark_that_was_moved_is_named(field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It is left out, and said once."""
    moved = tmp_path / "moved.yaml"
    text = (field.folder / "landmarks.yaml").read_text()
    moved.write_text(text.replace("9: {position: [2.6, -0.5", "9: {position: [2.6, -0.2"))
    views, told = lines(capsys, field.words("--json", "--landmarks", moved))
    assert all(view["camera"]["rejected"] == [9] for view in views)
    assert told.count("9 is not at the position in the landmarks file") == 1


def _of_images(field: Field, folder: Path, *images: object) -> list[str]:
    """The command line that tracks other images."""
    for number, image in enumerate(images):
        cv2.imwrite(str(folder / f"{number}.png"), image)
    return [word.replace(str(field.folder / "frames"), str(folder)) for word in field.words("--json")]


def test_markers_that_share_a_number_are_told_and_no_landmarks(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each has its pose, the position comes from the others, and the log warns once."""
    image = field.film.frames[0].copy()
    image[150:202, 350:402] = image[150:202, 176:228]  # a second marker 7
    views, told = lines(capsys, _of_images(field, tmp_path, image, image))
    for view in views:
        assert [(one["id"], one["shared"]) for one in view["markers"]] == [
            (number, number == 7) for number in (7, 7, 8, 9, 10)
        ]
        assert (view["camera"]["used"], view["camera"]["rejected"]) == ([8, 9, 10], [])
    assert told.count("several markers with the number 7 are visible") == 1


@pytest.mark.slow
def test_another_dictionary_is_suggested(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Once, if markers are visible and none is of the chosen dictionary."""
    told = lines(capsys, field.words("--json", "--dictionary", "DICT_6X6_250"))[1]
    expected = (
        "no marker of DICT_6X6_250 was found, but the image shows 4 markers of DICT_5X5_50 (7, 8, 9, 10); "
        "use --dictionary DICT_5X5_50"
    )
    assert told.count(expected) == 1


@pytest.mark.parametrize(
    ("sides", "assumed"),
    [(["7=0.15"], "no --side; assuming 0.05 m for the black square of marker 8"), (["0.05"], ""), (["0.15"], "")],
)
def test_an_assumed_side_is_told_once(
    sides: list[str], assumed: str, field: Field, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without `--side`, for the first marker that has no side of its own."""
    images = ("--parameters", str(field.folder / "camera.yml"), "--count", "2", "--json")
    options = [word for side in sides for word in ("--side", side)]
    _, told = lines(capsys, ["aruco", "track", str(field.folder / "frames"), *images, *options])
    assert (told.count("no --side"), assumed in told) == (int(bool(assumed)), True)


@pytest.mark.slow
def test_new_markers_are_searched_for_as_often_as_asked(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """At 30 images a second with `--scan-period 0.06` in every second one; at two a second in every one."""
    words = _of_images(field, tmp_path, np.full_like(field.film.frames[0], 128), *field.film.frames[:3])
    for rate, found in (("30", [0, 0, 4, 4]), ("2", [0, 4, 4, 4])):
        views, _ = lines(capsys, [*words, "--scan-period", "0.06", "--rate", rate])
        assert [len(view["markers"]) for view in views] == found


@pytest.mark.slow
@pytest.mark.opencv
def test_another_image_size_is_refused_or_scaled(
    field: Field, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Parameters of another size are refused; `--rescale` takes them, says so, and distances are still true."""
    image = field.film.frames[0]
    words = _of_images(field, tmp_path, cv2.resize(image, (480, 360), interpolation=cv2.INTER_AREA))
    assert main(words) == 2
    assert "for images of 640x480 pixels, but the images have 480x360; calibrate at this" in capsys.readouterr().err
    (view,), told = lines(capsys, [*words, "--rescale"])
    assert "the parameters were scaled from images of 640x480 pixels to 480x360" in told
    assert field.off(0, view["camera"]["position"]) < 0.02
    _of_images(field, tmp_path, cv2.resize(image, (640, 360), interpolation=cv2.INTER_AREA))
    assert main([*words, "--rescale"]) == 2
    assert "they were cropped or stretched" in capsys.readouterr().err


_ROVER = """%YAML:1.0
---
camera_matrix: !!opencv-matrix {{rows: 3, cols: 3, dt: d, data: [1163.311, 0., {}, 0., 1168.458, {}, 0., 0., 1.]}}
distortion_coefficients: !!opencv-matrix
  {{rows: 1, cols: 5, dt: d, data: [0.100096, -0.256227, 0.00111085, 0.000269882, 0.203651]}}
"""


@pytest.mark.parametrize(
    ("centre", "size", "expected"),
    [
        (
            (941.628, 618.535),
            None,
            "rover.yml: the principal point (941.6, 618.5) is outside the image of 640x480 pixels; its parameters are "
            "likely for images of 1920x1200; calibrate at this size; or add image_width and image_height to the file",
        ),
        ((400, 239.5), None, "is far from the centre of the image of 640x480 pixels; its parameters are likely for"),
        ((200, 900), None, "its parameters are likely for images of about 401x1801; calibrate"),
        ((700, 239.5), (640, 480), "is outside the image of 640x480 pixels; its parameters are likely for images of"),
        ((460, 239.5), (640, 480), "if the camera does not crop its images, calibrate again"),
        ((319.5, 239.5), None, "rover.yml names no image size; assuming 640x480"),
    ],
)
def test_a_principal_point_that_does_not_fit_is_told(
    field: Field,
    centre: tuple[float, float],
    size: tuple[int, int] | None,
    expected: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Parameters of other images are refused with a likely size; those for this size are only doubted inside it."""
    text = _ROVER.format(*(float(one) for one in centre))
    if size is not None:
        text = text.replace("camera_matrix", "image_width: {}\nimage_height: {}\ncamera_matrix".format(*size))
    (tmp_path / "rover.yml").write_text(text)
    code = main(field.words("--json", "--count", 1, "--parameters", tmp_path / "rover.yml"))
    assert code == (0 if "if the camera" in expected or "assuming" in expected else 2)
    assert expected in capsys.readouterr().err


@pytest.mark.slow
def test_the_options_of_the_covariance_are_used(field: Field, capsys: pytest.CaptureFixture[str]) -> None:
    """Each one changes the covariances, and no pose."""
    (plain,), _ = lines(capsys, field.words("--json", "--count", 1))
    for option, value in (("--side-sigma", 0.05), ("--corner-floor", 1), ("--covariance-scale", 9)):
        (changed,), _ = lines(capsys, field.words("--json", "--count", 1, option, value))
        for before, after in zip(plain["markers"], changed["markers"], strict=True):
            assert after["position"] == pytest.approx(before["position"])
            assert after["covariance"][14] > 2 * before["covariance"][14]


@pytest.mark.slow
@needs_dds
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
        heard = {topic: hear(middleware, topic, kind) for topic, kind in topics.items()}
        assert main(field.words(*names, "--ros-args", *ros)) == 0
        wait_until(lambda: all(heard.values()), "a message of each topic")
    transforms = [one for message in heard["/tf"] for one in message.transforms]
    assert {(one.header.frame_id, one.child_frame_id) for one in transforms} == {
        ("eye", f"mark_{number}") for number in (7, 8, 9, 10)
    }
    stamps = {one.header.stamp.sec * 10**9 + one.header.stamp.nanosec for one in transforms}
    assert began < min(stamps) <= max(stamps) < time.time_ns()
    for message in heard["/front/aruco/camera_pose"]:
        place = message.pose.pose.position
        assert min(field.off(number, (place.x, place.y, place.z)) for number in range(_FRAMES)) < 0.01
    image = cv2.imdecode(np.frombuffer(heard["/front/aruco/image/compressed"][0].data, np.uint8), 1)
    assert image.shape == (480, 640, 3)


@pytest.mark.parametrize(
    ("answer", "expected"),
    [("", "cannot open camera 0"), ("97", "cannot open camera 97"), ("{}", "640x480"), (None, "")],
)
def test_it_asks_for_the_source(
    field: Field, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], answer: str | None, expected: str
) -> None:
    """ENTER is camera 0, a number another; any other source will do. Without a terminal, nobody is asked."""
    frames = str(field.folder / "frames")
    monkeypatch.setattr(sys, "stdin", io.StringIO("" if answer is None else f"{answer}\n".format(frames)))
    for stream in (sys.stdin, sys.stderr):
        monkeypatch.setattr(stream, "isatty", lambda: answer is not None)
    code = main([one for one in field.words("--json") if one != frames])
    output, shown = capsys.readouterr()
    question = "Camera number, URL, topic:NAME, video file or folder (ENTER for camera 0): "
    assert (question if answer is not None else "no source given; using camera 0") in shown
    assert expected in shown
    assert code == (0 if answer == "{}" else 2)
    assert len(output.splitlines()) == (_FRAMES if answer == "{}" else 0)
