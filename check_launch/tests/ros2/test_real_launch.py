"""`roverlink check-launch` with the real packages launch and launch_ros, which PyPI does not have.

They run if ROVERLINK_LAUNCH_EXAMPLES names a folder with the checkouts that `test_upstream_examples.py` needs.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[3]
_FOLDER = os.environ.get("ROVERLINK_LAUNCH_EXAMPLES", "")
_SOURCES = ("launch/launch", "launch/launch_xml", "launch/launch_yaml", "launch_ros/launch_ros")
_EXAMPLES = (
    "navigation2/nav2_bringup/launch",
    "rtabmap_ros/rtabmap_launch",
    "rtabmap_ros/rtabmap_demos",
    "rtabmap_ros/rtabmap_examples",
    "realsense-ros/realsense2_camera/examples",
    "realsense-ros/realsense2_camera/launch",
    "robot_localization/launch",
    "imu_tools/imu_filter_madgwick/launch",
)
_LOADER = "class LoadNode:\n    class Request: ...\n    class Response: ...\n"

pytestmark = pytest.mark.skipif(not _FOLDER, reason="ROVERLINK_LAUNCH_EXAMPLES names no folder with the sources")


@pytest.fixture
def real(tmp_path: Path) -> str:
    """The path on which Python finds the real packages, for each distribution."""
    interfaces = tmp_path / "path" / "composition_interfaces"  # of which there is no wheel; launch_ros imports it only
    interfaces.mkdir(parents=True)
    (interfaces / "__init__.py").touch()
    (interfaces / "srv.py").write_text(_LOADER)
    return os.pathsep.join([str(interfaces.parent), *(f"{_FOLDER}/DISTRIBUTION/{one}" for one in _SOURCES)])


def _checked(folder: Path, path: str, *arguments: str) -> list[dict[str, object]]:
    """Return the findings, with more modules on a path."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([path, os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-m", "roverlink", "check-launch", "--format", "json", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
    assert done.stdout, done.stderr
    found: list[dict[str, object]] = json.loads(done.stdout)
    return found


def test_the_real_constructors_are_called(real: str, tmp_path: Path) -> None:
    """What ROS 2 refuses is a fatal finding at its line, and a launch file may derive classes from the real ones."""
    real = real.replace("DISTRIBUTION", "jazzy")
    (tmp_path / "a.launch.py").write_text("""
from launch import LaunchDescription
from launch_ros.actions import Node
class Mapper(Node):
    def __init__(self):
        super().__init__(package='rtabmap_slam', executable='rtabmap', parameters=[{'Grid/CelSize': '0.1'}])
def generate_launch_description():
    return LaunchDescription([Mapper()])
""")
    (tmp_path / "b.launch.py").write_text("""
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    return LaunchDescription([
        Node(package='rtabmap_slam', executable='rtabmap', parameters='p.yaml'),
    ])
""")
    found = [
        (one["path"], one["line"], one["column"], one["id"])
        for one in _checked(tmp_path, real, ".")
        if one["severity"] != "hint"
    ]
    assert found == [("a.launch.py", 6, 85, "PAR101"), ("b.launch.py", 6, None, "LCH101")]


def test_the_shipped_launch_file_is_the_same_with_the_real_packages(real: str, tmp_path: Path) -> None:
    """The whole rover has no finding, and the drawing of its nodes and topics is the one of the stand-ins."""
    drawings = []
    for path in ("", real.replace("DISTRIBUTION", "jazzy")):
        file = tmp_path / "graph.dot"
        assert _checked(_ROOT, path, "--complete", "rover/navigation/launch/slam.launch.py", "--graph", str(file)) == []
        drawings.append(file.read_text(encoding="utf-8"))
    assert drawings[0] == drawings[1]


@pytest.mark.parametrize("distribution", ["humble", "jazzy"])
def test_the_examples_of_others_are_the_same_with_the_real_packages(distribution: str, real: str) -> None:
    """Each finding, with its line and column, is the one that the stand-ins give."""
    arguments = ("--distribution", distribution, *_EXAMPLES, "--packages", ".")
    folder = Path(_FOLDER) / distribution
    with_stand_ins = _checked(folder, "", *arguments)
    assert _checked(folder, real.replace("DISTRIBUTION", distribution), *arguments) == with_stand_ins
    assert len(with_stand_ins) > 100
