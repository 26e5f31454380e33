"""Translator of datagrams to serialized ROS 2 messages, and back. It uses no socket, no ROS and no clock."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from google.protobuf.message import DecodeError

from roverlink.numerals import counted
from roverlink.runtime.core import envelope, link_message
from roverlink.runtime.core.errors import ConversionError, DatagramError, Reason
from roverlink.runtime.core.handler import UNSTAMPED, Stamps, all_to_cdr
from roverlink.runtime.core.principals import Origin, Principal, Speakers
from roverlink.runtime.core.registry import AnyHandler, AnyStandardHandler, Registry
from roverlink.runtime.core.signing import Verifier
from roverlink.runtime.interfaces import Time

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage


@dataclass(slots=True)
class Translation:
    """Result of translating a batch of datagrams to ROS 2 messages."""

    names: list[str | None]
    """Payload name of each datagram, in the order of the batch; None if the datagram was refused."""
    messages: dict[str, list[bytes]] = field(default_factory=dict)
    """Serialized ROS 2 messages of each row, by payload name."""
    extra_topics: list[tuple[AnyStandardHandler, Sequence[ProtoMessage]]] = field(default_factory=list)
    """Handler of each extra topic, with the payloads to publish there.

    The payloads are not converted yet, because a topic without subscribers needs no conversion.
    """
    refusals: list[DatagramError] = field(default_factory=list)
    """Error of each refused datagram."""
    restored: dict[bytes, bytes] = field(default_factory=dict)
    """Envelope in each datagram that had appended or stripped zeros, by the datagram."""
    links: Sequence[tuple[Principal, ProtoMessage]] = ()
    """Link messages in the batch, in order, each with its sender. Each has the name ``link`` in `names`."""


class Translator:
    """Translator between datagrams and serialized ROS 2 messages.

    It uses the handlers of a registry, and contains no code for particular messages.
    """

    def __init__(self, registry: Registry, origin: Origin | None = None) -> None:
        """Accept only the payloads that may have an origin; None accepts all payloads."""
        self._registry, self._origin = registry, origin
        self._parse = registry.envelope.FromString
        # Looked up once: both are called for every datagram. See `_parsed` for why this is the class's method.
        self._which, self._oneof = registry.envelope.WhichOneof, registry.oneof
        inbound = [handler for handler in registry.handlers if handler.route.inbound]
        self._inbound = {
            h.route.name: h for h in inbound if origin is None or origin.may_carry(h.route.peer, h.route.board)
        }
        self._extra_topics = {
            name: tuple(f for f in registry.extra_topics if f.route.name == name) for name in self._inbound
        }
        self._link = "" if registry.link is None else link_message.NAME
        self._speakers = Speakers(registry, origin)
        self.refuse(frozenset())

    def refuse(self, rows: frozenset[str]) -> None:
        """Refuse the payloads of some rows from now on, because the peer has another schema of them.

        ``rows`` are the names of all rows to refuse. Safe to call from any thread.
        """
        self._refused = rows
        self._accepted = self._inbound.keys() - rows

    def receive(self, datagram: bytes, stamp: Time = UNSTAMPED) -> tuple[str, bytes]:
        """Return the payload name of a peer's datagram, and its serialized ROS 2 message.

        ``stamp`` is the receive time. Raises `DatagramError` with the reason; its text has number and name of the
        payload if these are known.
        """
        translation = self.receive_all([datagram], stamp)
        for refusal in translation.refusals:
            raise refusal
        for _ in translation.links:
            raise DatagramError(Reason.UNKNOWN_PAYLOAD, "a link message, which has no topic")
        ((name, (message,)),) = translation.messages.items()
        return name, message

    def receive_all(self, datagrams: Sequence[bytes], stamp: Stamps) -> Translation:
        """Translate a batch of datagrams; collect the errors in the result instead of raising them.

        Datagrams with the same payload type are converted together, because a part of the work is then done once per
        batch.
        """
        translation = Translation([])
        payloads = self._sort(datagrams, translation)
        if self._link in payloads:
            translation.links = payloads.pop(self._link)
        # Datagrams keep their order within a row, which is all that a topic promises. Between rows nobody can rely on
        # it: each topic has its own writer.
        for name, run in payloads.items():
            messages, misfits = all_to_cdr(self._inbound[name], run, stamp)
            if misfits:
                self._refuse(name, misfits, translation)
                run = [payload for index, payload in enumerate(run) if index not in misfits]
            if run:
                translation.messages[name] = messages
                translation.extra_topics += [(handler, run) for handler in self._extra_topics[name]]
        return translation

    def _sort(self, datagrams: Sequence[bytes], translation: Translation) -> dict[str, list[Any]]:
        """Parse datagrams and return their payloads, grouped by payload name. A link message comes with its sender.

        The name of each datagram and the errors of refused ones are added to ``translation``.
        """
        payloads: defaultdict[str, list[Any]] = defaultdict(list)
        names = translation.names
        for datagram in datagrams:
            try:
                name, payload = self._parsed(datagram, translation.restored)
            except DatagramError as error:
                translation.refusals.append(error)
                names.append(None)
            else:
                payloads[name].append(payload)
                names.append(name)
        return payloads

    def _parsed(self, datagram: bytes, restored: dict[bytes, bytes]) -> tuple[str, Any]:
        """Return name and payload of a datagram. Raises `DatagramError` if the table does not bridge the payload.

        The payload of a link message is a pair of its sender and the message. If trailing zeros were stripped or
        appended, the envelope is added to ``restored``.
        """
        try:
            message = self._parse(datagram)
        except DecodeError:
            restored[datagram] = envelope.restore(datagram)
            message = self._parse_restored(datagram, restored[datagram])
        name = self._which(message, self._oneof)  # the class's method: a field could have the same name
        if name in self._accepted:
            return name, getattr(message, name)
        if name is None or name != self._link:
            raise self._refusal(name, datagram)
        link: Any = getattr(message, name)
        handlers = self._registry.by_number
        listed = {handlers[number].route.name for number in link.numbers if number in handlers}
        return name, (self._principal(datagram, listed), link)

    def _principal(self, datagram: bytes, rows: AbstractSet[str]) -> Principal:  # noqa: ARG002  # a subclass reads it
        """Return who has sent a link message with some rows. Raises `DatagramError` if the rows are those of others."""
        principal = self._speakers.unsigned
        if self._origin is not None and not self._speakers.may_speak(principal, rows):
            raise self._rows_of_others()
        return principal

    def _rows_of_others(self) -> DatagramError:
        message = f"a link message with rows of other peers has come from {self._origin}"
        return DatagramError(Reason.WRONG_SOURCE, message)

    def _refuse(self, name: str, misfits: Mapping[int, ConversionError], translation: Translation) -> None:
        """Add the errors of payloads that cannot be converted to ``translation``.

        ``misfits`` holds each error by the payload's index; the index counts only the payloads with this name.
        """
        places = [place for place, other in enumerate(translation.names) if other == name]
        number = self._inbound[name].route.number
        for index, error in misfits.items():
            translation.names[places[index]] = None
            refusal = DatagramError(Reason.CONVERSION, f"payload {number}: {error}", name)
            refusal.__cause__ = error
            translation.refusals.append(refusal)

    def parse(self, datagram: bytes) -> ProtoMessage:
        """Parse the envelope in a datagram, even if trailing zeros were stripped or appended.

        Raises `DatagramError` if the datagram is not an envelope. An envelope with stripped or appended zeros never
        parses, so the zeros are restored only after a parse has failed. A normal envelope is parsed only once.
        """
        try:
            return self._parse(datagram)
        except DecodeError:
            return self._parse_restored(datagram, envelope.restore(datagram))

    def _parse_restored(self, datagram: bytes, restored: bytes) -> ProtoMessage:
        try:
            return self._parse(restored)
        except DecodeError as error:
            size, start = counted(len(datagram), "byte"), datagram[:8].hex(" ")
            raise DatagramError(Reason.MALFORMED, f"not a valid {self._name}: {size} starting with {start}") from error

    def payload(self, datagram: bytes) -> tuple[int, ProtoMessage]:
        """Return number and payload of a datagram, for programs other than the bridge.

        Every payload that the envelope declares is accepted, whatever its direction, and without a row as well. Raises
        `DatagramError` if the datagram is malformed, or has no payload or an unknown one.
        """
        message = self.parse(datagram)
        name = self._which(message, self._oneof)
        if name is None:
            raise self._refusal(None, datagram)
        return message.DESCRIPTOR.fields_by_name[name].number, getattr(message, name)

    def send(self, handler: AnyHandler, cdr: bytes) -> bytes:
        """Return the datagram for the peer that carries a serialized ROS 2 message; the caller sends the datagram.

        Raises `ConversionError` that names row and field if a value does not fit.
        """
        return self.datagram(handler, handler.from_cdr(cdr))

    def datagram(self, handler: AnyHandler, payload: ProtoMessage) -> bytes:
        """Return the datagram with a payload: the serialized envelope, without trailing zeros if the peer wants it so.

        Raises `ConversionError` if a field that proto2 requires is not set.
        """
        datagram = self._registry.datagram(handler.route.name, payload)
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
            return DatagramError(Reason.EMPTY, f"the {self._name} has no payload ({counted(len(datagram), 'byte')})")
        # With several members on the wire, the last one wins (protobuf encoding, "Last One Wins").
        number = numbers[-1]
        retired = self._registry.retired.get(number)
        explained = f"{number} (retired: {retired})" if retired else str(number)
        return DatagramError(Reason.UNKNOWN_PAYLOAD, f"no row of the table has payload {explained}")

    def _refusal_of_known(self, name: str) -> DatagramError:
        """Return the error for a datagram whose payload the envelope declares, but this translator does not accept."""
        number = self._registry.envelope.DESCRIPTOR.fields_by_name[name].number
        handler = self._registry.by_name.get(name)
        if handler is None:
            return DatagramError(
                Reason.UNKNOWN_PAYLOAD,
                f"no handler for payload {number} ({name!r}): the table does not bridge this payload",
            )
        if name in self._refused and name in self._inbound:
            return DatagramError(
                Reason.OTHER_SCHEMA, f"{name!r} ({number}): {handler.route.peer} has another schema of it", name
            )
        # Known and inbound, yet not accepted: this sender is somebody else.
        if handler.route.inbound:
            return DatagramError(
                Reason.WRONG_SOURCE,
                f"{name!r} ({number}) belongs to the peer {handler.route.peer!r}, but came from {self._origin}",
            )
        return DatagramError(
            Reason.WRONG_DIRECTION,
            f"{name!r} ({number}) is a message to a peer ({handler.route.direction}), but came from a peer",
            name,
        )


class VerifyingTranslator(Translator):
    """Translator that refuses a payload of a peer that must sign, unless its datagram has a valid signature.

    The payloads of other peers cost one lookup more.
    """

    def __init__(self, registry: Registry, verifier: Verifier, origin: Origin | None = None) -> None:
        """Accept only the payloads that may have an origin; None accepts all payloads."""
        super().__init__(registry, origin)
        self._verifier = verifier
        must_sign = {peer.name for peer in registry.peers if peer.must_sign}
        routes = [handler.route for handler in registry.handlers if handler.route.peer in must_sign]
        self._senders = {route.name: frozenset((route.peer, route.board)) for route in routes}
        self._speakers = Speakers(registry, origin, must_sign)

    def _parsed(self, datagram: bytes, restored: dict[bytes, bytes]) -> tuple[str, Any]:
        # After parsing, because only the payload tells whose signature is needed: no address can be trusted.
        try:
            name, payload = super()._parsed(datagram, restored)
        except DatagramError as refusal:
            if refusal.row in self._senders:  # such a refusal counts as a datagram of the peer: it must be the peer's
                self._verifier.verify(datagram, self._senders[refusal.row], refusal.row)
            raise
        if name in self._senders:
            self._verifier.verify(datagram, self._senders[name], name)
        return name, payload

    def _principal(self, datagram: bytes, rows: AbstractSet[str]) -> Principal:
        try:
            principal = self._speakers.signed[self._verifier.verify(datagram, self._speakers.signed)]
        except DatagramError as error:
            # A peer that need not sign may sign all the same, with a key that we do not have.
            proves_nothing = error.reason in (Reason.UNSIGNED, Reason.UNKNOWN_KEY)
            if proves_nothing and self._speakers.may_speak(self._speakers.unsigned, rows):
                return self._speakers.unsigned
            raise
        if self._speakers.may_speak(principal, rows):
            return principal
        if not principal.ends:
            raise self._rows_of_others()
        signer = principal.signer
        raise DatagramError(Reason.WRONG_KEY, f"the key of {signer} has signed a link message with rows of others")
