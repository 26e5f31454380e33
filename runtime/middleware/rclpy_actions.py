"""Client of a ROS 2 action, by rclpy.

Everything that belongs to a goal happens on the thread of the executor. From another thread, rclpy's client registers a
goal only after it has sent it, and ignores an answer that comes before (rclpy 3.3 of Humble and 7.1 of Jazzy).

A server may be ready for this client before it knows the client's readers. Then its answers go to nobody: Fast DDS
gives up after 0.1 s ("failed to send response (timeout): client will not receive response"), and the client never hears
that its goal was accepted or reached (ros2/rmw_fastrtps issue 392). So the client first asks for the result of a goal
that does not exist, again and again, until the server answers. DDS announces the readers of a client in the order in
which rcl makes them, and the one for results is the last that receives answers: a server that knows it knows them all.
"""

from __future__ import annotations

import enum
import uuid
from collections.abc import Callable
from typing import Any

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.clock import Clock, ClockType
from unique_identifier_msgs.msg import UUID

_QUESTION_S = 0.25  # time in seconds between two questions to a server that has not answered yet


class GoalEnd(enum.Enum):
    """Ends of a goal."""

    REFUSED = "refused"
    """The server did not accept the goal."""
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"
    CANCELED = "canceled"


_REFUSED = (CancelGoal.Response.ERROR_NONE, CancelGoal.Response.ERROR_REJECTED)
_ENDS = {
    GoalStatus.STATUS_SUCCEEDED: GoalEnd.SUCCEEDED,
    GoalStatus.STATUS_ABORTED: GoalEnd.ABORTED,
    GoalStatus.STATUS_CANCELED: GoalEnd.CANCELED,
}


class RclpyAction:
    """Client of one action."""

    def __init__(self, node: Any, executor: Any, action_class: Any, name: str) -> None:
        self._executor, self._client = executor, ActionClient(node, action_class, name)
        self._no_goal = ClientGoalHandle(
            self._client, UUID(uuid=list(uuid.uuid4().bytes)), action_class.Impl.SendGoalService.Response()
        )
        self._answers = False
        node.create_timer(_QUESTION_S, self._ask, clock=Clock(clock_type=ClockType.STEADY_TIME))
        executor.wake()

    def has_server(self) -> bool:
        """Return true if the server of the action is there, and its answers arrive here."""
        return self._answers and bool(self._client.server_is_ready())

    def send(self, goal: Any, take_feedback: Callable[[Any], None], end: Callable[[GoalEnd], None]) -> SentGoal:
        """Send a goal. The functions are called with its feedback and its end, on the thread of the executor."""
        return SentGoal(self._executor, self._client, goal, take_feedback, end)

    def _ask(self) -> None:
        if not self._client.server_is_ready():
            self._answers = False  # the next server is another one
        elif not self._answers:
            self._no_goal.get_result_async().add_done_callback(self._take_no_result)

    def _take_no_result(self, _: Any) -> None:
        self._answers = True


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
        self._refused: Callable[[], None] = lambda: None
        executor.create_task(self._send)

    def cancel(self, refused: Callable[[], None]) -> None:
        """Cancel the goal, as soon as the server has accepted it; its end comes as for every goal.

        ``refused`` is called on the thread of the executor if the server refuses to cancel it.
        """
        self._refused = refused
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
            self._ask_to_cancel(handle)

    def _cancel(self) -> None:
        self._canceled = True
        if self._handle is not None:
            self._ask_to_cancel(self._handle)

    def _ask_to_cancel(self, handle: Any) -> None:
        handle.cancel_goal_async().add_done_callback(self._take_cancelling)

    def _take_cancelling(self, future: Any) -> None:
        # A goal that has ended meanwhile cannot be cancelled any more, which is no refusal. A server of rclpy does not
        # set the code of a refusal.
        answer = future.result()
        if not answer.goals_canceling and answer.return_code in _REFUSED:
            self._refused()

    def _take_result(self, future: Any) -> None:
        # A server that has forgotten the goal, because it was started again, answers with an unknown status.
        self._end(_ENDS.get(future.result().status, GoalEnd.ABORTED))
