"""Thread that takes the serialized messages of rclpy's subscriptions.

rclpy's executor costs 0.2 to 0.3 ms of CPU a message: for each it makes a task and a future, triggers a guard
condition, and builds a wait set with every entity of the node. This thread waits with a wait set that has our
subscriptions only, and takes all messages that have arrived; or it lets the native core do both (`RclLoop`). The
executor serves the rest of the node.

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
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, NamedTuple

from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation

from roverlink.runtime.middleware.protocol import Callback
from roverlink.runtime.middleware.rcl_loop import RclLoop
from roverlink.runtime.middleware.serving import ServedTopic, has_ended, serve
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.lending import LentTopic

_EVENTS_S = 1.0  # time between two looks for QoS events
_WAIT_NS = 1_000_000_000  # longest wait for messages
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


class Subscribed(NamedTuple):
    """rclpy subscription: its handle, the handle's address, the handlers of its QoS events, and its topic."""

    handle: Any
    address: int
    events: Sequence[Any]
    topic: ServedTopic
    close: Callable[[], None]
    """Function that ends the subscription."""
    lend_to: Callable[[NativeCore, LentTopic], None]


class Receiver:
    """Thread that waits for the messages of subscriptions and calls their callbacks, the most urgent topics first.

    Raises AttributeError or TypeError if the internals of rclpy differ from those that this module's docstring lists.
    """

    def __init__(self, node: Any) -> None:
        self._node, self._context = node, node.context
        self._group = _WithoutExecutor()
        self._woken = GuardCondition(callback=None, callback_group=None, context=self._context)
        self._subscribed: tuple[Subscribed, ...] = ()
        # rclpy's subscriptions that the thread has to destroy, and what it then sets
        self._closed: list[tuple[Any, threading.Event]] = []
        self._native: RclLoop | None = None
        self._stopped = False
        self._try_names()
        # The executor's thread looks for QoS events, because this one may be in the native core.
        node.create_timer(_EVENTS_S, self._handle_events, clock=Clock(clock_type=ClockType.STEADY_TIME))
        # Somebody else in the process may shut ROS 2 down; the program ends by its own signal handler.
        self._context.on_shutdown(self.end)
        self._thread = threading.Thread(target=self._receive, name="rclpy-take", daemon=True)
        self._thread.start()

    def subscribe(self, message_class: Any, topic: str, profile: Any, callback: Callback, priority: int) -> Subscribed:
        """Call ``callback`` with the serialized messages of a topic, on the thread of this receiver."""
        subscription = self._node.create_subscription(
            message_class, topic, _not_called, profile, callback_group=self._group, raw=True
        )
        handle = subscription.handle

        def others() -> list[Subscribed]:
            return [subscribed for subscribed in self._subscribed if subscribed.handle is not handle]

        def served(lent: LentTopic) -> ServedTopic:
            lent.struct.subscription = handle.pointer
            return ServedTopic(_Reader(handle, message_class), callback, priority, lent)

        def close() -> None:
            self._subscribed = tuple(others())
            # The thread destroys it, because it may be about to wait for its messages.
            destroyed = threading.Event()
            self._closed.append((subscription, destroyed))
            self._wake()
            # Until then, Fast DDS refuses another subscription of the topic with another message type.
            if threading.current_thread() is not self._thread and self._thread.is_alive():
                destroyed.wait(_DESTROYED_S)

        def lend_to(core: NativeCore, lent: LentTopic) -> None:
            loop = self._native or RclLoop(core)
            topic = served(lent)
            loop.check(lent.struct)
            self._native = loop
            self._set([*others(), subscribed._replace(topic=topic)])

        # The core hands all messages of a topic over that is not lent to it.
        topic_in_python = served(LentTopic(native.Subscription(), _not_called, lambda: None))
        events = subscription.event_handlers
        subscribed = Subscribed(handle, handle.pointer, events, topic_in_python, close, lend_to)
        self._set([*self._subscribed, subscribed])
        return subscribed

    def stop(self) -> bool:
        """End the thread, and wait until it has ended; return false if it hangs. No running callback is interrupted."""
        self.end()
        if not has_ended(self._thread):
            return False
        if self._native is not None:
            self._native.close()
        return True

    def end(self) -> None:
        """Let the thread end when it has handled what it has taken."""
        self._stopped = True
        self._wake()

    def _set(self, subscribed: Sequence[Subscribed]) -> None:
        self._subscribed = tuple(sorted(subscribed, key=lambda one: -one.topic.priority))
        self._wake()

    def _wake(self) -> None:
        self._woken.trigger()
        if self._native is not None:
            self._native.wake()

    def _try_names(self) -> None:
        """Use the internal functions of rclpy once, so that a missing one raises an error at start."""
        rclpy_implementation.Subscription.take_message  # noqa: B018
        self._woken.trigger()
        self._wait(self._wait_set(), ())

    def _receive(self) -> None:
        with self._unless_shut_down():
            while not self._stopped:
                while self._closed:
                    subscription, destroyed = self._closed.pop()
                    self._node.destroy_subscription(subscription)
                    destroyed.set()
                subscribed = self._subscribed
                # A shutdown from outside would destroy the subscriptions while the thread waits for them.
                with _held(subscribed):
                    self._serve(subscribed)

    @contextmanager
    def _unless_shut_down(self) -> Iterator[None]:
        """Suppress errors of a context that was shut down, for which no wait set can be made."""
        try:
            yield
        except rclpy_implementation.RCLError:
            # rclpy's signal handler shuts contexts down without their callbacks.
            if self._context.ok():
                raise

    def _serve(self, subscribed: Sequence[Subscribed]) -> None:
        """Serve the topics in ``subscribed`` until others have to be served, or until the thread has to end."""
        topics = [subscription.topic for subscription in subscribed]

        def is_current() -> bool:
            return subscribed is self._subscribed and not self._closed and not self._stopped

        if self._native is not None:
            self._native.run(topics, is_current)
            return
        wait_set = self._wait_set(subscriptions=len(subscribed))
        while is_current() and self._native is None:
            ready = self._wait(wait_set, subscribed)
            serve(topics, [subscription.topic for subscription in subscribed if subscription.address in ready])

    def _wait(self, wait_set: Any, subscribed: Sequence[Subscribed]) -> Sequence[int]:
        """Wait for messages; return the addresses of the subscriptions that have some."""
        wait_set.clear_entities()
        for subscription in subscribed:
            wait_set.add_subscription(subscription.handle)
        wait_set.add_guard_condition(self._woken.handle)
        wait_set.wait(_WAIT_NS)
        ready: Sequence[int] = wait_set.get_ready_entities("subscription")
        return ready

    def _handle_events(self) -> None:
        """Call the callbacks of QoS events that have occurred.

        The callbacks are rclpy's own; they log a warning about a publisher whose QoS or type does not match.
        """
        subscribed = self._subscribed
        events = [event for subscription in subscribed for event in subscription.events]
        # Another thread may have destroyed a subscription.
        with self._unless_shut_down(), suppress(rclpy_implementation.InvalidHandle), _held(subscribed):
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


@contextmanager
def _held(subscribed: Sequence[Subscribed]) -> Iterator[None]:
    """Keep subscriptions and their events from being destroyed."""
    with ExitStack() as held:
        for subscription in subscribed:
            for handle in (subscription.handle, *subscription.events):
                held.enter_context(handle)
        yield


def _not_called(_: bytes) -> None:
    """Do nothing. rclpy requires a callback for a subscription, but only an executor would call it."""
