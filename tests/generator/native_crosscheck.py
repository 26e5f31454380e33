"""The part of `crosscheck` about the native core: what it translates and refuses is what the Python handlers do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any, TypeVar

from google.protobuf.message import Message as Payload

from roverlink.runtime import ConversionError, Registry
from roverlink.runtime.core.handler import UNSTAMPED
from roverlink.runtime.interfaces import Time
from roverlink.runtime.native.core import LIBRARY, open_core

T = TypeVar("T")


class NativeCheck:
    """Comparison of the native core with the handlers of a registry. It does nothing without the library."""

    def __init__(self, registry: Registry) -> None:
        self._core = open_core(registry) if LIBRARY.is_file() else None
        self._translated: Counter[tuple[Any, str]] = Counter()
        self._handed_over: Counter[tuple[Any, str]] = Counter()

    def to_cdr(self, handler: Any, payload: Payload, stamp: Time = UNSTAMPED) -> None:
        """Raise `AssertionError` if the core makes another message than the handler, or accepts what that refuses."""
        if self._core is not None:
            found = self._core.to_cdr(handler, payload.SerializePartialToString(), stamp)
            self._compare(handler, "to_cdr", found, lambda: handler.to_cdr(payload, stamp))

    def to_proto(self, handler: Any, message: bytes) -> None:
        """Raise `AssertionError` if the core makes another payload than the handler, or accepts what that refuses."""
        if self._core is not None:
            found = self._core.to_proto(handler, message)
            payload = None if found is None else handler.payload_type.FromString(found)
            expected = self._compare(handler, "to_proto", payload, lambda: handler.from_cdr(message))
            assert found is None or len(found) == expected.ByteSize(), (found, expected)

    def _compare(self, handler: Any, direction: str, found: T | None, convert: Callable[[], T]) -> T | None:
        try:
            expected = convert()
        except ConversionError:
            expected = None
        if expected is None:
            assert found is None, (direction, handler.route, found)
            return None
        (self._translated if found is not None else self._handed_over)[handler, direction] += 1
        assert found in (None, expected), (direction, handler.route, found, expected)
        return expected

    def finish(self) -> None:
        """Raise `AssertionError` if the core never translated a row that it says it can translate, or else did."""
        for handler, direction in {*self._translated, *self._handed_over}:
            assert self._core is not None
            reason = self._core.reason(handler)
            # The rover's bridge stamps by the clock of a board; at the other end of the link, the core stamps.
            if handler.board_stamp is None:
                assert bool(self._translated[handler, direction]) != bool(reason), (direction, handler.route, reason)
