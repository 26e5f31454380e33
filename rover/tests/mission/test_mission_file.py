"""Mission files: what they mean, and the place and the cure of each mistake."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverkit.driving.approach import LandmarkViewpoint, Waypoint
from roverkit.driving.geodesy import Datum
from roverkit.mission.mission_file import GoalRules, read_mission

from roverlink.__main__ import main
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
    assert isinstance(seven.place, LandmarkViewpoint)
    assert (seven.place.landmark, seven.place.x, seven.place.y, seven.place.distance) == ("7", 6, 2, 1.5)
    assert seven.place.facing is not None
    assert abs(seven.place.facing) == pytest.approx(math.pi)
    assert isinstance(gate.place, LandmarkViewpoint)
    assert (gate.place.facing, gate.place.distance) == (None, 1.0)
    assert isinstance(gps.place, Waypoint)
    east, north = Datum(50.0, 20.0).planar(50.0005, 20.0005)
    turned = complex(east, north) * complex(math.cos(math.radians(-30)), math.sin(math.radians(-30)))
    assert complex(gps.place.x, gps.place.y) == pytest.approx(turned)


_MISTAKES = [
    line.replace("\\n", "\n").split(" | ")
    for line in (Path(__file__).parent / "mistakes.txt").read_text(encoding="utf-8").splitlines()
    if line and not line.startswith("#")
]


@pytest.mark.parametrize(("text", "message"), _MISTAKES)
def test_mistakes_have_a_place_and_a_cure(folder: Path, text: str, message: str) -> None:
    """The message has file, line and column, the value as it is written, and what is right."""
    with pytest.raises(SetupError) as error:
        read_mission(_written(folder, text))
    assert message in str(error.value), str(error.value)
    assert str(error.value).startswith(str(folder))
    assert "\n" not in str(error.value)


def test_the_command_refuses_a_file_with_a_mistake(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Before it connects to anything: exit code 2, and one line."""
    file = _written(folder, "goals: [{position: [1, 2], retrys: 1}]")
    assert main(["mission", "run", str(file)]) == 2
    said = f"roverlink: {file}:1:28: goal 1 has an unknown key 'retrys'; did you mean 'retries'?\n"
    assert capsys.readouterr() == ("", said)
