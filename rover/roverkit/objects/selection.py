"""Object that the operator has selected: followed while it is visible, remembered for a while, and then lost.

A hidden object is expected where it was seen last. If the pose of the camera on the field is known, this is a place on
the field, and the rover may move. Otherwise it is a place in the rover's frame.

Each sighting passes a gate: an object that is suddenly elsewhere is another one, which the tracker has taken for it. It
is lost then, because an arm must not grip the wrong one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np

from roverkit.objects.frame_period import FramePeriod
from roverkit.objects.location import Location
from roverkit.vision.poses.pose import Pose

KNOWN_NS = 2_000_000_000
"""Time in nanoseconds after an object was seen in which it can be selected: the operator needs time to click."""
_VISIBLE_NS = 300_000_000
"""Time in nanoseconds after an object was seen in which it counts as visible: a detector misses it now and then."""
_KNOWN_PERIODS, _VISIBLE_PERIODS = 3, 2
"""The same in periods of the images, for a detector that is slower than that."""
_DRIFT = 0.1
"""Standard deviation in metres per second with which the place of a hidden object becomes uncertain."""
_SPEED = 2.0
"""Standard deviation in metres per second with which a place in the rover's frame does: the rover drives and turns."""
_JUMP = 0.1
"""Standard deviation in metres of a place from image to image: of localization, and of objects that are partly seen."""
_GATE = 21.1
"""Squared distance of a sighting from the expected place, in standard deviations: 99.99 % of chi squared (3)."""
_ELSEWHERE = 3
"""Number of sightings in succession beyond the gate that make the object lost; a single one may be a wrong depth."""


class State(Enum):
    """State of the selection."""

    NONE = "none"
    """Nothing is selected."""
    VISIBLE = "visible"
    """The camera sees the object."""
    HELD = "held"
    """The object is hidden, and expected where it was seen last."""
    LOST = "lost"
    """The object was hidden for too long; the operator has to select one again."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Objects that a camera has seen at one time."""

    objects: Mapping[int, Location]
    """Positions in the camera's optical frame by the numbers of the objects."""
    to_base: Pose | None
    """Transform from the camera's optical frame to the rover's frame; None if it is unknown."""
    to_map: Pose | None
    """Transform from the camera's optical frame to the frame of the field; None if it is unknown."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Position of the selected object in the frames in which it is known."""

    in_base: Location | None
    in_map: Location | None


class Selection:
    """Selection of one object. All times are in nanoseconds and of one clock."""

    def __init__(self, hold_ns: int) -> None:
        """Select nothing yet; an object is lost when it has been hidden for `hold_ns`."""
        self._hold = hold_ns
        self._period = FramePeriod()
        self._seen: dict[int, tuple[int, Scene]] = {}
        self._elsewhere: list[int] = []
        """Times of the newest sightings of the selected object that were beyond the gate."""
        self.object: int | None = None
        """Number of the selected object."""
        self.state = State.NONE
        """State at the time of the last call."""

    def see(self, scene: Scene, now: int) -> bool:
        """Add what the camera has seen, and return true if the selected object is in it, and not lost."""
        self._period.add(now)
        seen = dict.fromkeys(scene.objects, (now, scene))
        if self.object in seen and self.state is not State.LOST:
            self._elsewhere = [] if self._is_near(self.object, scene, now) else [*self._elsewhere, now]
            if len(self._elsewhere) == _ELSEWHERE:
                self.state = State.LOST
            elif self._elsewhere:
                del seen[self.object]
        self._seen |= seen
        self.update(now)
        return self.object in seen and self.state is not State.LOST

    def _is_near(self, number: int, scene: Scene, now: int) -> bool:
        """Return true if an object is where it is expected, in all frames in which that is known."""
        at, before = self._seen[number]
        # The gate does not become wider for an object that stays elsewhere.
        seconds = ((self._elsewhere or [now])[0] - at) / 1e9
        for old, new, speed in (
            (before.to_map, scene.to_map, _DRIFT),
            (before.to_base, scene.to_base, _SPEED),
        ):
            if old and new:
                expected, found = before.objects[number].through(old), scene.objects[number].through(new)
                variance = (speed * seconds) ** 2 + _JUMP**2
                step = found.point - expected.point
                covariance = expected.covariance + found.covariance + variance * np.eye(3)
                if step @ np.linalg.solve(covariance, step) > _GATE:
                    return False
        return True

    def update(self, now: int) -> None:
        """Compute the state at a time, and forget the objects that were not visible for long."""
        kept = {*self.known(now), self.object}
        self._seen = {number: seen for number, seen in self._seen.items() if number in kept}
        if self.object is None or self.state is State.LOST:
            return
        hidden = now - self._seen[self.object][0]
        if hidden <= self._period.at_least(_VISIBLE_NS, _VISIBLE_PERIODS):
            self.state = State.VISIBLE
        else:
            self.state = State.LOST if hidden > self._hold else State.HELD

    def known(self, now: int) -> list[int]:
        """Return the numbers of the objects that can be selected, in rising order."""
        longest = self._period.at_least(KNOWN_NS, _KNOWN_PERIODS)
        return sorted(number for number, (at, _) in self._seen.items() if now - at <= longest)

    def select(self, number: int, now: int) -> bool:
        """Select an object and return true. If it is not known, return false and change nothing."""
        if number not in self.known(now):
            return False
        self.object, self.state, self._elsewhere = number, State.VISIBLE, []
        self.update(now)
        return True

    def clear(self) -> None:
        """Select nothing."""
        self.object, self.state = None, State.NONE

    def place(self, now: int, map_to_base: Pose | None) -> Place:
        """Return the position of the selected object; its covariance grows while the object is hidden.

        `map_to_base` is the present transform from the frame of the field to the rover's frame, if it is known.
        """
        if self.object is None:
            raise ValueError("no object is selected")
        at, scene = self._seen[self.object]
        location = scene.objects[self.object].after((now - at) / 1e9, _DRIFT)
        in_map = location.through(scene.to_map) if scene.to_map else None
        if in_map and map_to_base and now > at:  # the rover may have moved since
            return Place(in_map.through(map_to_base), in_map)
        return Place(location.through(scene.to_base) if scene.to_base else None, in_map)
