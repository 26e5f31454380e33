"""Interfaces by which a middleware lends topics to the native core, which then needs no Python for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

from roverlink.runtime.core.tap import Tap
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore


@runtime_checkable
class NativePublisher(Protocol):
    """Publisher through which the native core can publish without Python. It must outlive the core's thread."""

    def lend_to(self, topic: native.Topic, functions: native.MiddlewareFunctions) -> Sequence[Tap]:
        """Set what the core needs to publish on the topic: a part of ``topic``, and functions of the middleware.

        Returns the functions that get a copy of each message. Raises AttributeError if the middleware's library lacks
        one of the functions.
        """


class LentTopic(NamedTuple):
    """Topic whose messages the native core takes and sends."""

    struct: native.Subscription
    send: Callable[[bytes], None]
    """Function that sends a datagram that the core could not send."""
    wait: Callable[[], None]
    """Function that is called when a message waits for its time."""
    taps: Sequence[Tap] = ()
    """Functions that get a copy of each message."""
    datagram_taps: Sequence[Tap] = ()
    """Functions that get a copy of each datagram."""


@runtime_checkable
class NativeSubscription(Protocol):
    """Subscription whose messages the native core can take without Python."""

    def has_publishers(self) -> bool:
        """Return true if the middleware knows a publisher of the topic."""

    def close(self) -> None:
        """End the subscription."""

    def lend_to(self, core: NativeCore, lent: LentTopic) -> None:
        """Let the core take the messages from now on. It hands those that it cannot convert to the callback.

        Raises AttributeError if the middleware's library lacks a function.
        """
