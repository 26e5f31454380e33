"""The landmarks of a field: which marker or board is where, and how well that is known; read from `landmarks.yaml`.

    frame: field
    survey: {position: 0.01, rotation: 0.5}     # one sigma an axis: metres, degrees; these are the defaults
    landmarks:
      7: {position: [1.0, 2.0, 0.5], rpy: [90, 0, -90]}
      gate: {position: [4, 0, 1], orientation: [0, 0, 0, 1], survey: {position: 0.03}}

`rpy` are degrees about the field's fixed x, y and z axes, in that order; `orientation` is a quaternion x y z w. Both
turn the landmark's axes (x right, y up the print, z out of it) to the field's.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from runtime.errors import SetupError
from vision.markers import TargetId
from vision.pose import Pose
from vision.reading import POSE, mapping, pose, read_yaml

FRAME = "field"
SURVEY_POSITION = 0.01
"""Standard deviation in metres of a landmark's position along each axis, where none is given."""
SURVEY_ROTATION = math.radians(0.5)
"""Standard deviation in radians of a landmark's orientation about each axis, where none is given."""


@dataclass(frozen=True, slots=True, eq=False)
class Landmark:
    """A marker's or board's pose on the field (landmark to field), and how well it is known (one sigma an axis)."""

    pose: Pose
    position_sigma: float = SURVEY_POSITION
    rotation_sigma: float = SURVEY_ROTATION


@dataclass(frozen=True, slots=True, eq=False)
class Landmarks:
    """Where the landmarks of a field are; `frame` is the field's name."""

    frame: str = FRAME
    places: Mapping[TargetId, Landmark] = field(default_factory=dict)


def read_landmarks(path: Path) -> Landmarks:
    """Read a file of landmarks. Raises `SetupError` for what is missing or cannot be."""
    top = read_yaml(path, "landmarks", {"frame", "survey", "landmarks"})
    sigmas = _survey(top.get("survey", {}), f"{path}: survey", (SURVEY_POSITION, SURVEY_ROTATION))
    places = top.get("landmarks")
    if not isinstance(places, dict) or not places:
        raise SetupError(f"{path} has no landmarks; see the example in the documentation")
    landmarks = {_name(key, path): _landmark(value, f"{path}: landmark {key}", sigmas) for key, value in places.items()}
    return Landmarks(str(top.get("frame", FRAME)), landmarks)


def _name(key: object, path: Path) -> TargetId:
    if isinstance(key, bool) or not isinstance(key, int | str):
        raise SetupError(f"{path}: a landmark is named {key!r}; it is a marker's number or a board's name")
    return key


def _landmark(value: object, where: str, sigmas: tuple[float, float]) -> Landmark:
    given = mapping(value, where, {*POSE, "survey"})
    return Landmark(pose(given, where), *_survey(given.get("survey", {}), f"{where}: survey", sigmas))


def _survey(value: object, where: str, default: tuple[float, float]) -> tuple[float, float]:
    """The standard deviations in metres and radians."""
    given = mapping(value, where, {"position", "rotation"})
    position = given.get("position", default[0])
    rotation = given.get("rotation", math.degrees(default[1]))
    for sigma in (position, rotation):
        if isinstance(sigma, bool) or not isinstance(sigma, int | float) or not 0 <= sigma < math.inf:
            raise SetupError(
                f"{where} is {sigma!r}; it is a standard deviation: metres for position, degrees for rotation"
            )
    return float(position), math.radians(rotation)
