"""Thread that takes the serialized messages of rclpy's subscriptions.

rclpy's executor costs 0.2 to 0.3 ms of CPU a message: for each it makes a task and a future, triggers a guard
condition, and builds a wait set with every entity of the node. This thread waits with a wait set that has our
subscriptions only, and takes all messages that have arrived. The executor serves the rest of the node.

rclpy does not document its wait set. These facts were read in its sources, and are the same in Humble (3.3), Jazzy
(7.1) and Rolling of December 2024; Kilted (9.1) and Jazzy pass the tests in ``tests/ros2``:
- ``rclpy/executors.py``: `WaitSet` is filled by ``clear_entities`` and ``add_subscription``. Each ``wait`` removes the
  entities that are not ready, so they are added again before the next.
- ``rclpy/executors.py``: an executor waits for an entity only if the entity's callback group allows it.
- ``rclpy/event_handler.py`` (Humble: ``qos_event.py``): a handler of a QoS event has ``add_to_wait_set``, ``is_ready``,
  ``take_data`` and ``callback``.
- ``src/rclpy/subscription.cpp``: ``take_message`` with ``raw`` returns the bytes of a message with its times, or None.
- ``src/rclpy/destroyable.cpp``: a handle that has been entered is destroyed only after it has been left.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any, NamedTuple

from rclpy.callback_groups import CallbackGroup
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation

from roverlink.runtime.middleware.protocol import Callback
from roverlink.runtime.middleware.serving import ServedTopic, has_ended, serve

_EVENTS_NS = 1_000_000_000  # time between two looks for QoS events
_DESTROYED_S = 1.0  # longest time for which the end of a subscription waits for a callback that is running


class _WithoutExecutor(CallbackGroup):  # type: ignore[misc]  # rclpy has no types in Humble
    """Callback group of the entities that no rclpy executor may wait for: our subscriptions and their QoS events.

    If an executor waited for QoS events, Fast DDS would wake it with each message.
    """

    def can_execute(self, _: Any) -> bool:
        """Return false; an executor asks for each entity before it waits."""
        return False


class _Reader:
    """Received messages of one subscription."""

    def __init__(self, handle: Any, message_class: Any) -> None:
        self._take, self._class = handle.take_message, message_class

    def take(self, most: int) -> list[bytes]:
        """Take at most ``most`` received messages, the oldest first."""
        messages: list[bytes] = []
        while len(messages) < most and (taken := self._take(self._class, True)):
            messages.append(taken[0])
        return messages


class _Subscribed(NamedTuple):
    """rclpy subscription: its handle, the handle's address, the handlers of its QoS events, and its topic."""

    handle: Any
    address: int
    events: Sequence[Any]
    topic: ServedTopic


