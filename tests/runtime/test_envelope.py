"""The envelope on the wire: whatever a board does with trailing zeros, the same envelope is restored."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import delimited, envelopes, payload_fields, payloads, unknown_fields, varint

from generated.registry import REGISTRY
from roverlink.runtime import Translator
from roverlink.runtime.core import wire_format
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


@pytest.mark.parametrize("handler", REGISTRY.handlers, ids=lambda handler: handler.route.name)
@settings(max_examples=10)
@given(data=st.data(), padding=_PADDING)
def test_every_payload_is_restored_from_each_variant(handler: Any, data: st.DataObject, padding: int) -> None:
    """For each of the table's payloads and any values, stripped and padded envelopes restore to what was sent."""
    payload = data.draw(payloads(handler.payload_type, sparse=True))
    sent = REGISTRY.envelope(**{handler.route.name: payload}).SerializeToString()
    for variant in _variants(sent, padding):
        assert restore(variant) == sent
        parsed = _TRANSLATOR.parse(variant)
        assert parsed.WhichOneof("payload") == handler.route.name
        assert parsed.SerializeToString() == sent


@_EXAMPLES
@given(sent=envelopes(), padding=_PADDING)
def test_any_valid_envelope_is_restored_from_each_variant(sent: bytes, padding: int) -> None:
    """Envelopes with several fields, unknown fields, groups and overlong varints restore to the very same bytes."""
    expected = REGISTRY.envelope.FromString(sent)  # else it is no valid envelope, and the strategy is wrong
    for variant in _variants(sent, padding):
        assert restore(variant) == sent
        assert _TRANSLATOR.parse(variant).SerializeToString() == expected.SerializeToString()


@_EXAMPLES
@given(sent=envelopes())
def test_stripping_takes_the_trailing_zeros_and_no_byte_more_could_go(sent: bytes) -> None:
    """What is stripped is all zeros, and one byte less would be another envelope."""
    stripped = strip_trailing_zeros(sent)
    assert sent == stripped + bytes(len(sent) - len(stripped))
    assert not stripped.endswith(b"\0")
    if stripped:
        assert restore(stripped[:-1]) != sent


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


@_EXAMPLES
@given(st.one_of(st.binary(max_size=200), st.builds(bytes.__add__, envelopes(), st.binary(max_size=10))))
def test_restoring_takes_any_bytes(data: bytes) -> None:
    """It never raises, only adds or takes zeros at the end, never grows beyond a datagram, and is done in one step."""
    restored = restore(data)
    shorter, longer = sorted([data, restored], key=len)
    assert longer == shorter + bytes(len(longer) - len(shorter))
    assert len(restored) <= max(len(data), _LARGEST_DATAGRAM)
    assert restore(restored) == restored


_HOSTILE = {
    "empty fields": bytes.fromhex("6a00"),
    "one-byte varints": bytes.fromhex("0801"),
    "group starts": bytes.fromhex("0b"),
    "overlong tags": b"\x88" + b"\x80" * 8 + b"\x00",
    "fixed fields": b"\x0d1234",
    "continuation bytes": b"\xff",
    "lengths beyond the end": b"\x6a\xff\x7f",
}


@pytest.mark.parametrize("pattern", _HOSTILE.values(), ids=_HOSTILE.keys())
def test_restoring_reads_each_byte_a_bounded_number_of_times(pattern: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """However it is built, a datagram costs no more varints than it has bytes, and one pass at the end."""
    reads = 0
    read = wire_format.varint

    def counted(data: bytes, position: int) -> tuple[int, int]:
        nonlocal reads
        reads += 1
        return read(data, position)

    monkeypatch.setattr(wire_format, "varint", counted)
    datagram = pattern * (_LARGEST_DATAGRAM // len(pattern))
    restore(datagram)
    assert 0 < reads <= len(datagram) + 1


@_EXAMPLES
@given(st.lists(st.tuples(st.booleans(), st.data()), max_size=5))
def test_payload_numbers_are_those_of_the_delimited_fields(parts: list[tuple[bool, Any]]) -> None:
    """The numbers are found in order, among fields of any other kind."""
    datagram, expected = b"", []
    for is_payload, data in parts:
        field = data.draw(payload_fields() if is_payload else unknown_fields(depth=0))
        datagram += field
        tag, _ = wire_format.varint(field, 0)
        if tag & 7 == 2:
            expected.append(tag >> 3)
    assert payload_numbers(datagram) == expected
