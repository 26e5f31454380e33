"""Missions: the goals of the rover, in the order in which it drives to them, and the rules for what goes wrong.

    landmarks: landmarks.yaml                                     # for goals at landmarks; beside this file
    datum: {latitude: 50.0614, longitude: 19.9372, heading: 0}    # for goals by GPS: where the map's origin is
    retries: 2
    goals:
      - {name: gate, position: [4.0, 1.5], heading: 90}           # metres on the map, degrees
      - {landmark: 7, distance: 1.5}                              # metres in front of it
      - {gps: [50.06145, 19.93741], on_failure: continue}         # latitude and longitude in degrees

The heading of the datum is the direction of the map's x axis, in degrees from east to the left. A rule at the top of
the file holds for all goals, and one in a goal for this goal: `retries`, `timeout`, `on_failure`, `back_up`, `look`,
`search`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from roverkit.driving.approach import LandmarkViewpoint, Waypoint
from roverkit.driving.arcs import PlanarPose
from roverkit.driving.geodesy import Datum
from roverkit.mission.mission_declaration import DETECTIONS
from roverkit.vision.localization.landmarks import FRAME, Landmarks, read_landmarks
from roverkit.vision.yaml_file import Item, read_file
from roverlink.runtime.core.errors import nearest

T = TypeVar("T")

_STOP, _CONTINUE = "stop", "continue"
_UPRIGHT = math.cos(math.radians(45))  # smallest horizontal part of the normal of a landmark that is not on the ground
_LONGEST_S = 24 * 3600.0
_MOST_RETRIES = 100
_FARTHEST_M = 100.0  # of a rover from a landmark that its camera should see
_DATUM_RANGE_M = 1000.0  # up to which `Datum` is accurate to 0.2 m


@dataclass(frozen=True, slots=True)
class GoalRules:
    """Rules for one goal, for what goes wrong on the way to it."""

    retries: int = 2
    """Number of further tries after a failure."""
    timeout: float = 300.0
    """Longest time in seconds for one try."""
    stops: bool = True
    """True if the mission ends where this goal fails; false if it goes on with the next goal."""
    back_up: float = 0.5
    """Distance in metres by which the rover backs up before it tries again, and to search a landmark; 0 for none."""
    look: float = 3.0
    """Time in seconds for which the camera looks for the landmark at each place."""
    search: tuple[float, ...] = (math.radians(30), math.radians(-30))
    """Angles in radians around a landmark that is not seen, at which the rover looks for it."""


@dataclass(frozen=True, slots=True)
class Goal:
    """One goal of a mission."""

    name: str
    """Name in messages, such as ``goal 2 (landmark 7)``."""
    place: Waypoint | LandmarkViewpoint
    pause: float
    """Time in seconds for which the rover stays at the goal."""
    rules: GoalRules


@dataclass(frozen=True, slots=True)
class Mission:
    """Goals in the frame of a map."""

    goals: tuple[Goal, ...]
    frame: str = FRAME
    detections: tuple[str, ...] = (DETECTIONS.name,)
    """Topics with the landmarks that the cameras see."""

    @property
    def has_landmarks(self) -> bool:
        """True if the mission has goals at landmarks."""
        return any(isinstance(goal.place, LandmarkViewpoint) for goal in self.goals)


@dataclass(frozen=True, slots=True)
class _Field:
    """Facts about the field to which the goals refer."""

    landmarks: Landmarks | None
    datum: Datum | None
    axes: PlanarPose
    """Pose of the datum's axes, east and north, on the map."""


_GOAL_RULES = ("retries", "timeout", "on_failure", "back_up", "look", "search")
_KINDS = ("position", "landmark", "gps")


def read_mission(path: Path) -> Mission:
    """Read a mission. Raises `SetupError`, with file, line and column, for missing or impossible values."""
    whole = read_file(path, "mission")
    top = whole.known_entries({"frame", "landmarks", "datum", "detections", "goals", *_GOAL_RULES})
    frame = _name(top["frame"]) if "frame" in top else FRAME
    rules = _rules(top, GoalRules())
    facts = _Field(_landmarks(top.get("landmarks"), frame), *_datum(top.get("datum")))
    items = top["goals"].items("a goal") if "goals" in top else []
    if not items:
        place = top.get("goals", whole)
        raise place.error("a mission needs goals; write 'goals:' and below it '- position: [x, y]' with metres")
    goals = tuple(_goal(Item(path, item.node, f"goal {place}"), facts, rules) for place, item in enumerate(items, 1))
    topics = _list(top["detections"], _name) if "detections" in top else (DETECTIONS.name,)
    return Mission(goals, frame, topics)


def _goal(item: Item, facts: _Field, rules: GoalRules) -> Goal:
    entries = item.known_entries({*_KINDS, "name", "heading", "distance", "pause", *_GOAL_RULES})
    kinds = [kind for kind in _KINDS if kind in entries]
    if len(kinds) != 1:
        raise item.error(f"{item.name} needs one of position, landmark and gps; it has {' and '.join(kinds) or 'none'}")
    kind = kinds[0]
    for key, owners in (("heading", ("position", "gps")), ("distance", ("landmark",))):
        if key in entries and kind not in owners:
            raise entries[key].error(f"{item.name} has a {key}, which belongs to a goal with {' or '.join(owners)}")
    place = _place(kind, entries, facts)
    what = f"landmark {place.landmark}" if isinstance(place, LandmarkViewpoint) else kind
    name = _name(entries["name"]) if "name" in entries else what
    pause = _number(entries["pause"], 0, _LONGEST_S, "seconds") if "pause" in entries else 0.0
    return Goal(f"{item.name} ({name})", place, pause, _rules(entries, rules))


