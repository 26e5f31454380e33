"""The bridge's pure core: datagram bytes to serialized ROS 2 messages and back. No socket, no ROS, no clock."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from google.protobuf.message import DecodeError, EncodeError

from runtime import envelope
from runtime.errors import ConversionError, DatagramError, Reason
from runtime.feed import UNSTAMPED
from runtime.interfaces import Time
from runtime.registry import AnyFeed, AnyHandler, Registry

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


Fed = tuple[AnyFeed, "bytes | ConversionError"]
"""What a further topic gets; a value that does not fit keeps neither the row's own topic nor the others waiting."""


class Translator:
    """Translates by the registry alone; it knows no message."""

    def __init__(self, registry: Registry, peers: frozenset[str] | None = None) -> None:
        """``peers`` are those for which the sender of what is received may speak; None for all."""
        self._registry, self._peers = registry, peers
        self._parse = registry.envelope.FromString
        self._which, self._oneof = registry.envelope.WhichOneof, registry.oneof
        inbound = [handler for handler in registry.handlers if handler.route.inbound]
        self._inbound = {h.route.name: h for h in inbound if peers is None or h.route.peer in peers}
        self._feeds = {name: tuple(f for f in registry.feeds if f.route.name == name) for name in self._inbound}

    def receive(self, datagram: bytes, stamp: Time = UNSTAMPED) -> tuple[str, bytes]:
        """The name of the payload in a datagram from a peer, and the serialized ROS 2 message to publish.

        ``stamp`` is when it was received. Raises `DatagramError` with the reason, and number and name of the payload
        where they are known.
        """
        return self.receive_all(datagram, stamp)[:2]

    def receive_all(self, datagram: bytes, stamp: Time) -> tuple[str, bytes, Sequence[Fed]]:
        """As `receive`, with what the row's further topics get."""
        try:  # as `parse`, whose call would be felt here
            message = self._parse(datagram)
        except DecodeError:
            message = self._parse_restored(datagram)
        name = self._which(message, self._oneof)  # looked up on a message, it would be sought among its fields first
        handler = self._inbound.get(name)
        if handler is None:
            raise self._refusal(name, datagram)
        try:
            payload = getattr(message, name)
            serialized = handler.to_cdr(payload, stamp)
        except ConversionError as error:
            raise DatagramError(Reason.CONVERSION, f"payload {handler.route.number}: {error}", name) from error
        feeds = self._feeds[name]
        return name, serialized, [_fed(feed, payload, stamp) for feed in feeds] if feeds else ()

    def parse(self, datagram: bytes) -> ProtoMessage:
        """The envelope in a datagram, whatever was done to its trailing zeros. Raises `DatagramError`.

        A stripped or padded envelope never parses as it stands, so the ordinary one costs one parse and no more.
        """
        try:
            return self._parse(datagram)
        except DecodeError:
            return self._parse_restored(datagram)

    def _parse_restored(self, datagram: bytes) -> ProtoMessage:
        try:
            return self._parse(envelope.restore(datagram))
        except DecodeError as error:
            start = datagram[:8].hex(" ")
            raise DatagramError(
                Reason.MALFORMED, f"no {self._name} in {len(datagram)} bytes starting {start}"
            ) from error

    def send(self, handler: AnyHandler, cdr: bytes) -> bytes:
        """The datagram for a peer that says what a serialized ROS 2 message says.

        Raises `ConversionError` with route and field where a value does not fit.
        """
        return self.datagram(handler, handler.from_cdr(cdr))

    def datagram(self, handler: AnyHandler, payload: ProtoMessage) -> bytes:
        """The datagram for a peer with a payload. Raises `ConversionError` where a required field is not set."""
        try:
            datagram = self._registry.envelope(**{handler.route.name: payload}).SerializeToString()
        except EncodeError as error:  # a `required` field of proto2 that nothing has set
            raise ConversionError(f"{handler.route.name}: {error}") from error
        if self._registry.peers_by_name[handler.route.peer].strip_trailing_zeros:
            return envelope.strip_trailing_zeros(datagram)
        return datagram

    @property
    def _name(self) -> str:
        return self._registry.envelope.DESCRIPTOR.name

    def _refusal(self, name: str | None, datagram: bytes) -> DatagramError:
        if name is not None:
            return self._refusal_of_known(name)
        numbers = envelope.payload_numbers(envelope.restore(datagram))
        if not numbers:
            return DatagramError(Reason.EMPTY, f"an empty {self._name} ({len(datagram)} bytes)")
        number = numbers[-1]
        retired = self._registry.retired.get(number)
        explained = f"{number} (retired: {retired})" if retired else str(number)
        return DatagramError(Reason.UNKNOWN_PAYLOAD, f"no handler for payload {explained}")

    def _refusal_of_known(self, name: str) -> DatagramError:
        """Why a payload that the envelope knows is not bridged."""
        number = self._registry.envelope.DESCRIPTOR.fields_by_name[name].number
        handler = self._registry.by_name.get(name)
        if handler is None:
            return DatagramError(Reason.UNKNOWN_PAYLOAD, f"no handler for payload {number} ({name})")
        if handler.route.inbound:
            speakers = ", ".join(sorted(self._peers or ()))
            return DatagramError(
                Reason.WRONG_SOURCE, f"{name} ({number}) is of {handler.route.peer}, not of {speakers}"
            )
        return DatagramError(
            Reason.WRONG_DIRECTION, f"{name} ({number}) goes {handler.route.direction}, but came from a peer", name
        )


def _fed(feed: AnyFeed, payload: ProtoMessage, stamp: Time) -> Fed:
    try:
        return feed, feed.to_cdr(payload, stamp)
    except ConversionError as error:
        return feed, error
