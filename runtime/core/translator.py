"""Dispatches datagrams to handlers: bytes to serialized ROS 2 messages, and back. No socket, no ROS, no clock."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from google.protobuf.message import DecodeError, EncodeError

from roverlink.runtime.core import envelope
from roverlink.runtime.core.errors import ConversionError, DatagramError, Reason
from roverlink.runtime.core.handler import UNSTAMPED, Serialized
from roverlink.runtime.core.registry import AnyFeed, AnyHandler, Registry
from roverlink.runtime.interfaces import Time

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


@dataclass(slots=True)
class Translation:
    """What became of a batch of datagrams."""

    names: list[str | None]
    """The payload of each datagram; None where it was refused."""
    messages: dict[str, list[bytes]] = field(default_factory=dict)
    """The serialized messages of each row, by the name of its payload."""
    fed: list[tuple[AnyFeed, Serialized]] = field(default_factory=list)
    """What the rows' further topics get; a value that does not fit one of them keeps no other topic waiting."""
    refusals: list[DatagramError] = field(default_factory=list)


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
        translation = self.receive_all([datagram], stamp)
        for refusal in translation.refusals:
            raise refusal
        ((name, (message,)),) = translation.messages.items()
        return name, message

    def receive_all(self, datagrams: Sequence[bytes], stamp: Time) -> Translation:
        """As `receive`, of datagrams that were received together.

        Those with the same payload are converted in one go: what is done once a batch is not done for each of them.
        """
        translation = Translation([])
        payloads = self._sort(datagrams, translation)
        for name, run in payloads.items():
            messages, misfits = self._inbound[name].all_to_cdr(run, stamp)
            if misfits:
                self._refuse(name, misfits, translation)
                run = [payload for index, payload in enumerate(run) if index not in misfits]
            if run:
                translation.messages[name] = messages
                translation.fed += [(feed, feed.all_to_cdr(run, stamp)) for feed in self._feeds[name]]
        return translation

    def _sort(self, datagrams: Sequence[bytes], translation: Translation) -> dict[str, list[ProtoMessage]]:
        """The payloads that are bridged, by their names; the names and the refusals go into the translation."""
        payloads: defaultdict[str, list[ProtoMessage]] = defaultdict(list)
        names = translation.names
        for datagram in datagrams:
            try:
                name, payload = self._parsed(datagram)
            except DatagramError as error:
                translation.refusals.append(error)
                names.append(None)
            else:
                payloads[name].append(payload)
                names.append(name)
        return payloads

    def _parsed(self, datagram: bytes) -> tuple[str, ProtoMessage]:
        """The name of a payload that is bridged, and the payload. Raises `DatagramError` for any other."""
        message = self.parse(datagram)
        name = self._which(message, self._oneof)  # looked up on a message, it would be sought among its fields first
        if name not in self._inbound:
            raise self._refusal(name, datagram)
        return name, getattr(message, name)

    def _refuse(self, name: str, misfits: Mapping[int, ConversionError], translation: Translation) -> None:
        """Take note of payloads that cannot be converted, by their places among those of their name."""
        places = [place for place, other in enumerate(translation.names) if other == name]
        number = self._inbound[name].route.number
        for index, error in misfits.items():
            translation.names[places[index]] = None
            refusal = DatagramError(Reason.CONVERSION, f"payload {number}: {error}", name)
            refusal.__cause__ = error
            translation.refusals.append(refusal)

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
