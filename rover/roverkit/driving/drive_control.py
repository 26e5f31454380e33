"""Decision about the next command for the driving board, from velocities, a path, the mode and the rover's pose.

The module has no clock, no topics and no threads. All times are arguments: nanoseconds of a clock that goes forwards.
If it jumps back, as that of a simulation does when this is started again, everything that was received is forgotten.

The board's message has no speed. A command is the distance that the rover is to drive in the next ``horizon`` seconds,
and the command after it, which is sent earlier, replaces it. A rover that gets no further command therefore stops by
itself, after the distance of the last one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from roverkit.driving.arcs import Arc, PlanarPose, arc_of_twist
from roverkit.driving.board_commands import STOP, BoardCommand, BoardLimitError, DrivingBoard
from roverkit.driving.path_following import Ending, PathFollower, Point

_QUIET_S = 5.0
"""Time in seconds without a repetition after which the same message is said again."""
_FEEDBACK = 1.0
"""Part of the distance that the rover lags behind in a second which is added to commands."""
_LONGEST_STEP_S = 0.2
"""Longest time in seconds that counts for an acceleration: the rover does not go on to accelerate in a pause."""
_SIMILAR_SPEED = 0.1
"""Change of the speed, as a part of it, for which no command is sent before the next one is due."""
_SIMILAR_CURVATURE = 0.1
"""Change of the curvature in 1/m for which none is sent; at 0.5 m/s, the yaw is wrong by 0.3 degrees after 0.1 s."""


class State(Enum):
    """State of the control."""

    MANUAL = "manual"
    """A person drives, or may drive: nothing is sent."""
    IDLE = "idle"
    DRIVING = "driving"
    """Velocities are executed."""
    FOLLOWING = "following"
    """A path is followed."""
    WAITING = "waiting"
    """The rover stands until it knows its position."""
    REFUSED = "refused"
    """The rover stands, because the last velocity cannot be driven."""


class Status(NamedTuple):
    """State of the control, with the reason; the reason may be empty."""

    state: State
    reason: str


@dataclass(frozen=True, slots=True)
class DriveSettings:
    """Limits and times of the control, in metres and seconds."""

    board: DrivingBoard = field(default_factory=lambda: DrivingBoard(smallest_radius=1.0, reverses=False))
    speed: float = 0.5
    """Largest speed in m/s; also the speed on a path."""
    acceleration: float = 0.5
    """Largest change of the speed in m/s^2. A stop for safety is not limited."""
    period: float = 0.1
    """Time from one command to the next while nothing changes."""
    horizon: float = 0.4
    """Time for which a command is enough."""
    timeout: float = 0.5
    """Longest time between two velocities."""
    mode_timeout: float = 1.0
    """Longest time between two messages with the mode; 0 for no limit."""
    pose_timeout: float = 0.5
    """Largest age of the rover's pose."""
    pose_deviation: float = 0.5
    """Largest standard deviation of the rover's position in metres."""
    velocity_needs_pose: bool = False
    """True if velocities, too, are executed only while the pose of the rover is known."""
    lookahead: float = 0.8
    """Distance to the point of a path at which the rover aims."""
    goal_tolerance: float = 0.1
    """Distance to the end of a path at which the end is reached."""


@dataclass(frozen=True, slots=True)
class Localization:
    """Pose of the rover, as the localization reports it."""

    pose: PlanarPose
    frame: str
    """Frame of the pose."""
    at: int
    """Time of the pose."""
    deviation: float
    """Standard deviation of the position in metres."""
    speed: float | None = None
    """Measured speed in m/s along the rover's x axis; None if it is not known."""


@dataclass(frozen=True, slots=True)
class _Motion:
    """Motion that is wanted now: a speed in m/s on an arc of a curvature in 1/m, for at most a distance in metres."""

    speed: float
    curvature: float
    left: float = math.inf


@dataclass(frozen=True, slots=True)
class _Path:
    follower: PathFollower
    frame: str


