"""The parsers that take bytes from outside, each as a function that fails only where the parser has a fault."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

from generated.registry import REGISTRY
from roverlink.runtime import ConversionError, DatagramError, Translator
from roverlink.runtime.core import cdr
from roverlink.runtime.core.envelope import payload_numbers, restore, strip_trailing_zeros
from roverlink.runtime.core.handler import UNSTAMPED
from roverlink.runtime.core.messages import Message
from roverlink.runtime.native.core import LIBRARY, open_core

_TRANSLATOR = Translator(REGISTRY)
_CORE = open_core(REGISTRY) if LIBRARY.is_file() else None
_ROWS = (*REGISTRY.handlers, *REGISTRY.extra_topics)
_OUTBOUND = [handler for handler in REGISTRY.handlers if not handler.route.inbound]
_MESSAGES: list[type[Message]] = sorted({h.message_type for h in REGISTRY.handlers}, key=lambda one: one.__msgtype__)


def datagram(data: bytes) -> None:
    """A datagram from a peer, or from anybody: published as a message that reads back, or refused with a reason."""
    with contextlib.suppress(DatagramError):
        name, message = _TRANSLATOR.receive(data)
        cdr.decode(REGISTRY.by_name[name].message_type, message)


def trailing_zeros(data: bytes) -> None:
    """What restores an envelope: idempotent, blind to padding and stripping, never longer than a datagram can be."""
    restored = restore(data)
    assert restore(restored) == restored
    assert len(restored) <= max(len(data), 65_507)
    payload_numbers(restored)
    with contextlib.suppress(DatagramError):
        envelope = _TRANSLATOR.parse(data)
        plain = envelope.SerializeToString(deterministic=True)
        assert _TRANSLATOR.parse(strip_trailing_zeros(plain)) == _TRANSLATOR.parse(plain + bytes(7))


def sample(data: bytes) -> None:
    """A serialized message from anybody on the ROS 2 domain, on any topic that is sent to a peer."""
    if data:
        handler = _OUTBOUND[data[0] % len(_OUTBOUND)]
        with contextlib.suppress(ConversionError):
            _TRANSLATOR.send(handler, data[1:])


def message(data: bytes) -> None:
    """The CDR codec: what it decodes, it encodes to what it decodes to the same."""
    if data:
        kind = _MESSAGES[data[0] % len(_MESSAGES)]
        with contextlib.suppress(ConversionError):
            encoded = cdr.encode(cdr.decode(kind, data[1:]))
            assert cdr.encode(cdr.decode(kind, encoded)) == encoded


def native_payload(data: bytes) -> None:
    """The native core and a payload: it makes the handler's message of it, or leaves it to Python."""
    if data and _CORE is not None:
        handler = _ROWS[data[0] % len(_ROWS)]
        found = _CORE.to_cdr(handler, data[1:], UNSTAMPED)
        assert found is None or found == handler.to_cdr(handler.payload_type.FromString(data[1:]))


def native_message(data: bytes) -> None:
    """The native core and a serialized message: it makes the handler's payload of it, or leaves it to Python."""
    if data and _CORE is not None:
        handler = _ROWS[data[0] % len(_ROWS)]
        found = _CORE.to_proto(handler, data[1:])
        if found is not None:  # as bytes, in which a NaN is like another one
            payload = handler.payload_type.FromString(found)
            assert payload.SerializeToString() == handler.from_cdr(data[1:]).SerializeToString()


TARGETS: dict[str, Callable[[bytes], None]] = {
    "datagram": datagram,
    "trailing-zeros": trailing_zeros,
    "sample": sample,
    "message": message,
    "native-payload": native_payload,
    "native-message": native_message,
}
