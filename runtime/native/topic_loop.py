"""Serving of subscribed topics by the native core: from topics to peers without Python, in the order of priorities."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Protocol

from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore
from roverlink.runtime.native.lending import LentTopic
from roverlink.runtime.native.observer_ring import ObserverRing
from roverlink.runtime.native.python_calls import PythonCalls


class Topic(Protocol):
    """Subscribed topic of a middleware."""

    @property
    def callback(self) -> Callable[[Sequence[bytes]], None]:
        """Function that gets the messages that the core has taken but cannot convert."""

    @property
    def priority(self) -> int:
        """Priority; topics with larger numbers are served first."""

    @property
    def lent(self) -> LentTopic | None:
        """The topic as the core serves it; None if Python takes its messages."""

    def serve(self, most: int) -> None:
        """Take at most ``most`` messages in Python, and handle them."""


class TopicLoop:
    """Loop of the native core that takes the messages of topics."""

    def __init__(self, core: NativeCore, reading: native.Reading) -> None:
        """Take messages with the functions ``reading`` of the middleware."""
        self._core, self._reading = core, reading
        self._workspace, self._direct_workspace = core.new_workspace(self), core.new_workspace(self)
        self._topics: Sequence[Topic] = ()
        self._python = PythonCalls()
        guarded = self._python.guarded
        self._calls = native.ServingCalls(
            native.Serve(lambda index, most: guarded(self._topics[index].serve, most)),
            native.Pass(lambda index, one: guarded(self._topics[index].callback, [native.bytes_of(one[0])])),
            native.OfTopic(lambda index: self._python.unobserved(self._wait, index)),
            native.Pass(lambda index, one: guarded(self._send, index, native.bytes_of(one[0]))),
        )
        self._server = native.Server()

    def prepare(self, topics: Sequence[Topic]) -> Sequence[bool]:
        """Serve these topics at the next `run`, the most urgent first.

        Returns which of them the core serves without the wait set of `run`, if the middleware has listeners: those of
        which nothing is signed, limited or observed.
        """
        structs = (ctypes.POINTER(native.Subscription) * len(topics))()
        for index, topic in enumerate(topics):
            if topic.lent is not None:
                structs[index] = ctypes.pointer(topic.lent.struct)
        self._topics = topics
        self.close()
        taps: dict[int, Sequence[Tap]] = {}
        for index, topic in enumerate(topics):
            if (lent := topic.lent) is not None:
                lent.struct.observed = bool(lent.taps) + 2 * bool(lent.datagram_taps)
                plain = not (lent.struct.observed or lent.struct.signer or lent.struct.pacer)
                lent.struct.is_direct = plain and self._reading.new_listener is not None
                taps |= {2 * index: lent.taps, 2 * index + 1: lent.datagram_taps}
        if any(taps.values()):
            self._python.ring = ObserverRing(self._core, taps, "observe-topics").__enter__()
        self._server = native.Server(
            table=ctypes.pointer(self._core.table),
            workspace=self._workspace,
            topics=structs,
            priorities=(ctypes.c_int32 * len(topics))(*(topic.priority for topic in topics)),
            reading=self._reading,
            calls=self._calls,
            observers=ctypes.pointer(self._python.ring.struct) if self._python.ring is not None else None,
            direct_workspace=self._direct_workspace,
            n_topics=len(topics),
        )
        return [topic.lent is not None and bool(topic.lent.struct.is_direct) for topic in topics]

    def run(self, waitset: int, wake: int = 0) -> None:
        """Serve the topics until `stop` is called. Raises what a callback raised, or `MiddlewareError`.

        ``waitset`` is a wait set of Cyclone DDS, triggered with the index of a topic, or with -1 by the guard condition
        ``wake``. With rcl, it is an eventfd.
        """
        self._server.waitset, self._server.wake = waitset, wake
        if self._core.library.rl_serve(ctypes.byref(self._server)):
            raise self._python.failure or MiddlewareError("the native core cannot wait for messages")

    def stop(self) -> None:
        """Make `run` return after the wait set was triggered. Undone by `prepare`."""
        self._server.stopping = True

    def close(self) -> None:
        """Pass on what observers have not got yet. The next `prepare` undoes it."""
        if self._python.ring is not None:
            self._python.ring.__exit__()
            self._python.ring = None

    def _wait(self, index: int) -> None:
        lent = self._topics[index].lent
        if lent is not None:
            lent.wait()

    def _send(self, index: int, datagram: bytes) -> None:
        lent = self._topics[index].lent
        if lent is not None:
            lent.send(datagram)
