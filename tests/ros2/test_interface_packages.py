"""Interface packages that are older than the table: built, sourced, and wrong."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from golden import ROOT
from needs import NO_RCLPY
from programs import Start

pytest.importorskip("rclpy", reason=NO_RCLPY)

_PROTOS = Path("proto", "components")
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


@pytest.fixture(params=_CHANGES)
def changed(request: pytest.FixtureRequest, tmp_path: Path, done: Start) -> tuple[Path, str]:
    """A project whose proto has changed since the interface package was built, and the difference in words."""
    proto, (before, after), difference = _CHANGES[request.param]
    shutil.copytree(ROOT / "proto", tmp_path / "proto")
    for name in ("mapping.yaml", "mapping.lock"):
        shutil.copy(ROOT / name, tmp_path)
    path = tmp_path / _PROTOS / proto
    assert before in path.read_text()
    path.write_text(path.read_text().replace(before, after))
    code, _, errors = done("generate", "--table", tmp_path / "mapping.yaml")
    assert code == 0, errors
    return tmp_path, difference


def test_a_stale_package_is_refused(changed: tuple[Path, str], done: Start) -> None:
    """The bridge does not start with rclpy; the error names the message, the difference and the command."""
    project, difference = changed
    code, _, errors = done("run", "--project", project, "--middleware", "rclpy", "--ros-args", "-p", "listen_port:=0")
    assert code == 2
    assert difference in errors
    assert _CURE in errors


def test_doctor_finds_a_stale_package(changed: tuple[Path, str], done: Start) -> None:
    """`roverlink doctor` says the same."""
    project, difference = changed
    code, output, _ = done("doctor", "--project", project, "--ros-args", "-p", "listen_port:=0")
    assert code == 1
    assert difference in output
    assert _CURE in output


def test_doctor_accepts_the_package_that_was_built(done: Start) -> None:
    """`roverlink doctor` finds no difference right after the build."""
    _, output, _ = done("doctor", "--ros-args", "-p", "listen_port:=0")
    assert "interfaces: the installed ROS 2 package comms has the generated messages" in output, output


def test_a_missing_standard_package_is_told(done: Start) -> None:
    """A package of ROS 2 that is not installed is named with the package of apt that brings it."""
    code, _, errors = done(
        "echo", "/path", "--type", "trajectory_msgs/msg/JointTrajectory", "--middleware", "rclpy", "--timeout", 1
    )
    assert code == 2
    assert "trajectory_msgs/msg/JointTrajectory is not installed" in errors
    assert "apt install ros-$ROS_DISTRO-trajectory-msgs" in errors
