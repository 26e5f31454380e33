"""The envelope on the wire: whatever a board does with trailing zeros, the same envelope is restored."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import delimited, envelopes, varint

from generated.registry import REGISTRY
from roverlink.runtime import Translator
from roverlink.runtime.core.envelope import payload_numbers, restore, strip_trailing_zeros

_LARGEST_DATAGRAM = 65_507
_TRANSLATOR = Translator(REGISTRY)
_PADDING = st.integers(0, 300)
_EXAMPLES = settings(max_examples=50)


def _variants(data: bytes, padding: int) -> list[bytes]:
    """An envelope as it is, padded, stripped, stripped before it was padded, and stripped in part."""
    stripped = strip_trailing_zeros(data)
    partly = data[: max(len(stripped), len(data) - padding)]
    return [data, data + bytes(padding), stripped, stripped + bytes(padding), partly]


@pytest.mark.slow
@_EXAMPLES
@given(sent=envelopes(), padding=_PADDING)
def test_any_valid_envelope_is_restored_from_each_variant(sent: bytes, padding: int) -> None:
    """Envelopes with several fields, unknown fields, groups and overlong varints restore to the very same bytes."""
    expected = REGISTRY.envelope.FromString(sent)  # else it is no valid envelope, and the strategy is wrong
    for variant in _variants(sent, padding):
        assert restore(variant) == sent
        assert _TRANSLATOR.parse(variant).SerializeToString() == expected.SerializeToString()


def test_an_empty_payload_loses_its_length_byte() -> None:
    """The length byte is a zero too: `ca 01` stands for `ca 01 00`, an unknown one; zeros alone are no payload."""
    assert restore(bytes.fromhex("ca01")) == bytes.fromhex("ca0100")
    assert payload_numbers(bytes.fromhex("ca01")) == [25]
    assert restore(b"") == restore(bytes(64)) == b""
    for handler in REGISTRY.handlers:
        sent = REGISTRY.envelope(**{handler.route.name: handler.payload_type()}).SerializeToString()
        assert restore(sent[:-1]) == sent
        assert _TRANSLATOR.parse(sent[:-1]).WhichOneof("payload") == handler.route.name


@pytest.mark.parametrize("length", [_LARGEST_DATAGRAM, 2**31 - 1, 2**63])
def test_a_length_that_no_datagram_can_carry_is_not_restored(length: int) -> None:
    """A length from a broken or hostile sender costs no memory: the datagram stays as it is."""
    datagram = varint(13 << 3 | 2) + varint(length) + b"\1"
    assert restore(datagram) == datagram


def test_a_payload_up_to_the_largest_datagram_is_restored() -> None:
    """An envelope that just fits a datagram is restored from its first bytes."""
    sent = delimited(2000, b"\1" + bytes(_LARGEST_DATAGRAM - 6))
    assert len(sent) == _LARGEST_DATAGRAM
    assert restore(strip_trailing_zeros(sent)) == sent
