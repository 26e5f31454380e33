"""Rover that Nav2 drives: the actions NavigateToPose and BackUp, the pose on /tf, and what the cameras see."""

from __future__ import annotations

import math
import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, cast

from roverkit.driving.arcs import PlanarPose
from roverkit.driving.drive_rows import DriveRows
from roverkit.mission.mission_declaration import BACK_UP, DETECTIONS, NAVIGATE
from roverkit.mission.mission_file import Mission
from roverkit.mission.mission_rules import MissionStoppedError, Outcome
from roverkit.node.ros_connection import RosConnection
from roverkit.vision.poses.transform_tree import TransformError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, MiddlewareError, SetupError
from roverlink.runtime.interfaces import vision_msgs
from roverlink.runtime.middleware.rclpy import RclpyMiddleware
from roverlink.runtime.middleware.rclpy_actions import GoalEnd, RclpyAction

_STEP_S = 0.1  # longest time between two looks at the clock, which may be that of a simulation
_BACK_UP_SPEED = 0.2  # m/s
_SERVER_S = 5.0  # longest time in seconds for a server that is found, or that was started again
_FEEDBACK_S = 5.0  # longest time in seconds between two messages of feedback, of which Nav2 sends several a second
_ANSWER_S = 5.0  # longest time in seconds for the end of a goal that was cancelled
_POSE_S = 5.0  # longest time in seconds without the rover's pose
_OUTCOMES = {
    GoalEnd.SUCCEEDED: Outcome.REACHED,
    GoalEnd.REFUSED: Outcome.REFUSED,
    GoalEnd.ABORTED: Outcome.FAILED,
}


