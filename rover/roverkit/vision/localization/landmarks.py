"""Landmarks of a field, read from `landmarks.yaml`: the known pose of each marker or board, and its accuracy.

    frame: map
    survey: {position: 0.01, rotation: 0.5}     # standard deviation per axis: metres, degrees; the defaults
    landmarks:
      7: {position: [1.0, 2.0, 0.5], rpy: [90, 0, -90]}
      gate: {position: [4, 0, 1], orientation: [0, 0, 0, 1], survey: {position: 0.03}}

`rpy` are degrees about the field's fixed x, y and z axes, in this order; `orientation` is a quaternion x y z w. Both
rotate from the landmark's axes (x right, y up on the print, z out of it) to those of the field.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from roverkit.vision.markers.marker_set import TargetId
from roverkit.vision.poses.pose import Pose
from roverkit.vision.poses.pose_entries import POSE, pose
from roverkit.vision.yaml_file import Item, read_file

FRAME = "map"
"""Default name of the field's coordinate frame (REP 105)."""
SURVEY_POSITION = 0.01
"""Default standard deviation in metres of a landmark's position along each axis."""
SURVEY_ROTATION = math.radians(0.5)
"""Default standard deviation in radians of a landmark's orientation about each axis."""


@dataclass(frozen=True, slots=True, eq=False)
class Landmark:
    """Known pose of a marker or board on the field (landmark to field), with its accuracy.

    The standard deviations are for each axis, in metres and in radians. They come from the survey: the measurement of
    the landmark's pose on the field.
    """

    pose: Pose
    position_sigma: float = SURVEY_POSITION
    rotation_sigma: float = SURVEY_ROTATION


@dataclass(frozen=True, slots=True, eq=False)
class Landmarks:
    """All landmarks of a field.

    `frame` is the name of the field's coordinate frame. `places` holds each landmark by the number of its marker or the
    name of its board.
    """

    frame: str = FRAME
    places: Mapping[TargetId, Landmark] = field(default_factory=dict)


def read_landmarks(path: Path) -> Landmarks:
    """Read a file of landmarks. Raises `SetupError`, with line and column, for missing or impossible values."""
    whole = read_file(path, "landmarks")
    top = whole.known_entries({"frame", "survey", "landmarks"})
    frame = _frame(top["frame"]) if "frame" in top else FRAME
    sigmas = _survey(top.get("survey"), (SURVEY_POSITION, SURVEY_ROTATION))
    places = top["landmarks"].entries("landmark") if "landmarks" in top else {}
    if not places:
        raise whole.error("no landmarks found under the key 'landmarks'; see the example in rover/docs/vision.md")
    landmarks = {_name(key, item): _landmark(item, sigmas) for key, item in places.items()}
    return Landmarks(frame, landmarks)


def _frame(item: Item) -> str:
    frame = item.value
    if not isinstance(frame, str) or not frame:
        raise item.error(f"the field's frame is {item.shown}; it must be a name (in quotes if it looks like a number)")
    return frame


def _name(key: object, item: Item) -> TargetId:
    if isinstance(key, bool) or not isinstance(key, int | str):
        raise item.error(f"the landmark's name is {key!r}; it must be the number of a marker or the name of a board")
    return key


def _landmark(item: Item, sigmas: tuple[float, float]) -> Landmark:
    entries = item.known_entries({*POSE, "survey"})
    return Landmark(pose(item, entries), *_survey(entries.get("survey"), sigmas))


def _survey(item: Item | None, default: tuple[float, float]) -> tuple[float, float]:
    """Return the standard deviations (metres, radians) of a landmark's position and rotation.

    `item` is the value of the key `survey`. Numbers that it does not give come from `default`.
    """
    given = item.known_entries({"position", "rotation"}) if item else {}
    position = _sigma(given["position"]) if "position" in given else default[0]
    rotation = math.radians(_sigma(given["rotation"])) if "rotation" in given else default[1]
    return position, rotation


def _sigma(item: Item) -> float:
    what = "a standard deviation: metres for position, degrees for rotation"
    item.require(0 <= item.number < math.inf, what)  # false for NaN too
    return item.number
