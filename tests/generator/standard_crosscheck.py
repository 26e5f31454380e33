"""The part of `crosscheck` about standard messages: by rosbags' definitions of them, and by `standard_values`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import standard_values
from hypothesis import given
from hypothesis import strategies as st
from native_crosscheck import NativeCheck
from random_payloads import Payloads
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from roverlink.generator.ir import StandardTopic
from roverlink.generator.ir.model import Bridge
from roverlink.runtime import ConversionError, Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import Time

Plain = Callable[[Any, Typestore], Any]

_REFUSALS = ("is not among the values", "out of range", "infinity", "is too large for float32")
"""Why a number that float64 holds, or an enum's default, may not come back."""


def check_standard_topics(registry: Registry, bridge: Bridge, plain: Plain, native: NativeCheck, jazzy: bool) -> None:
    """Raise `AssertionError` where a standard does something else than the IR and rosbags."""
    distributions = [Stores.ROS2_JAZZY] if jazzy else [Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY]
    meant = {(route.number, standard.topic): standard for route in bridge.routes for standard in route.standard_topics}
    for handler in (*registry.handlers, *registry.extra_topics):
        if standard := meant.pop((handler.route.number, handler.route.topic), None):
            for store in map(get_typestore, distributions):
                _check_standard_topic(handler, standard, store, plain, native)
    assert not meant


def _check_standard_topic(
    handler: Any, standard: StandardTopic, store: Typestore, plain: Plain, native: NativeCheck
) -> None:
    @given(Payloads([]).of(handler.payload_type.DESCRIPTOR), st.integers(0, 2**31 - 1), st.integers(0, 10**9 - 1))
    def both_ways(payload: Any, sec: int, nanosec: int) -> None:
        stamp = Time(sec, nanosec)
        native.to_cdr(handler, payload, stamp)
        wanted = standard_values.values(standard, payload, stamp)
        try:
            serialized = handler.to_cdr(payload, stamp)
        except ConversionError:
            assert not standard_values.fits(wanted)
            return
        assert standard_values.fits(wanted)
        assert cdr.encode(handler.to_ros(payload, stamp)) == serialized
        theirs = store.deserialize_cdr(serialized, standard.message)
        assert bytes(store.serialize_cdr(theirs, standard.message)) == serialized
        assert standard_values.equal(plain(theirs, store), wanted)
        if standard.recovered:
            native.to_proto(handler, serialized)
            _check_way_back(handler, standard, serialized, wanted, stamp)

    both_ways()


def _check_way_back(handler: Any, standard: StandardTopic, serialized: bytes, wanted: Any, stamp: Time) -> None:
    """What comes back says the same once more; what does not fit, as a number that only float64 holds, is refused."""
    try:
        back = handler.from_cdr(serialized)
    except ConversionError as error:
        if not any(why in str(error) for why in _REFUSALS):
            raise
        return
    again = standard_values.values(standard, back, stamp)
    told = {recovered.path[0] for recovered in standard.recovered}
    kept = {name: part for name, part in again.items() if name in told}
    assert standard_values.equal(wanted, kept, 1e-6), (wanted, kept)