def _place(kind: str, entries: Mapping[str, Item], facts: _Field) -> Waypoint | LandmarkViewpoint:
    if kind == "landmark":
        distance = _number(entries["distance"], 0.1, _FARTHEST_M, "metres") if "distance" in entries else 1.0
        return _viewpoint(entries["landmark"], facts.landmarks, distance)
    yaw = math.radians(_number(entries["heading"], -360, 360, "degrees")) if "heading" in entries else None
    first, second = (float(number) for number in entries[kind].numbers(2))
    if kind == "position":
        return Waypoint(first, second, yaw)
    place = _on_map(entries[kind], first, second, facts)
    return Waypoint(place.x, place.y, yaw)


def _viewpoint(item: Item, landmarks: Landmarks | None, distance: float) -> LandmarkViewpoint:
    if landmarks is None:
        raise item.error("a goal at a landmark needs the places of the landmarks; write landmarks: FILE")
    name = item.value
    known = landmarks.places.get(name) if type(name) in (int, str) else None
    if known is None:
        hint = nearest(item.shown, map(str, landmarks.places))
        raise item.error(f"{item.name} is {item.shown}, which is not in the file of the landmarks; {hint}")
    x, y, _ = (float(part) for part in known.pose.translation)
    east, north, _ = (float(part) for part in known.pose.rotation[:, 2])  # z points out of the print
    facing = math.atan2(north, east) if math.hypot(east, north) >= _UPRIGHT else None
    return LandmarkViewpoint(str(name), x, y, facing, distance)


def _on_map(item: Item, latitude: float, longitude: float, facts: _Field) -> PlanarPose:
    """Return the position on the map of a latitude and a longitude in degrees."""
    if facts.datum is None:
        raise item.error("a goal by GPS needs the map's origin; write datum: {latitude: ..., longitude: ...}")
    if not (-90 <= latitude <= 90 and -180 <= longitude <= 180):
        raise item.error(f"{item.name} must be a latitude from -90 to 90 and a longitude from -180 to 180 degrees")
    place = PlanarPose(*facts.datum.planar(latitude, longitude))
    if (distance := place.distance_to(PlanarPose())) > _DATUM_RANGE_M:
        raise item.error(f"{item.name} is {distance / 1000:.1f} km from the datum; the limit is a kilometre")
    return facts.axes @ place


# --- what all goals share ---------------------------------------------------------------------------------------------


def _landmarks(item: Item | None, frame: str) -> Landmarks | None:
    if item is None:
        return None
    file = _name(item)
    landmarks = read_landmarks(item.path.parent / file)
    if landmarks.frame != frame:
        raise item.error(f"the frame of {file} is {landmarks.frame!r}, and that of the mission is {frame!r}")
    return landmarks


def _datum(item: Item | None) -> tuple[Datum | None, PlanarPose]:
    """Return the datum, and the pose of its axes east and north on the map."""
    if item is None:
        return None, PlanarPose()
    entries = item.known_entries({"latitude", "longitude", "heading"})
    for key in ("latitude", "longitude"):
        if key not in entries:
            raise item.error(f"the datum has no {key}; write datum: {{latitude: ..., longitude: ...}} in degrees")
    latitude = _number(entries["latitude"], -90, 90, "degrees")
    longitude = _number(entries["longitude"], -180, 180, "degrees")
    heading = _number(entries["heading"], -360, 360, "degrees") if "heading" in entries else 0.0
    return Datum(latitude, longitude), PlanarPose(yaw=-math.radians(heading))


def _rules(entries: Mapping[str, Item], default: GoalRules) -> GoalRules:
    """Return the rules that a mapping states, and the default for the others."""
    read: dict[str, tuple[str, Callable[[Item], object]]] = {
        "retries": ("retries", lambda item: _whole(item, _MOST_RETRIES)),
        "timeout": ("timeout", lambda item: _number(item, 1, _LONGEST_S, "seconds")),
        "on_failure": ("stops", _stops),
        "back_up": ("back_up", lambda item: _number(item, 0, 10, "metres")),
        "look": ("look", lambda item: _number(item, 0.1, _LONGEST_S, "seconds")),
        "search": (
            "search",
            lambda item: _list(item, lambda angle: math.radians(_number(angle, -180, 180, "degrees"))),
        ),
    }
    stated = {field: convert(entries[key]) for key, (field, convert) in read.items() if key in entries}
    return replace(default, **stated)  # type: ignore[arg-type]  # each function returns the type of its field


def _stops(item: Item) -> bool:
    item.require(item.value in (_STOP, _CONTINUE), f"{_STOP} or {_CONTINUE} (with the next goal)")
    return bool(item.value == _STOP)


def _whole(item: Item, largest: int) -> int:
    value = item.value
    item.require(type(value) is int and 0 <= value <= largest, f"a whole number from 0 to {largest}")
    return int(value)


def _number(item: Item, smallest: float, largest: float, unit: str) -> float:
    item.require(smallest <= item.number <= largest, f"a number from {smallest:g} to {largest:g} ({unit})")
    return item.number


def _name(item: Item) -> str:
    return item.filled_text("a name")


def _list(item: Item, read: Callable[[Item], T]) -> tuple[T, ...]:
    items = item.items(f"an entry of {item.name}")
    item.require(items is not None, "a list, such as [a, b]")
    return tuple(read(item) for item in items or ())