class Receiver:
    """Thread that waits for the messages of subscriptions and calls their callbacks, the most urgent topics first.

    Raises AttributeError or TypeError if the internals of rclpy differ from those that this module's docstring lists.
    """

    def __init__(self, node: Any) -> None:
        self._node, self._context = node, node.context
        self._group = _WithoutExecutor()
        self._woken = GuardCondition(callback=None, callback_group=None, context=self._context)
        self._subscribed: tuple[_Subscribed, ...] = ()
        # rclpy's subscriptions that the thread has to destroy, and what it then sets
        self._closed: list[tuple[Any, threading.Event]] = []
        self._stopped = False
        self._try_names()
        # Somebody else in the process may shut ROS 2 down; the program ends by its own signal handler.
        self._context.on_shutdown(self._stop)
        self._thread = threading.Thread(target=self._receive, name="rclpy-take", daemon=True)
        self._thread.start()

    def subscribe(
        self, message_class: Any, topic: str, profile: Any, callback: Callback, priority: int
    ) -> Callable[[], None]:
        """Call ``callback`` with the serialized messages of a topic, on the thread of this receiver.

        Returns a function that ends the subscription.
        """
        subscription = self._node.create_subscription(
            message_class, topic, _not_called, profile, callback_group=self._group, raw=True
        )
        handle = subscription.handle
        served = ServedTopic(_Reader(handle, message_class), callback, priority)
        subscribed = _Subscribed(handle, handle.pointer, subscription.event_handlers, served)
        self._subscribed = tuple(
            sorted((*self._subscribed, subscribed), key=lambda subscription: -subscription.topic.priority)
        )
        self._woken.trigger()

        def close() -> None:
            self._subscribed = tuple(
                subscription for subscription in self._subscribed if subscription is not subscribed
            )
            # The thread destroys it, because it may be about to wait for its messages.
            destroyed = threading.Event()
            self._closed.append((subscription, destroyed))
            self._woken.trigger()
            # Until then, Fast DDS refuses another subscription of the topic with another message type.
            if threading.current_thread() is not self._thread and self._thread.is_alive():
                destroyed.wait(_DESTROYED_S)

        return close

    def stop(self) -> bool:
        """End the thread, and wait until it has ended; return false if it hangs. No running callback is interrupted."""
        self._stop()
        return has_ended(self._thread)

    def _stop(self) -> None:
        self._stopped = True
        self._woken.trigger()

    def _try_names(self) -> None:
        """Use the internal functions of rclpy once, so that a missing one raises an error at start."""
        rclpy_implementation.Subscription.take_message  # noqa: B018
        self._woken.trigger()
        self._wait(self._wait_set(), ())

    def _receive(self) -> None:
        try:
            while not self._stopped:
                while self._closed:
                    subscription, destroyed = self._closed.pop()
                    self._node.destroy_subscription(subscription)
                    destroyed.set()
                self._serve(self._subscribed)
        except rclpy_implementation.RCLError:
            # rclpy's signal handler shuts contexts down without their callbacks; then no wait set can be made.
            if self._context.ok():
                raise

    def _serve(self, subscribed: Sequence[_Subscribed]) -> None:
        """Serve the topics in ``subscribed`` until another subscription is added, or until the thread has to end."""
        topics = [subscription.topic for subscription in subscribed]
        wait_set = self._wait_set(subscriptions=len(subscribed))
        events_due = 0
        with ExitStack() as held:
            # A shutdown from outside would destroy the subscriptions while the thread waits for them.
            for handle in (
                handle for subscription in subscribed for handle in (subscription.handle, *subscription.events)
            ):
                held.enter_context(handle)
            while subscribed is self._subscribed and not self._stopped:
                ready = self._wait(wait_set, subscribed)
                serve(topics, [subscription.topic for subscription in subscribed if subscription.address in ready])
                if time.monotonic_ns() >= events_due:
                    events_due = time.monotonic_ns() + _EVENTS_NS
                    self._handle_events(subscribed)

    def _wait(self, wait_set: Any, subscribed: Sequence[_Subscribed]) -> Sequence[int]:
        """Wait for messages; return the addresses of the subscriptions that have some."""
        wait_set.clear_entities()
        for subscription in subscribed:
            wait_set.add_subscription(subscription.handle)
        wait_set.add_guard_condition(self._woken.handle)
        wait_set.wait(_EVENTS_NS)
        ready: Sequence[int] = wait_set.get_ready_entities("subscription")
        return ready

    def _handle_events(self, subscribed: Sequence[_Subscribed]) -> None:
        """Call the callbacks of QoS events that have occurred.

        The callbacks are rclpy's own; they log a warning about a publisher whose QoS or type does not match.
        """
        events = [event for subscription in subscribed for event in subscription.events]
        wait_set = self._wait_set(events=len(events))
        wait_set.clear_entities()
        for event in events:
            event.add_to_wait_set(wait_set)
        wait_set.wait(0)
        for event in events:
            if event.is_ready(wait_set) and (data := event.take_data()):
                event.callback(data)

    def _wait_set(self, subscriptions: int = 0, events: int = 0) -> Any:
        # The numbers are those of subscriptions, guard conditions, timers, clients, services and events.
        return rclpy_implementation.WaitSet(subscriptions, 1, 0, 0, 0, events, self._context.handle)


def _not_called(_: bytes) -> None:
    """Do nothing. rclpy requires a callback for a subscription, but only an executor would call it."""