class DriveControl:
    """Control of one rover.

    `step` returns what is to be sent now; call it often, and after each event. A change is sent at once, otherwise a
    command follows after each period: a board that gets a command before it has reported its progress on the last one
    leaves the odometry to guess. At the start, the mode is manual.
    """

    def __init__(self, settings: Callable[[], DriveSettings], say: Callable[[str], None]) -> None:
        """Begin; ``settings`` returns the current settings, and ``say`` is called with messages for the user."""
        self._settings, self._say = settings, say
        self._said: dict[str, int] = {}  # when each message was the case last
        self._now = 0
        self._automatic, self._mode_at = False, 0
        self._velocity: _Motion | None = None
        self._velocity_at = 0
        self._path: _Path | None = None
        self._localization: Localization | None = None
        self._speed = 0.0  # that the rover is to have now
        self._curvature = 0.0
        self._commanded: _Motion | None = None  # by the last command; None after a change that is to be sent at once
        self._commanded_at = 0
        self._lag = 0.0  # metres that are added to commands, because the rover is slower than it is to be
        self._is_up, self._steady = False, 0.0  # true if the rover has started; seconds for which it is to be fast
        self._moves = False  # true if the last command was not the stop
        self.status = Status(State.MANUAL, "no control_mode has come yet")
        """State, after the last step."""

    # --- events ---------------------------------------------------------------------------------------------------

    def set_mode(self, automatic: bool, now: int) -> None:
        """Take the mode: automatic, or manual. A change ends the path and the velocity."""
        self._mode_at = now
        if not automatic:
            self._end(Status(State.MANUAL, "control_mode is MANUAL"))
        elif not self._automatic:
            self._end(Status(State.IDLE, "control_mode is AUTO"))
        self._automatic = automatic

    def drive(self, linear: float, angular: float, now: int) -> None:
        """Take a velocity: m/s along x, and rad/s about z. It ends the path."""
        if not self._automatic:
            return
        if self._path is not None:
            self._end(Status(State.IDLE, "a velocity has ended the path"))
            self.tell("the path is abandoned, because a velocity came", now)
        self._velocity_at = now
        try:
            self._velocity = velocity = self._motion(linear, angular, now)
            if self._commanded is not None and not _is_similar(velocity, self._commanded):
                self._commanded = None
        except ValueError as error:
            self._refuse_velocity(error, now)

    def follow(self, points: Sequence[Point], frame: str, now: int) -> None:
        """Take a path of points in a frame; it ends the velocity. A path without points ends the one before."""
        if not self._automatic:
            self.tell("the path is ignored, because the mode is manual", now)
            return
        if not points:
            self._end(Status(State.IDLE, "an empty path has ended the path"))
            return
        try:
            path = _Path(PathFollower(points), frame)
        except ValueError as error:
            self.tell(f"the path is refused: {error}", now)
            return
        self._velocity = self._commanded = None
        self._path = path
        self._check_frame(now)

    def localize(self, localization: Localization, now: int) -> None:
        """Take the pose of the rover."""
        self._localization = localization
        self._check_frame(now)

    def tell(self, message: str, now: int) -> None:
        """Say a message to the user, but only once while its cause goes on."""
        if now - self._said.get(message, -(10**18)) > _QUIET_S * 1e9:
            self._say(message)
        self._said[message] = now

    # --- decisions ------------------------------------------------------------------------------------------------

    def step(self, now: int) -> BoardCommand | None:
        """Return the command that is to be sent now; None for none. The status tells why."""
        if now < self._now:
            self._automatic, self._localization, self._said = False, None, {}
            self._end(Status(State.MANUAL, "the time has jumped back; waiting for control_mode"))
        self._now = now
        motion = self._wanted(now)
        if motion is None:
            return self._stop()
        seconds = (now - self._commanded_at) / 1e9
        if self._commanded is not None and seconds < self._settings().period:
            return None
        try:
            command = self._command(motion, min(seconds, _LONGEST_STEP_S))
        except BoardLimitError as error:  # a parameter has changed since the velocity came
            self._refuse_velocity(error, now)
            return self._stop()
        self._moves, self._commanded, self._commanded_at = command.distance_to_go != 0, motion, now
        return command

    def _stop(self) -> BoardCommand | None:
        """Return the stop if the last command moves the rover, else None."""
        self._speed = self._lag = 0.0
        self._is_up, self._steady = False, 0.0
        self._commanded, self._commanded_at = None, self._now
        stops, self._moves = self._moves, False
        return STOP if stops else None

    def _wanted(self, now: int) -> _Motion | None:
        """Return the motion that is wanted now, and set the status; None if the rover must stand."""
        settings = self._settings()
        if self._automatic and 0 < settings.mode_timeout < (silent := (now - self._mode_at) / 1e9):
            self._automatic = False
            self._end(Status(State.MANUAL, f"no control_mode for {silent:.1f} s; is the basestation's link cut?"))
        if not self._automatic:
            return None
        if self._path is None and now - self._velocity_at > settings.timeout * 1e9:
            if self._velocity is not None or self.status.state is State.REFUSED:
                self._end(Status(State.IDLE, f"no velocity for {settings.timeout:g} s"))
            return None
        if self._path is None and self._velocity is None:
            return None
        place = self._localization
        needed = self._path is not None or settings.velocity_needs_pose
        if needed and (problem := _problem(place, settings, now)):
            self.status = Status(State.WAITING, problem)
            return None
        if self._path is not None and place is not None:
            return self._on_path(self._path.follower, place.pose, settings, now)
        self.status = Status(State.DRIVING, "")
        return self._velocity

    def _on_path(self, follower: PathFollower, pose: PlanarPose, settings: DriveSettings, now: int) -> _Motion | None:
        steering = follower.steer(pose, settings.lookahead, settings.board.smallest_radius, settings.goal_tolerance)
        if steering.ending is not Ending.AHEAD:
            self._end(Status(State.IDLE, f"the end of the path is {steering.ending.value}, {steering.left:.2f} m away"))
            return None
        self.status = Status(State.FOLLOWING, "")
        speed = min(settings.speed, math.sqrt(2 * settings.acceleration * steering.left))
        return _Motion(speed, self._limited(steering.curvature, now), steering.left)

    def _motion(self, linear: float, angular: float, now: int) -> _Motion:
        """Return the motion of a velocity within the limits. Raises `ValueError` if the board cannot drive it."""
        if not (math.isfinite(linear) and math.isfinite(angular)):
            raise ValueError("it is not a number")
        if linear == 0 and angular != 0:
            raise ValueError("the message of the driving board has no turn on the spot; drive an arc")
        settings = self._settings()
        if linear < 0 and not settings.board.reverses:
            raise ValueError("the driving board does not drive backwards; if it does, set the parameter reverse")
        curvature = arc_of_twist(linear, angular, 1.0).curvature
        speed = math.copysign(min(abs(linear), settings.speed), linear)
        settings.board.command(Arc(speed, curvature))  # raises an error if it cannot drive this
        if abs(linear) > settings.speed:
            self.tell(f"velocities are limited to the parameter speed, {settings.speed:g} m/s", now)
        return _Motion(speed, self._limited(curvature, now))

    def _limited(self, curvature: float, now: int) -> float:
        board = self._settings().board
        limited = board.drivable(Arc(1.0, curvature)).curvature
        if limited != curvature:
            self.tell(f"turns are limited to the parameter smallest_radius, {board.smallest_radius:g} m", now)
        return limited

    def _command(self, motion: _Motion, seconds: float) -> BoardCommand:
        """Return the command for a motion, after the time since the last command.

        Raises `BoardLimitError` if the board cannot drive it.
        """
        settings = self._settings()
        wanted, curvature = motion.speed, motion.curvature
        if wanted * self._speed < 0 or wanted == 0:  # it brakes on its arc, before it drives in the other direction
            wanted, curvature = 0.0, self._curvature
        change = settings.acceleration * seconds
        self._speed += min(max(wanted - self._speed, -change), change)
        self._curvature = curvature
        self._steady = self._steady + seconds if self._speed == wanted else 0.0
        distance = _travel(self._speed, wanted, settings.acceleration, settings.horizon)
        corrected = max(abs(distance) + self._feedback(settings, abs(distance), seconds), 0.0)
        distance = math.copysign(min(corrected, motion.left), distance)
        return settings.board.command(Arc(distance, curvature))

    def _feedback(self, settings: DriveSettings, distance: float, seconds: float) -> float:
        """Return the metres to add to the distance of a command, so that the measured speed becomes the wanted one.

        A board chooses its speed by itself. The correction is the integral of the difference, within limits: never more
        than the distance itself, so that the rover still stops soon without a further command.
        """
        place = self._localization
        if place is None or place.speed is None or self._now - place.at > settings.pose_timeout * 1e9:
            self._lag = 0.0
        else:
            slower = math.copysign(1, self._speed) * (self._speed - place.speed)
            self._is_up |= slower <= 0 or self._steady > settings.horizon
            if not self._is_up:  # the rover starts: the correction would grow until the rover is too fast
                return self._lag
            self._lag = min(max(self._lag + _FEEDBACK * slower * seconds, -2 * distance), distance)
        return self._lag

    def _check_frame(self, now: int) -> None:
        """End the path if the rover's pose is in another frame."""
        if self._path is None or self._localization is None or self._path.frame == self._localization.frame:
            return
        message = f"the path is in the frame {self._path.frame!r}, but the pose is in {self._localization.frame!r}"
        self.tell(f"the path is refused: {message}", now)
        self._end(Status(State.IDLE, message))

    def _refuse_velocity(self, error: ValueError, now: int) -> None:
        self.tell(f"the velocity is refused: {error}", now)
        self._end(Status(State.REFUSED, str(error)))

    def _end(self, status: Status) -> None:
        """Forget the velocity and the path."""
        self._velocity = self._path = self._commanded = None
        self.status = status


def _is_similar(wanted: _Motion, commanded: _Motion) -> bool:
    """Return true if a velocity need not be sent before the next command is due."""
    return (
        abs(wanted.speed - commanded.speed) <= _SIMILAR_SPEED * abs(commanded.speed)
        and abs(wanted.curvature - commanded.curvature) <= _SIMILAR_CURVATURE
    )


def _travel(speed: float, wanted: float, acceleration: float, seconds: float) -> float:
    """Return the distance in metres in some seconds, from a speed to another one with a limited acceleration."""
    change = wanted - speed
    ramp = min(abs(change) / acceleration, seconds)
    reached = speed + math.copysign(acceleration * ramp, change)
    return (speed + reached) / 2 * ramp + reached * (seconds - ramp)


def _problem(place: Localization | None, settings: DriveSettings, now: int) -> str:
    """Return the reason why the pose of the rover is not known; empty if it is known."""
    if place is None:
        return "no pose has come yet"
    if now - place.at > settings.pose_timeout * 1e9:
        return f"the newest pose is more than {settings.pose_timeout:g} s old"
    if place.deviation > settings.pose_deviation:
        return f"the position is uncertain by more than {settings.pose_deviation:g} m"
    return ""
