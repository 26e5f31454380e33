"""Drives with one fault each: a pose that is wrong for longer than a moment has a warning that names the cause."""

from __future__ import annotations

import logging
import math
import random
import re
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import NO_GTSAM, NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from roverkit.driving.arcs import PlanarPose
from roverkit.simulation.rover_model import Measurement, MotorReport, ProgressReport, RoverSettings
from roverkit.simulation.rover_sensors import ImuReading, ImuSettings

from rover.tests.driving.field_drive import FieldDrive
from roverlink.runtime.convert.rotations import angles, quaternion
from roverlink.runtime.interfaces.geometry_msgs import Quaternion
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.sensor_msgs import NavSatFix
from roverlink.runtime.interfaces.vision_msgs import Detection3DArray

_BEGIN_S = 20.0
"""Time of the simulation at which a fault begins: by then, two landmarks have been seen."""
_WRONG = 4.0
"""Error of the position in standard deviations from which a pose is wrong."""
_LONGEST_S = 2.0


def _sightings(change: Callable[[Any, random.Random], None]) -> Callable[[Any, float, random.Random], None]:
    """Return a fault of each image."""

    def apply(message: Any, now: float, rng: random.Random) -> None:
        if isinstance(message, Detection3DArray) and now > _BEGIN_S:
            change(message, rng)

    return apply


def _rename(part: float) -> Callable[[Any, random.Random], None]:
    """Return a change that gives a part of the sightings another number."""

    def change(message: Any, rng: random.Random) -> None:
        for one in message.detections:
            if rng.random() < part:
                one.id = one.results[0].hypothesis.class_id = rng.choice(["7", "8", "9", "10"])

    return change


def _late(seconds: int) -> Callable[[Any, random.Random], None]:
    def change(message: Any, _: random.Random) -> None:
        message.header.stamp.sec -= seconds

    return change


def _no_numbers(message: Any, _: random.Random) -> None:
    for one in message.detections:
        one.results[0].pose.pose.position.x = math.nan


def _swapped(message: Any, _: float, __: random.Random) -> None:
    if isinstance(message, Detection3DArray):
        for one in message.detections:
            one.id = one.results[0].hypothesis.class_id = {"7": "8", "8": "7"}.get(one.id, one.id)


def _turned_mount(message: Any, _: float, __: random.Random) -> None:
    """Turn the camera by 10 degrees about its y axis, which points down: all that it sees is turned back."""
    if isinstance(message, Detection3DArray):
        cosine, sine = math.cos(_MOUNT_RAD), math.sin(_MOUNT_RAD)
        for one in message.detections:
            pose = one.results[0].pose.pose
            place, turn = pose.position, pose.orientation
            place.x, place.z = cosine * place.x + sine * place.z, cosine * place.z - sine * place.x
            pose.orientation = _product(Quaternion(0.0, math.sin(_MOUNT_RAD / 2), 0.0, math.cos(_MOUNT_RAD / 2)), turn)


_MOUNT_RAD = math.radians(10)


def _product(one: Quaternion, other: Quaternion) -> Quaternion:
    return Quaternion(
        one.w * other.x + one.x * other.w + one.y * other.z - one.z * other.y,
        one.w * other.y - one.x * other.z + one.y * other.w + one.z * other.x,
        one.w * other.z + one.x * other.y - one.y * other.x + one.z * other.w,
        one.w * other.w - one.x * other.x - one.y * other.y - one.z * other.z,
    )


def _fixes(**values: float) -> Callable[[Any, float, random.Random], None]:
    """Return a fault of GPS positions that lasts ten seconds: values to add."""

    def apply(message: Any, now: float, _: random.Random) -> None:
        if isinstance(message, NavSatFix) and _BEGIN_S < now < _BEGIN_S + 10:
            for name, value in values.items():
                setattr(message, name, getattr(message, name) + value)

    return apply


def _no_covariance(message: Any, _: float, __: random.Random) -> None:
    if isinstance(message, Odometry):
        message.pose.covariance = message.twist.covariance = [0.0] * 36


def _begins_again(message: Any, now: float, _: random.Random) -> None:
    """Let the odometry start anew: its pose is that since then."""
    if isinstance(message, Odometry) and now > _BEGIN_S:
        place = message.pose.pose
        place.position.x += 40.0
        place.orientation = Quaternion(*quaternion(0.0, 0.0, angles(place.orientation)[2] + 1.0))


def _gyroscope(change: Callable[[float], float]) -> Callable[[Measurement, random.Random], Measurement]:
    def apply(one: Measurement, _: random.Random) -> Measurement:
        if isinstance(one, ImuReading) and one.at > _BEGIN_S * 1e9:
            x, y, z = one.angular_velocity
            return replace(one, angular_velocity=(x, y, change(z)))
        return one

    return apply


def _lost(kind: type[Any], part: float) -> Callable[[Measurement, random.Random], Measurement | None]:
    def apply(one: Measurement, rng: random.Random) -> Measurement | None:
        return None if isinstance(one, kind) and one.at > _BEGIN_S * 1e9 and rng.random() < part else one

    return apply


def _pushed(rover: FieldDrive) -> None:
    """Push the rover aside by 1 m in a second."""
    if _BEGIN_S <= rover.model.now / 1e9 < _BEGIN_S + 1:
        rover.model.pose = rover.model.pose @ PlanarPose(0.0, 0.1, 0.0)


def _spins(rover: FieldDrive) -> None:
    """Let the wheels spin on the spot for two seconds."""
    if _BEGIN_S <= rover.model.now / 1e9 < _BEGIN_S + 2:
        rover.model.pose = rover.model.pose @ PlanarPose(-0.1 * rover.model.velocity, 0.0, 0.0)


