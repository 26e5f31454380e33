"""The ROS 2 parameters of ``roverlink aruco track``."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from typing import Any

import pytest
from needs import NO_OPENCV

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_arguments import ros_args

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("numpy", reason=NO_OPENCV)

from roverkit.aruco.target_options import add_targets  # they need OpenCV
from roverkit.aruco.target_parameters import TargetParameters

_LANDMARKS = "landmarks: {7: {position: [0, 0, 1], rpy: [90, 0, 0]}}\n"


@pytest.fixture
def landmarks(tmp_path: Path) -> Path:
    path = tmp_path / "landmarks.yaml"
    path.write_text(_LANDMARKS)
    return path


def _parameters(*options: object, **given: Any) -> TargetParameters:
    parser = argparse.ArgumentParser()
    add_targets(parser)
    words = [word for name, value in given.items() for word in ("-p", f"{name}:={value}")]
    ros = ros_args.parse(words, "aruco_tracker")
    return TargetParameters(parser.parse_args([*map(str, options)]), ros, logging.getLogger("test"))


def test_options_are_the_first_values(landmarks: Path) -> None:
    """Each has the type that ROS 2 knows; `-p` replaces the option of the same name."""
    words = ("--dictionary", "DICT_4X4_50", "--side", 0.15, "--side", "7=0.1", "--landmarks", landmarks)
    assert _parameters(*words).values == {
        "dictionary": "DICT_4X4_50",
        "side": 0.15,
        "sides": "7=0.1",
        "landmarks": str(landmarks),
        "use_sim_time": False,
    }
    replaced = _parameters(*words, dictionary="DICT_6X6_50", side=1, sides="'8=0.2'", use_sim_time="true")
    assert replaced.targets.markers.dictionary == "DICT_6X6_50"
    assert (replaced.targets.markers.side, replaced.targets.markers.sides) == (1.0, {8: 0.2})
    assert replaced.values["use_sim_time"] is True


def test_a_file_for_several_nodes_may_have_parameters_of_others(tmp_path: Path) -> None:
    """The ones of this node are used, and those of other nodes ignored."""
    (tmp_path / "all.yaml").write_text("/**: {ros__parameters: {side: 0.3, robot_radius: 0.4}}")
    ros = ros_args.parse(["--params-file", str(tmp_path / "all.yaml")], "aruco_tracker")
    parser = argparse.ArgumentParser()
    add_targets(parser)
    assert TargetParameters(parser.parse_args([]), ros, logging.getLogger("test")).values["side"] == 0.3


def test_a_change_gives_other_targets(landmarks: Path) -> None:
    """Files are read again, also if their names stay the same; an empty name ends the use of landmarks."""
    parameters = _parameters()
    before = parameters.targets
    assert before.landmarks is None
    parameters.change({"landmarks": str(landmarks), "side": 0.2, "sides": "7=0.1, 8=0.3"})
    assert parameters.targets is not before
    assert parameters.targets.markers.sides == {7: 0.1, 8: 0.3}
    assert parameters.targets.landmarks is not None
    landmarks.write_text(_LANDMARKS.replace("7", "9"))
    parameters.change({"landmarks": str(landmarks)})
    assert [*parameters.targets.landmarks.places] == [9]
    parameters.change({"landmarks": ""})
    assert parameters.targets.landmarks is None


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"dictionary": "DICT_5X5_25"}, "did you mean 'DICT_5X5_250'"),
        ({"side": -1.0}, "must be positive"),
        ({"side": "wide"}, "must be a number, such as 0.15"),
        ({"sides": "7"}, "names no marker|is not METRES"),
        ({"landmarks": "none.yaml"}, "cannot read the landmarks"),
        ({"dictionary": "DICT_4X4_50", "sides": "99=0.1"}, "DICT_4X4_50 has no marker 99"),
        ({"use_sim_time": True}, "read-only; restart the node with -p use_sim_time:=true"),
        ({"speed": 1}, "unknown parameter 'speed'"),
    ],
)
def test_what_cannot_be_changes_nothing(change: dict[str, Any], expected: str) -> None:
    """The reason is told, and all values stay, also those that were given together with the wrong one."""
    parameters = _parameters()
    before, targets = parameters.values, parameters.targets
    with pytest.raises(SetupError, match=expected):
        parameters.change({"side": 0.3, **change})
    assert parameters.values == before
    assert parameters.targets is targets


def test_landmarks_must_be_in_the_dictionary(landmarks: Path) -> None:
    """A dictionary without a landmark's number is refused, and the file named."""
    landmarks.write_text(_LANDMARKS.replace("7", "60"))
    parameters = _parameters("--landmarks", landmarks)
    with pytest.raises(SetupError, match=r"landmarks.yaml: landmark 60 is not a known single marker.*DICT_4X4_50"):
        parameters.change({"dictionary": "DICT_4X4_50"})


def test_a_dump_of_the_parameters_can_be_loaded() -> None:
    """`ros2 param load` sets all that `ros2 param dump` has written, also what rclpy adds."""
    parameters = _parameters()
    parameters.change({**parameters.values, "start_type_description_service": True})
