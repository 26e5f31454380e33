"""The thread that takes the messages of rclpy's subscriptions, beside rclpy's executor."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest
from judge import Bridge, Judge, interface, repeat
from needs import needs_native
from polling import PATIENCE_S, wait_until
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from generated.messages import DrivingBoardMotorMessage
from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity
from roverlink.runtime.middleware.rclpy import RclpyMiddleware
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore, open_core
from roverlink.runtime.native.lending import LentTopic, NativeSubscription

_MOTOR = "comms/msg/DrivingBoardMotorMessage"
_BURST = 1000


@pytest.fixture
def ours(environment: dict[str, str]) -> Iterator[RclpyMiddleware]:
    """A node of ours in this process."""
    with RclpyMiddleware(NodeIdentity("receiver"), None) as ours:
        yield ours


class _Received:
    """What one topic of ours has received, as numbers that the judge put into the messages.

    With a core, it takes the messages, and hands them over.
    """

    def __init__(
        self, ours: RclpyMiddleware, judge: Judge, core: NativeCore | None, topic: str, priority: int = 0
    ) -> None:
        self.numbers: list[int] = []
        self.on_first: Callable[[], None] = lambda: None
        subscription = ours.subscribe(topic, DrivingBoardMotorMessage, Qos(depth=_BURST), self._take, priority)
        if core:
            assert isinstance(subscription, NativeSubscription)
            subscription.lend_to(core, LentTopic(native.Subscription(), self._take, lambda: None))
        self._publisher = judge.node.create_publisher(interface(_MOTOR), topic, _BURST)
        wait_until(self._publisher.get_subscription_count, f"a subscription of {topic}")

    def publish(self, number: int) -> None:
        """Publish a number."""
        self._publisher.publish(interface(_MOTOR)(distance_to_go=float(number)))

    def _take(self, messages: Any) -> None:
        self.on_first()
        self.numbers += [int(cdr.decode(DrivingBoardMotorMessage, message).distance_to_go) for message in messages]


Receive = Callable[..., _Received]


@pytest.fixture(params=[False, pytest.param(True, marks=needs_native)], ids=["Python", "core"])
def receive(request: pytest.FixtureRequest, ours: RclpyMiddleware, judge: Judge) -> Receive:
    """Starts to receive topics of the judge, by their names and priorities, with each of the two ways."""
    return partial(_Received, ours, judge, open_core(REGISTRY) if request.param else None)


def test_a_burst_arrives_whole_and_in_order(receive: Receive) -> None:
    """Each message of a burst that the queue holds reaches the callback, in order."""
    received = receive("/a")
    for number in range(_BURST):
        received.publish(number)
    wait_until(lambda: len(received.numbers) >= _BURST, "the burst")
    assert received.numbers == list(range(_BURST))


def test_an_urgent_topic_is_served_first(receive: Receive, judge: Judge) -> None:
    """Messages that wait on two topics are handled by priority, whichever came first."""
    order: list[str] = []
    entered, go_on = threading.Event(), threading.Event()
    blocking, slow, urgent = receive("/blocking"), receive("/slow"), receive("/urgent", priority=9)
    slow.on_first, urgent.on_first = (lambda: order.append("slow")), (lambda: order.append("urgent"))
    blocking.on_first = lambda: (entered.set(), go_on.wait(PATIENCE_S))  # type: ignore[assignment]
    blocking.publish(0)
    assert entered.wait(PATIENCE_S)
    for number in range(3):
        slow.publish(number)
    urgent.publish(0)
    _has_arrived(judge)
    go_on.set()
    wait_until(lambda: len(slow.numbers) == 3 and urgent.numbers, "both topics")
    assert order[0] == "urgent"


def _has_arrived(judge: Judge) -> None:
    """Wait for a round trip of another topic, which takes longer than what was published before it."""
    heard = judge.hear("/round_trip", _MOTOR)
    publisher = judge.node.create_publisher(interface(_MOTOR), "/round_trip", 1)
    repeat(lambda: publisher.publish(interface(_MOTOR)()), lambda: heard.values, "a round trip")


@pytest.mark.parametrize("calls", [True, False], ids=["with callbacks", "without"])
def test_a_shutdown_from_outside_ends_the_threads_quietly(
    ours: RclpyMiddleware, receive: Receive, monkeypatch: pytest.MonkeyPatch, calls: bool
) -> None:
    """Where another part of the program shuts ROS 2 down, both threads end without a traceback.

    A signal handler of rclpy's shuts contexts down without their callbacks.
    """
    failures: list[Any] = []  # what ends threads by an exception from now on
    monkeypatch.setattr(threading, "excepthook", failures.append)
    received = receive("/a")
    repeat(lambda: received.publish(1), lambda: received.numbers, "a message")
    (ours._context if calls else ours._context.handle).shutdown()
    _wait_for_end("rclpy-take")
    _wait_for_end("rclpy-spin")
    ours.close()
    assert not failures


def test_an_action_is_complete_before_the_executor_sees_it(
    ours: RclpyMiddleware, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A client of rclpy 9.1 is added to the node before it is complete; an executor that looks at it then would end."""
    action = pytest.importorskip("nav2_msgs.action").NavigateToPose
    failures: list[Any] = []
    monkeypatch.setattr(threading, "excepthook", failures.append)
    add = Node.add_waitable

    def add_slowly(node: Node, waitable: Any) -> None:
        add(node, waitable)
        time.sleep(0.2)

    monkeypatch.setattr(Node, "add_waitable", add_slowly)
    assert not ours.action(action, "/navigate_to_pose").has_server()
    assert not failures


def _wait_for_end(thread_name: str) -> None:
    wait_until(
        lambda: thread_name not in {thread.name for thread in threading.enumerate()}, f"the end of {thread_name}"
    )


def test_without_internal_names_the_executor_receives(
    environment: dict[str, str], judge: Judge, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """On an rclpy that has no such wait set, messages still arrive, and the log says what is different."""
    with monkeypatch.context() as patched:
        patched.delattr(rclpy_implementation.Subscription, "take_message")
        ours = RclpyMiddleware(NodeIdentity("receiver"), None)
    with ours:
        assert "its executor receives the messages" in caplog.text
        received = _Received(ours, judge, None, "/a")
        repeat(lambda: received.publish(1), lambda: received.numbers, "a message")


@pytest.mark.parametrize("middleware", ["rclpy"])
def test_a_publisher_that_cannot_match_is_warned_about(judge: Judge, bridge: Callable[..., Bridge]) -> None:
    """The warning of rclpy about a best-effort publisher of a command topic names the topic."""
    running = bridge()
    judge.node.create_publisher(
        interface(_MOTOR), "/drive_motor", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    )
    running.program.wait_for("topic '/drive_motor', offering incompatible QoS", running.program.errors)
