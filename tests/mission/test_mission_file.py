"""Mission files: what they mean, and the place and the cure of each mistake."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from needs import NO_OPENCV
from programs import Start

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverlink.driving.approach import LandmarkView, Waypoint
from roverlink.driving.geodesy import Datum
from roverlink.mission.mission_file import GoalRules, read_mission
from roverlink.runtime.core.errors import SetupError

_LANDMARKS = """
landmarks:
  7: {position: [6.0, 2.0, 0.8], rpy: [90, 0, -90]}
  gate: {position: [1.0, 2.0, 0.0], rpy: [10, 0, 0]}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with landmarks."""
    (tmp_path / "landmarks.yaml").write_text(_LANDMARKS)
    return tmp_path


def _written(folder: Path, text: str) -> Path:
    file = folder / "mission.yaml"
    file.write_text(text)
    return file


def test_a_mission_has_places_and_rules(folder: Path) -> None:
    """Rules at the top hold for all goals, and a goal may have its own; names and defaults are as documented."""
    text = """
landmarks: landmarks.yaml
datum: {latitude: 50.0, longitude: 20.0, heading: 30}
retries: 5
search: [45]
goals:
  - {name: start, position: [1, -2], heading: -90, pause: 3}
  - {landmark: 7, distance: 1.5, retries: 0, on_failure: continue}
  - {landmark: gate, look: 1.5, timeout: 20, back_up: 0}
  - {gps: [50.0005, 20.0005]}