class Nav2Rover:
    """Rover that Nav2 drives.

    The methods are called from one thread. They wait for what comes on the threads of the middleware, and raise
    `MissionStoppedError` as soon as a person takes over.
    """

    def __init__(
        self,
        connection: RosConnection,
        mission: Mission,
        rows: DriveRows,
        base_frame: str,
        show_distance: Callable[[float], None],
        warn: Callable[..., None],
    ) -> None:
        """Connect with Nav2 and the cameras.

        ``show_distance`` is called with the metres that are left, on the thread that waits, and ``warn`` with messages
        for the user. Raises `MiddlewareError` if the interfaces of Nav2 are not installed.
        """
        try:
            from nav2_msgs.action import BackUp, NavigateToPose
        except ImportError as error:
            raise MiddlewareError(
                f"the interfaces of Nav2 are not installed ({error}); install ros-$ROS_DISTRO-nav2-msgs"
            ) from error
        self._navigate_type, self._back_up_type = NavigateToPose, BackUp
        self._tree, self._clock, self._topic = connection.transforms, connection.clock, connection.topic
        self._mission, self._rows, self._base = mission, rows, base_frame
        self._show_distance, self._warn = show_distance, warn
        self._news = threading.Condition()
        self._automatic = self._handed_over = self._taken_over = False
        self._left: float | None = None
        self._heard_at: float | None = None
        self._seen: Counter[str] = Counter()
        middleware = cast(RclpyMiddleware, connection.middleware)
        self._navigate = middleware.action(NavigateToPose, self._topic(NAVIGATE.name))
        self._back_up = middleware.action(BackUp, self._topic(BACK_UP.name))
        rows.mode.subscribe(middleware, self._topic, self._take_mode)
        if mission.has_landmarks:
            for name in mission.detections:
                replace(DETECTIONS, name=name).subscribe(middleware, self._topic, self._take_sight)

    def wait_until_ready(self, seconds: float) -> None:
        """Wait until Nav2 is there and the rover knows its pose. Raises `SetupError` if this takes too long."""
        if not self._until(self._navigate.has_server, seconds):
            raise SetupError(
                f"Nav2 is not there: no server of the action {self._topic(NAVIGATE.name)} for {seconds:g} s; start it "
                "with `ros2 launch rtt_slam slam.launch.py`, or wait longer with --wait SECONDS"
            )
        try:
            self._pose_within(seconds)
        except TransformError as error:
            raise SetupError(f"the rover's pose on the map is not known: {error}; is localization running?") from error

    def wait_for_handover(self) -> None:
        """Wait until the operator lets the rover drive by itself. From then on, any other mode stops the mission."""
        with self._news:
            while not self._automatic:
                self._news.wait(_STEP_S)  # in steps: on some systems, Ctrl-C does not end a wait without a limit
            self._handed_over = True

    def pose(self) -> PlanarPose:
        """Return the pose of the rover on the map."""
        try:
            return self._pose_within(_POSE_S)
        except TransformError as error:
            raise MissionStoppedError(f"the rover has lost its position: {error}") from error

    def drive_to(self, pose: PlanarPose, timeout: float) -> Outcome:
        """Drive to a pose on the map, for at most a time in seconds."""
        goal = self._navigate_type.Goal()
        goal.pose.header.frame_id = self._mission.frame
        stamp = self._clock.now()
        goal.pose.header.stamp.sec, goal.pose.header.stamp.nanosec = stamp // 10**9, stamp % 10**9
        goal.pose.pose.position.x, goal.pose.pose.position.y = pose.x, pose.y
        goal.pose.pose.orientation.z, goal.pose.pose.orientation.w = math.sin(pose.yaw / 2), math.cos(pose.yaw / 2)
        return self._execute(self._navigate, goal, timeout)

    def back_up(self, distance: float) -> Outcome:
        """Drive back in a straight line, by a distance in metres."""
        goal = self._back_up_type.Goal()
        goal.target.x, goal.speed = distance, _BACK_UP_SPEED
        allowed = 5.0 + 2 * distance / _BACK_UP_SPEED
        goal.time_allowance.sec = math.ceil(allowed)
        return self._execute(self._back_up, goal, allowed + _ANSWER_S)

    def sees(self, landmark: str, seconds: float) -> bool:
        """Return true as soon as a camera sees a landmark, or false after a time in seconds."""
        before = self._seen[landmark]
        return self._until(lambda: self._seen[landmark] > before, seconds)

    def wait(self, seconds: float) -> None:
        """Stay for a time in seconds."""
        self._until(lambda: False, seconds)

    def _execute(self, action: RclpyAction, goal: Any, timeout: float) -> Outcome:
        """Send a goal to Nav2 and wait for its end; cancel it if it takes too long, or if the mission ends.

        Nav2 is dead if its server disappears, or if its feedback ends: a killed server stays known for some time.
        """
        if not self._until(action.has_server, _SERVER_S):
            return Outcome.GONE
        self._heard_at = None
        ends: list[GoalEnd] = []

        def end(how: GoalEnd) -> None:
            with self._news:
                ends.append(how)
                self._news.notify_all()

        def is_gone() -> bool:
            silent = self._heard_at is not None and time.monotonic() - self._heard_at > _FEEDBACK_S
            return silent or not action.has_server()

        def is_over() -> bool:
            return bool(ends) or is_gone()

        sent = action.send(goal, self._take_feedback, end)
        is_late = True
        try:
            is_late = not self._until(is_over, timeout)
        finally:
            if not ends:
                sent.cancel(self._warn_of_refusal)
                with self._news:
                    self._news.wait_for(is_over, _ANSWER_S)
        if is_late and ends != [GoalEnd.SUCCEEDED]:
            return Outcome.TIMED_OUT
        if ends == [GoalEnd.CANCELED]:
            raise MissionStoppedError("another program has cancelled the goal")
        return _OUTCOMES[ends[0]] if ends else Outcome.GONE

    def _warn_of_refusal(self) -> None:
        self._warn("Nav2 refused to cancel the goal: the rover may drive on; stop it with MODE_MANUAL")

    def _until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait until a condition is true; return false if it is not after a time in seconds.

        Raises `MissionStoppedError` if a person takes over.
        """
        deadline = self._clock.now() + round(seconds * 1e9)
        while True:
            with self._news:
                if self._taken_over:
                    raise MissionStoppedError("a person has taken over (control_mode is not MODE_AUTO)")
                if condition():
                    return True
                if self._clock.now() >= deadline:
                    return False
                self._news.wait(_STEP_S)
                left, self._left = self._left, None
            if left is not None:
                self._show_distance(left)

    def _pose_within(self, seconds: float) -> PlanarPose:
        """Return the pose of the rover, or raise the last `TransformError` if it is not known for a time in seconds."""
        found: list[PlanarPose] = []
        errors: list[TransformError] = []

        def look_up() -> bool:
            try:
                pose = self._tree.look_up(self._mission.frame, self._base, self._clock.now())
            except TransformError as error:
                errors.append(error)
                return False
            (x, y, _), ahead = pose.translation, pose.rotation[:, 0]
            found.append(PlanarPose(float(x), float(y), math.atan2(ahead[1], ahead[0])))
            return True

        if not self._until(look_up, seconds):
            raise errors[-1]
        return found[0]

    # --- on threads of the middleware ---------------------------------------------------------------------------------

    def _take_mode(self, messages: Sequence[bytes]) -> None:
        for data in messages:
            try:
                automatic = self._rows.is_automatic(data)
            except ConversionError as error:
                self._warn("ignoring a mode that cannot be read: %s", error)
                continue
            with self._news:
                self._automatic = automatic
                self._taken_over |= self._handed_over and not automatic
                self._news.notify_all()

    def _take_sight(self, messages: Sequence[bytes]) -> None:
        try:
            seen = [
                detection.id
                for data in messages
                for detection in cdr.decode(vision_msgs.Detection3DArray, data).detections
            ]
        except ConversionError as error:
            self._warn("ignoring landmarks that cannot be read: %s", error)
            return
        with self._news:
            self._seen.update(seen)
            self._news.notify_all()

    def _take_feedback(self, feedback: Any) -> None:
        with self._news:
            self._heard_at = time.monotonic()
            self._left = getattr(feedback, "distance_remaining", None)  # BackUp has none
