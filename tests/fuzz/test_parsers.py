"""No bytes from outside make a parser do anything but read them or refuse them."""

from __future__ import annotations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from targets import TARGETS

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at

_ENVELOPES = [
    REGISTRY.envelope(**{handler.route.name: payload_at(handler.payload_type, 1.0)}).SerializeToString()
    for handler in REGISTRY.handlers
]
_SERIALIZED = [handler.to_cdr(payload_at(handler.payload_type, 1.0)) for handler in REGISTRY.handlers]
_SAMPLES = [bytes([number]) + cdr for number in range(32) for cdr in _SERIALIZED]
_PAYLOADS = [
    bytes([number]) + payload_at(handler.payload_type, 1.0).SerializeToString()
    for number, handler in enumerate(REGISTRY.handlers)
]


@st.composite
def _damaged(draw: st.DrawFn) -> bytes:
    """Something that was whole once: cut, with other bytes, with more behind it."""
    data = bytearray(draw(st.sampled_from(_ENVELOPES + _SAMPLES + _PAYLOADS)))
    for _ in range(draw(st.integers(0, 4))):
        data[draw(st.integers(0, len(data) - 1))] = draw(st.integers(0, 255))
    return bytes(data[: draw(st.integers(0, len(data)))]) + draw(st.binary(max_size=8))


@pytest.mark.parametrize("name", TARGETS)
@given(data=st.binary(max_size=200) | _damaged())
@example(data=b"")
@example(data=b"\x0a\xff\xff\xff\xff\x0f")
@example(data=b"\x6a\xff\xff\x03")
def test_whatever_the_bytes(name: str, data: bytes) -> None:
    """Short ones, damaged ones, and ones that claim to be enormous."""
    TARGETS[name](data)


@pytest.mark.exhaustive
@settings(max_examples=100_000)
@pytest.mark.parametrize("name", TARGETS)
@given(data=_damaged())
def test_many_damaged_bytes(name: str, data: bytes) -> None:
    """As many as some minutes take."""
    TARGETS[name](data)