"""
    mission = read_mission(_written(folder, text))
    start, seven, gate, gps = mission.goals
    assert (mission.frame, mission.detections, mission.has_landmarks) == ("map", ("aruco/detections",), True)
    assert [goal.name for goal in mission.goals] == [
        "goal 1 (start)",
        "goal 2 (landmark 7)",
        "goal 3 (landmark gate)",
        "goal 4 (gps)",
    ]
    assert (start.place, start.pause) == (Waypoint(1, -2, math.radians(-90)), 3)
    common = GoalRules(retries=5, search=(math.radians(45),))
    assert start.rules == gps.rules == common
    assert seven.rules == GoalRules(retries=0, stops=False, search=common.search)
    assert gate.rules == GoalRules(retries=5, look=1.5, timeout=20, back_up=0, search=common.search)
    assert isinstance(seven.place, LandmarkView)
    assert (seven.place.landmark, seven.place.x, seven.place.y, seven.place.distance) == ("7", 6, 2, 1.5)
    assert seven.place.facing is not None
    assert abs(seven.place.facing) == pytest.approx(math.pi)
    assert isinstance(gate.place, LandmarkView)
    assert (gate.place.facing, gate.place.distance) == (None, 1.0)
    assert isinstance(gps.place, Waypoint)
    east, north = Datum(50.0, 20.0).planar(50.0005, 20.0005)
    turned = complex(east, north) * complex(math.cos(math.radians(-30)), math.sin(math.radians(-30)))
    assert complex(gps.place.x, gps.place.y) == pytest.approx(turned)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("goals: [", "1:9: not valid YAML"),
        ("{}", "1:1: a mission needs goals; write 'goals:'"),
        ("goals: []", "1:8: a mission needs goals"),
        ("goals: [3]", "1:9: goal 1 is not a mapping"),
        ("goals: [{positon: [1, 2]}]", "1:10: goal 1 has an unknown key 'positon'; did you mean 'position'?"),
        ("goals: [{name: a}]", "1:9: goal 1 needs one of position, landmark and gps; it has none"),
        (
            "goals: [{position: [1, 2], gps: [1, 2]}]",
            "goal 1 needs one of position, landmark and gps; it has position and gps",
        ),
        ("goals: [{position: [1]}]", "1:20: goal 1: position is a list of 1; it must be a list of 2 numbers"),
        ("goals: [{position: [1, .nan]}]", "1:24: a number of goal 1: position is .nan; it must be a finite number"),
        (
            "goals: [{position: [1, 2], heading: up}]",
            "1:37: goal 1: heading is up; it must be a number from -360 to 360 (degrees)",
        ),
        ("goals: [{position: [1, 2], distance: 2}]", "goal 1 has a distance, which belongs to a goal with landmark"),
        (
            "goals: [{landmark: 7}]",
            "1:20: a goal at a landmark needs the places of the landmarks; write landmarks: FILE",
        ),
        (
            "{landmarks: landmarks.yaml, goals: [{landmark: 8}]}",
            "goal 1: landmark is 8, which is not in the file of the landmarks",
        ),
        (
            "{landmarks: landmarks.yaml, goals: [{landmark: [7]}]}",
            "goal 1: landmark is a list of 1, which is not in the file",
        ),
        ("{landmarks: landmarks.yaml, goals: [{landmark: 7, heading: 3}]}", "belongs to a goal with position or gps"),
        (
            "{landmarks: landmarks.yaml, goals: [{landmark: 7, distance: 0}]}",
            "it must be a number from 0.1 to 100 (metres)",
        ),
        ("{landmarks: other.yaml, goals: [{landmark: 7}]}", "other.yaml: cannot read the landmarks"),
        ("{landmarks: 3, goals: [{landmark: 7}]}", "1:13: the file: landmarks is 3; it must be a name"),
        (
            "{frame: field, landmarks: landmarks.yaml, goals: [{landmark: 7}]}",
            "1:27: the frame of landmarks.yaml is 'map', and that of the mission is 'field'",
        ),
        ("goals: [{gps: [50, 20]}]", "1:15: a goal by GPS needs the map's origin; write datum:"),
        ("{datum: {latitude: 50}, goals: [{gps: [50, 20]}]}", "1:9: the datum has no longitude"),
        (
            "{datum: {latitude: 91, longitude: 2}, goals: [{gps: [50, 20]}]}",
            "latitude is 91; it must be a number from -90 to 90",
        ),
        (
            "{datum: {latitude: 50, longitude: 20}, goals: [{gps: [20, 150]}]}",
            "km from the datum; the limit is a kilometre",
        ),
        (
            "{datum: {latitude: 50, longitude: 20}, goals: [{gps: [150, 20]}]}",
            "must be a latitude from -90 to 90 and a longitude",
        ),
        (
            "{retries: -1, goals: [{position: [1, 2]}]}",
            "1:11: the file: retries is -1; it must be a whole number from 0 to 100",
        ),
        ("{retries: yes, goals: [{position: [1, 2]}]}", "retries is yes; it must be a whole number"),
        ("{timeout: 0, goals: [{position: [1, 2]}]}", "timeout is 0; it must be a number from 1 to 86400 (seconds)"),
        ("goals: [{position: [1, 2], on_failure: retry}]", "goal 1: on_failure is retry; it must be stop or continue"),
        ("goals: [{position: [1, 2], search: 30}]", "goal 1: search is 30; it must be a list, such as [a, b]"),
        (
            "goals: [{position: [1, 2], search: [30, left]}]",
            "an entry of goal 1: search is left; it must be a number from -180 to 180",
        ),
        (
            "goals: [{position: [1, 2], name: 7}]",
            "goal 1: name is 7; it must be a name (in quotes if it looks like a number)",
        ),
        ("goals: [{position: [1, 2], pause: -1}]", "goal 1: pause is -1; it must be a number from 0 to"),
        ("goals: [{position: [1, 2]}]\ngoals: []", "2:1: the key goals occurs twice"),
    ],
)
def test_mistakes_have_a_place_and_a_cure(folder: Path, text: str, message: str) -> None:
    """The message has file, line and column, the value as it is written, and what is right."""
    with pytest.raises(SetupError) as error:
        read_mission(_written(folder, text))
    assert message in str(error.value), str(error.value)
    assert str(error.value).startswith(str(folder))
    assert "\n" not in str(error.value)


def test_the_command_refuses_a_file_with_a_mistake(folder: Path, done: Start) -> None:
    """Before it connects to anything: exit code 2, and one line."""
    file = _written(folder, "goals: [{position: [1, 2], retrys: 1}]")
    code, output, errors = done("mission", "run", file)  # type: ignore[misc]
    assert (code, output) == (2, "")
    assert errors == f"roverlink: {file}:1:28: goal 1 has an unknown key 'retrys'; did you mean 'retries'?"
