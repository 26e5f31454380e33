"""Rules of a mission: what the rover does next, by what has come of the last thing it did.

1. The rover drives to each goal in turn. If Nav2 refuses a goal, cannot reach it, or takes too long, the rover backs up
   and tries again. A refused goal is repeated after a pause, because Nav2 refuses all goals until it is active.
2. At a goal with a landmark, the camera looks for the landmark. If it does not see it, the rover searches: it backs
   up, which lets the camera see more, and then drives to poses around the landmark's place. The rover cannot turn on
   the spot, so these are poses to which it drives on arcs. When the landmark is seen, the position of the rover has
   improved, and the rover drives to the goal again.
3. If a goal fails, the mission ends or goes on with the next goal, as the goal says.
4. The mission ends at once when a person takes over (MANUAL), or when another program cancels the goal.
"""

from __future__ import annotations

import enum
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from roverkit.driving.approach import LandmarkViewpoint
from roverkit.driving.arcs import PlanarPose
from roverkit.mission.mission_file import Goal, Mission
from roverlink.numerals import counted

REFUSED_PAUSE_S = 2.0
"""Pause in seconds after a goal that Nav2 has refused."""


class Outcome(enum.Enum):
    """Results of a goal of Nav2, in words for messages."""

    REACHED = "reached"
    REFUSED = "Nav2 refused it; is it active?"
    FAILED = "Nav2 could not reach it"
    TIMED_OUT = "it took too long"
    GONE = "Nav2 is dead: its server has disappeared, or has said nothing for 5 s"


class State(enum.Enum):
    """States of a mission, in the words of its reports."""

    WAITING = "waiting"
    DRIVING = "driving"
    SEARCHING = "searching"
    REACHED = "reached"
    FAILED = "failed"
    STOPPED = "stopped"
    DONE = "done"


class MissionStoppedError(Exception):
    """End of a mission before its last goal; the message says why."""


class Rover(Protocol):
    """Rover that Nav2 drives. Each method raises `MissionStoppedError` as soon as the mission must end."""

    def pose(self) -> PlanarPose:
        """Return the pose of the rover on the map."""

    def drive_to(self, pose: PlanarPose, timeout: float) -> Outcome:
        """Drive to a pose on the map, for at most a time in seconds."""

    def back_up(self, distance: float) -> Outcome:
        """Drive back in a straight line, by a distance in metres."""

    def sees(self, landmark: str, seconds: float) -> bool:
        """Return true as soon as a camera sees a landmark, or false after a time in seconds."""

    def wait(self, seconds: float) -> None:
        """Stay for a time in seconds."""


@dataclass(frozen=True, slots=True)
class Report:
    """News of a mission."""

    state: State
    goal: int = 0
    """Number of the goal, from 1; 0 if the news is about the whole mission."""
    message: str = ""
    distance: float = math.nan
    """Distance in metres that is left to the place to which the rover drives; NaN if it is not known."""


@dataclass(slots=True)
class MissionRun:
    """Run of a mission."""

    mission: Mission
    rover: Rover
    report: Callable[[Report], None]

    def run(self) -> bool:
        """Drive to all goals. Returns true if all have been reached."""
        failed = []
        for number, goal in enumerate(self.mission.goals, 1):
            try:
                reason = self._reach(number, goal)
            except MissionStoppedError as stop:
                self.report(Report(State.STOPPED, number, f"{goal.name}: {stop}"))
                return False
            if not reason:
                self.report(Report(State.REACHED, number, f"{goal.name} is reached"))
                continue
            self.report(Report(State.FAILED, number, f"{goal.name} is not reached: {reason}"))
            failed.append(number)
            if goal.rules.stops:
                self.report(Report(State.STOPPED, number, f"the mission ends at {goal.name}"))
                return False
        reached, count = len(self.mission.goals) - len(failed), len(self.mission.goals)
        self.report(Report(State.DONE, 0, f"{reached} of {counted(count, 'goal')} reached"))
        return not failed

    def _reach(self, number: int, goal: Goal) -> str:
        """Reach a goal. Returns the reason if that is not possible, and an empty text otherwise."""
        if reason := self._drive(number, goal):
            return reason
        viewpoint = goal.place
        if isinstance(viewpoint, LandmarkViewpoint) and not self.rover.sees(viewpoint.landmark, goal.rules.look):
            if not self._search(number, goal, viewpoint):
                return f"no camera sees landmark {viewpoint.landmark}"
            if reason := self._drive(number, goal):
                return reason
        self.rover.wait(goal.pause)
        return ""

    def _drive(self, number: int, goal: Goal) -> str:
        """Drive to the place of a goal, again after failures. Returns the reason if that is not possible."""
        outcome = Outcome.FAILED
        for again in range(goal.rules.retries + 1):
            if again:
                self.report(Report(State.DRIVING, number, f"{goal.name}: {outcome.value}; trying again ({again})"))
                self._recover(outcome, goal)
            self.report(Report(State.DRIVING, number, f"driving to {goal.name}"))
            outcome = self.rover.drive_to(goal.place.stop_from(self.rover.pose()), goal.rules.timeout)
            if outcome is Outcome.REACHED:
                return ""
        return outcome.value

    def _recover(self, outcome: Outcome, goal: Goal) -> None:
        if outcome is Outcome.REFUSED:
            self.rover.wait(REFUSED_PAUSE_S)
        elif goal.rules.back_up:
            self.rover.back_up(goal.rules.back_up)

    def _search(self, number: int, goal: Goal, viewpoint: LandmarkViewpoint) -> bool:
        """Search a landmark around its place. Returns true if a camera has seen it."""
        self.report(
            Report(State.SEARCHING, number, f"{goal.name}: no camera sees landmark {viewpoint.landmark}; searching")
        )
        rules = goal.rules
        if rules.back_up:
            self.rover.back_up(rules.back_up)
            if self.rover.sees(viewpoint.landmark, rules.look):
                return True
        for pose in viewpoint.viewpoints(self.rover.pose(), rules.search):
            # The outcome does not count: the landmark may be in sight from the place where the rover was stopped, too.
            self.rover.drive_to(pose, rules.timeout)
            if self.rover.sees(viewpoint.landmark, rules.look):
                return True
        return False
