"""Interface packages that are older than the table: built, sourced, and wrong."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from golden import ROOT
from linked import PROTO, write_project
from needs import NO_RCLPY
from programs import Start

from roverlink.generator.pipeline import compile_table

pytest.importorskip("rclpy", reason=NO_RCLPY)

_CURE = "run `colcon build --base-paths generated/ros` and source its setup.bash"
_CHANGES = {
    "a new field": (
        "sensor_board/imu_sensor.proto",
        ("IMUErrorCode error_code = 15;", "IMUErrorCode error_code = 15; float heat = 16;"),
        "comms/msg/ImuSensorInformation has no field heat",
    ),
    "another type of a nested message's field": (
        "common/motor.proto",
        ("float rpm = 3;", "reserved 3; double rpm = 6;"),
        "the field rpm of comms/msg/MotorInformation has the type float instead of double",
    ),
}


@pytest.mark.parametrize(("proto", "change", "difference"), _CHANGES.values(), ids=_CHANGES)
def test_a_stale_package_is_refused(
    proto: str, change: tuple[str, str], difference: str, done: Start, tmp_path: Path
) -> None:
    """The bridge does not start with rclpy; it and `doctor` name the message, the difference and the command."""
    shutil.copytree(ROOT / "proto", tmp_path / "proto")
    shutil.copy(ROOT / "mapping.yaml", tmp_path)
    path = tmp_path / "proto" / "components" / proto
    assert change[0] in path.read_text()
    path.write_text(path.read_text().replace(*change))
    for name, text in compile_table(tmp_path / "mapping.yaml").files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    words = ("--project", tmp_path, "--ros-args", "-p", "listen_port:=0")
    code, _, errors = done("run", "--middleware", "rclpy", *words)  # type: ignore[misc]
    assert (code, difference in errors, _CURE in errors) == (2, True, True), errors
    code, output, _ = done("doctor", *words)  # type: ignore[misc]
    assert (code, difference in output, _CURE in output) == (1, True, True), output


def test_doctor_accepts_the_package_that_was_built(done: Start) -> None:
    """`roverlink doctor` finds no difference right after the build."""
    _, output, _ = done("doctor", "--ros-args", "-p", "listen_port:=0")
    assert "interfaces: the installed ROS 2 package comms has the generated messages" in output, output


def test_cmake_accepts_a_package_with_a_time(tmp_path: Path) -> None:
    """The wheels of the packages on which it depends name folders that do not exist."""
    field, syntax = "google.protobuf.Timestamp angle = 1;", 'syntax = "proto3";'
    proto = PROTO.replace("float angle = 1;", field).replace(
        syntax, f'{syntax}\nimport "google/protobuf/timestamp.proto";'
    )
    (cmake_lists,) = write_project(tmp_path / "rover", proto=proto).rglob("CMakeLists.txt")
    prefix = (f"-DCMAKE_PREFIX_PATH={sys.prefix}", f"-DPython3_EXECUTABLE={sys.executable}")
    command = ["cmake", "-S", str(cmake_lists.parent), "-B", str(tmp_path / "build"), "-DBUILD_TESTING=OFF", *prefix]
    done = subprocess.run([*command, f"-DPYTHON_EXECUTABLE={sys.executable}"], capture_output=True, text=True)
    assert "find_package(builtin_interfaces" in cmake_lists.read_text()
    assert done.returncode == 0, done.stderr


def test_a_missing_standard_package_is_told(done: Start) -> None:
    """A package of ROS 2 that is not installed is named with the package of apt that brings it."""
    code, _, errors = done(
        "echo", "/path", "--type", "trajectory_msgs/msg/JointTrajectory", "--middleware", "rclpy", "--timeout", 1
    )
    assert code == 2
    assert "trajectory_msgs/msg/JointTrajectory is not installed" in errors
    assert "apt install ros-$ROS_DISTRO-trajectory-msgs" in errors