def _moved(x: float, y: float) -> Callable[[FieldDrive], None]:
    def apply(rover: FieldDrive) -> None:
        if abs(rover.model.now / 1e9 - _BEGIN_S) < 0.05:
            rover.move_landmark(8, x, y)

    return apply


def _blind(rover: FieldDrive) -> None:
    rover.sees = not _BEGIN_S < rover.model.now / 1e9 < _BEGIN_S + 25


@dataclass(frozen=True)
class _Fault:
    """Fault of a drive."""

    cause: str
    """Part of the warning that names the cause."""
    change: Callable[[Any, float, random.Random], None] = lambda _, __, ___: None
    """Change of a message to the fusion at a time in seconds."""
    sense: Callable[[Measurement, random.Random], Measurement | None] = lambda one, _: one
    """Change of a measurement for the odometry."""
    disturb: Callable[[FieldDrive], None] = lambda _: None
    """Change of the world, ten times a second."""
    settings: RoverSettings = field(default_factory=RoverSettings)


_LANDMARK, _GPS = "sighting of landmark", "GPS position left out"
_FAULTS = {
    "0.5 % wrong numbers": _Fault(_LANDMARK, _sightings(_rename(0.005))),
    "5 % wrong numbers": _Fault(_LANDMARK, _sightings(_rename(0.05))),
    "a moved landmark": _Fault(_LANDMARK, disturb=_moved(0.6, 0.0)),
    "swapped landmarks": _Fault(_LANDMARK, _swapped),
    "a rotated mount": _Fault("mount", _turned_mount),
    "late images": _Fault("landmarks come late", _sightings(_late(3))),
    "images ahead": _Fault("landmarks left out: the stamp is in the future", _sightings(_late(-5))),
    "sightings without numbers": _Fault(_LANDMARK, _sightings(_no_numbers)),
    "a jump of GPS": _Fault(_GPS, _fixes(latitude=3e-4)),
    "GPS without numbers": _Fault(_GPS, _fixes(longitude=math.nan)),
    "odometry without covariance": _Fault("odometry without covariance", _no_covariance),
    "odometry that begins again": _Fault("beginning again", _begins_again),
    "lost reports": _Fault("reports", sense=_lost(ProgressReport, 0.5)),
    "silent motors": _Fault("", sense=_lost(MotorReport, 1.0)),
    "a silent IMU": _Fault("angular velocity", sense=_lost(ImuReading, 1.0)),
    "a bias that jumps": _Fault("gyroscope", sense=_gyroscope(lambda rate: rate + 0.05)),
    "an IMU upside down": _Fault("upside down", sense=_gyroscope(lambda rate: -rate)),
    "a scale of 3 %": _Fault(_LANDMARK, settings=RoverSettings(imu=ImuSettings(gyro_scale=0.03))),
    "much slip": _Fault("the wheels slip", settings=RoverSettings(slip=0.15, mean_slip=0.08)),
    "spinning wheels": _Fault("the wheels slip", disturb=_spins),
    "a push": _Fault("the rover was moved", disturb=_pushed),
    "a covered camera": _Fault("landmark", disturb=_blind),
}


_CHOSEN = (318, 516)
"""Drives in which one landmark after another is blamed, and in which GTSAM cannot solve the graph."""


def _longest_wrong(fault: _Fault, seed: int, logger: logging.Logger) -> tuple[float, list[str]]:
    """Drive with a fault; return the longest time in seconds for which the pose was wrong, and what was said."""
    rng, wrong, longest = random.Random(seed), 0.0, 0.0  # noqa: S311  # repeatable, not secret
    with ExitStack() as stack:
        rover = FieldDrive(
            seed,
            stack,
            gps=True,
            change=lambda message, now: fault.change(message, now, rng),
            sense=lambda one: fault.sense(one, rng),
            settings=fault.settings,
            logger=logger,
        )

        def watch() -> None:
            nonlocal wrong, longest
            fault.disturb(rover)
            is_wrong = False
            if rover.fused and rover.is_current:
                error, covariance = rover.error
                squared = float(error[:2] @ np.linalg.solve(covariance[:2, :2], error[:2]))
                is_wrong = squared > _WRONG**2
            wrong = wrong + 0.1 if is_wrong else 0.0
            longest = max(longest, wrong)

        rover.stand(2)
        rover.drive(24, watch)
        return longest, rover.said


def test_the_page_about_missing_poses_quotes_the_log() -> None:
    """Each message of its table is one of odometry or fusion."""
    folder = Path(__file__).parents[2]
    page = (folder / "docs" / "localization.md").read_text(encoding="utf-8").partition("## Why is there no pose")[2]
    quoted = re.findall(r"^\| `(.*?)` \|", page.partition("\n## ")[0].partition("\n### ")[0], re.MULTILINE)
    code = "".join(
        re.sub(r'"\n\s+f?"', "", path.read_text(encoding="utf-8"))
        for part in ("odometry", "fusion")
        for path in (folder / "roverkit" / part).glob("*.py")
    )
    assert len(quoted) > 10
    assert [one for one in quoted if one not in code] == []


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        pytest.param(name, seed, marks=pytest.mark.slow if seed < 100 or seed in _CHOSEN else pytest.mark.exhaustive)
        for number, name in enumerate(_FAULTS)
        for seed in range(number, 1000, 100)
    ],
)
def test_a_wrong_pose_has_a_warning(name: str, seed: int, caplog: pytest.LogCaptureFixture) -> None:
    """No pose is wrong by 4 standard deviations for longer than 2 s without a warning that names the cause."""
    fault = _FAULTS[name]
    longest, said = _longest_wrong(fault, seed, logging.getLogger("fusion"))
    said += [record.getMessage() for record in caplog.records]
    assert longest <= _LONGEST_S or any(fault.cause in one for one in said), (longest, said)
