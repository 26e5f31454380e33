"""Rules of missions, with a rover whose drives end at random."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverkit.driving.approach import LandmarkViewpoint, Waypoint
from roverkit.driving.arcs import PlanarPose
from roverkit.mission.mission_file import Goal, GoalRules, Mission
from roverkit.mission.mission_rules import MissionRun, MissionStoppedError, Outcome, Report, State

_rules = st.builds(
    GoalRules,
    retries=st.integers(0, 3),
    stops=st.booleans(),
    back_up=st.sampled_from([0.0, 0.5]),
    search=st.lists(st.floats(-1, 1), max_size=2).map(tuple),
)
_places = st.one_of(st.builds(Waypoint, st.just(1.0), st.just(2.0)), st.just(LandmarkViewpoint("7", 5, 5, 0.0, 1.0)))
_goals = st.lists(st.builds(Goal, st.just("goal"), _places, st.just(0.0), _rules), min_size=1, max_size=4)


@dataclass
class _Rover:
    """Rover that does what is drawn, until somebody stops it."""

    outcomes: list[Outcome]
    sights: list[bool]
    steps: int
    """Calls until a person takes over."""
    called: list[tuple[str, object]] = field(default_factory=list)

    def _call(self, name: str, argument: object = None) -> None:
        assert self.steps >= 0, "nothing is done after the stop"
        self.steps -= 1
        if self.steps < 0:
            raise MissionStoppedError("a person has taken over")
        self.called.append((name, argument))

    def pose(self) -> PlanarPose:
        self._call("pose")
        return PlanarPose()

    def drive_to(self, pose: PlanarPose, timeout: float) -> Outcome:
        outcome = self.outcomes.pop() if self.outcomes else Outcome.REACHED
        self._call("drive_to", outcome)
        return outcome

    def back_up(self, distance: float) -> Outcome:
        assert distance > 0
        self._call("back_up")
        return Outcome.FAILED

    def sees(self, landmark: str, seconds: float) -> bool:
        seen = self.sights.pop() if self.sights else False
        self._call("sees", seen)
        return seen

    def wait(self, seconds: float) -> None:
        self._call("wait")


@pytest.mark.slow
@given(
    _goals, st.lists(st.sampled_from(Outcome), max_size=20), st.lists(st.booleans(), max_size=20), st.integers(0, 100)
)
def test_a_mission_ends_and_says_how(
    goals: list[Goal], outcomes: list[Outcome], sights: list[bool], steps: int
) -> None:
    """Each goal is reached or fails, once; a stop ends the mission where it must; the result is what was reported."""
    rover, reports = _Rover(outcomes, sights, steps), list[Report]()
    reached = MissionRun(Mission(tuple(goals)), rover, reports.append).run()
    ends = {report.goal: report.state for report in reports if report.state in (State.REACHED, State.FAILED)}
    assert reached == (len(ends) == len(goals) and set(ends.values()) == {State.REACHED})
    must_stop = any(state is State.FAILED and goals[number - 1].rules.stops for number, state in ends.items())
    assert reports[-1].state is (State.STOPPED if rover.steps < 0 or must_stop else State.DONE)
    assert list(ends) == list(range(1, len(ends) + 1))
    for number, goal in enumerate(goals, 1):
        drives = [one for one in reports if one.goal == number and one.message.startswith("driving")]
        assert len(drives) <= (goal.rules.retries + 1) * 2
        seen_last = isinstance(goal.place, LandmarkViewpoint) and ends.get(number) is State.REACHED
        assert not seen_last or ("sees", True) in rover.called
