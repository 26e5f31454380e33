"""Client of a ROS 2 action, by rclpy.

Everything that belongs to a goal happens on the thread of the executor. From another thread, rclpy's client registers a
goal only after it has sent it, and ignores an answer that comes before (rclpy 3.3 of Humble and 7.1 of Jazzy).
"""

from __future__ import annotations

import enum
from collections.abc import Callable
from typing import Any

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient


class GoalEnd(enum.Enum):
    """Ends of a goal."""

    REFUSED = "refused"
    """The server did not accept the goal."""
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"
    CANCELED = "canceled"


_ENDS = {
    GoalStatus.STATUS_SUCCEEDED: GoalEnd.SUCCEEDED,
    GoalStatus.STATUS_ABORTED: GoalEnd.ABORTED,
    GoalStatus.STATUS_CANCELED: GoalEnd.CANCELED,
}


class RclpyAction:
    """Client of one action."""

    def __init__(self, node: Any, executor: Any, action_class: Any, name: str) -> None:
        self._executor, self._client = executor, ActionClient(node, action_class, name)
        executor.wake()

    def has_server(self) -> bool:
        """Return true if the server of the action is there."""
        return bool(self._client.server_is_ready())

    def send(self, goal: Any, take_feedback: Callable[[Any], None], end: Callable[[GoalEnd], None]) -> SentGoal:
        """Send a goal. The functions are called with its feedback and its end, on the thread of the executor."""
        return SentGoal(self._executor, self._client, goal, take_feedback, end)


class SentGoal:
    """Goal that a server executes."""

    def __init__(
        self,
        executor: Any,
        client: Any,
        goal: Any,
        take_feedback: Callable[[Any], None],
        end: Callable[[GoalEnd], None],
    ) -> None:
        self._executor, self._client, self._goal = executor, client, goal
        self._take_feedback, self._end = take_feedback, end
        self._handle: Any = None
        self._canceled = False
        executor.create_task(self._send)

    def cancel(self) -> None:
        """Cancel the goal, as soon as the server has accepted it; its end comes as for every goal."""
        self._executor.create_task(self._cancel)

    def _send(self) -> None:
        future = self._client.send_goal_async(self._goal, lambda message: self._take_feedback(message.feedback))
        future.add_done_callback(self._take_answer)

    def _take_answer(self, future: Any) -> None:
        handle = future.result()
        if not handle.accepted:
            self._end(GoalEnd.REFUSED)
            return
        self._handle = handle
        handle.get_result_async().add_done_callback(self._take_result)
        if self._canceled:
            handle.cancel_goal_async()

    def _cancel(self) -> None:
        self._canceled = True
        if self._handle is not None:
            self._handle.cancel_goal_async()

    def _take_result(self, future: Any) -> None:
        # A server that has forgotten the goal, because it was started again, answers with an unknown status.
        self._end(_ENDS.get(future.result().status, GoalEnd.ABORTED))
