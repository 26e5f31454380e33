"""Functions of rcl, whose library rclpy has loaded, for the native core, and its loop that takes messages with them."""

from __future__ import annotations

import ctypes
import os
import weakref
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any

from roverlink.runtime.middleware.serving import ServedTopic
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.topic_loop import TopicLoop


def rcl_function(name: str) -> Any:
    """Return a function of rcl. Raises AttributeError if this version of rcl lacks it."""
    return getattr(ctypes.CDLL("librcl.so", mode=os.RTLD_NOLOAD), name)


class RclLoop:
    """Loop of the native core that takes the messages of rcl's subscriptions.

    rcl calls a function of the core when a message has arrived, on a thread of the middleware. That function wakes the
    loop by an eventfd.
    """

    def __init__(self, core: NativeCore) -> None:
        """Prepare the loop. Raises AttributeError if this version of rcl lacks a function."""
        take = ctypes.cast(rcl_function("rcl_take_serialized_message"), ctypes.c_void_p)
        self._set_callback = rcl_function("rcl_subscription_set_on_new_message_callback")
        self._set_callback.argtypes = (ctypes.c_void_p,) * 3
        self._arrived = ctypes.cast(core.library.rl_arrived, ctypes.c_void_p)
        self._loop = TopicLoop(core, native.Reading(take_one=take))
        self._wake = os.eventfd(0)
        weakref.finalize(self, os.close, self._wake)  # not before: somebody may still wake an ended loop

    def check(self, topic: native.Subscription) -> None:
        """Raise AttributeError if the ROS 2 middleware does not tell of new messages."""
        if code := self._tell(topic):
            raise AttributeError(f"the ROS 2 middleware does not tell of new messages (error {code})")
        self._set_callback(topic.subscription, None, None)

    def run(self, topics: Sequence[ServedTopic], is_current: Callable[[], bool]) -> None:
        """Serve topics, all of which are lent and the most urgent first, until `wake` is called.

        Returns at once if ``is_current`` returns false: `wake` was called for a change that ``topics`` do not have.
        """
        self._loop.prepare(topics)
        with ExitStack() as told:
            for topic in topics:
                assert topic.lent is not None  # noqa: S101  # the caller lends all
                told.callback(self._set_callback, topic.lent.struct.subscription, None, None)
                self._tell(topic.lent.struct)
            if is_current():
                self._loop.run(self._wake)

    def _tell(self, topic: native.Subscription) -> int:
        topic.arrived, topic.wake = 1, self._wake  # the loop first looks for what has arrived before
        return int(self._set_callback(topic.subscription, self._arrived, ctypes.addressof(topic)))

    def wake(self) -> None:
        """Make `run` return."""
        self._loop.stop()
        os.eventfd_write(self._wake, 1)

    def close(self) -> None:
        """Pass on what observers have not got yet. Call it when `run` has returned for the last time."""
        self._loop.close()
