"""Edges of standard messages: numbers that do not fit, values that two payloads share, and turns."""

from __future__ import annotations

import math
from typing import Any

import pytest

from generated.registry import REGISTRY
from roverlink.runtime import ConversionError
from roverlink.runtime.convert import rotations
from roverlink.runtime.core import cdr

_EXTRA_TOPICS = {handler.route.topic: handler for handler in REGISTRY.extra_topics}


def test_a_number_too_large_for_the_payload_is_refused() -> None:
    """A float64 that no float32 holds does not become infinite on the way to a payload."""
    handler = _EXTRA_TOPICS["pressure/temperature"]
    with pytest.raises(ConversionError, match=r"^pressure_info on pressure/temperature: 3\.40\d+e\+38 is too large"):
        handler.from_cdr(cdr.encode(handler.message_type(temperature=3.4028235677973366e38)))
    assert math.isinf(handler.from_cdr(cdr.encode(handler.message_type(temperature=math.inf))).temperature_c)


def test_a_value_of_two_enum_values_does_not_come_back() -> None:
    """Nobody knows which of the two the board meant; the error names both."""
    handler = _EXTRA_TOPICS["gps/fix"]
    with pytest.raises(ConversionError, match="STATUS_FIX for 'GPS_FIX' and for 'PPS_FIX'"):
        handler.from_cdr(handler.to_cdr(handler.payload_type(fix_quality=1)))


@pytest.mark.parametrize(
    ("angles", "parts"),
    [
        ((math.pi / 2, 0, 0), (math.sqrt(0.5), 0, 0, math.sqrt(0.5))),
        ((0, math.pi / 2, 0), (0, math.sqrt(0.5), 0, math.sqrt(0.5))),
        ((0, 0, math.pi), (0, 0, 1, 0)),
        ((math.pi / 2, 0, math.pi / 2), (0.5, 0.5, 0.5, 0.5)),
    ],
)
def test_quaternions_are_those_of_the_books(angles: Any, parts: Any) -> None:
    """Quarter turns, and one about x followed by one about the fixed z."""
    assert rotations.quaternion(*angles) == pytest.approx(parts, abs=1e-15)
