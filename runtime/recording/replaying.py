"""Replay of a recording: selects messages, and converts them to the schema of the current table ("today")."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from roverlink.runtime.core import envelope
from roverlink.runtime.core.errors import ConversionError, DatagramError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.registry import AnyHandler, Registry
from roverlink.runtime.core.translator import Translator
from roverlink.runtime.recording.adapting import Adapter
from roverlink.runtime.recording.mcap_file import Channel
from roverlink.runtime.recording.message_definitions import definition_of, message_type_from
from roverlink.runtime.recording.reader import Recorded, Recording
from roverlink.runtime.recording.schemas import message_type_from as proto_type_from

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

RECEIVED = "/datagrams/received"
SENT = "/datagrams/sent/"


class Timed(NamedTuple):
    """Message to replay: steady time in nanoseconds since 1970, topic (empty for the bridge's UDP port), bytes."""

    time: int
    topic: str
    data: bytes


class Endpoint(NamedTuple):
    """Message type and QoS of a topic on which a replay publishes."""

    message_type: type[Message]
    qos: Qos


class _Replay:
    """Base class of `BoardReplay` and `RosReplay`. It counts the messages that cannot be replayed."""

    def __init__(self, recording: Recording, registry: Registry) -> None:
        self._recording, self._registry = recording, registry
        self._channels = {topic: channel for topic, (channel, count) in recording.channels().items() if count}
        self.adapter = Adapter(_envelope(self._channels.values()) or registry.envelope, registry)
        self.refused: Counter[str] = Counter()
        """Number of messages that were not replayed, by reason."""

    @property
    def notes(self) -> list[str]:
        """Texts for the user about messages that are not replayed exactly as they were recorded."""
        changed = self.adapter.changed
        return [f"converted to the present table, field by field: {', '.join(changed)}"] if changed else []


def _envelope(channels: Iterable[Channel]) -> type[ProtoMessage] | None:
    explained = next((channel for channel in channels if channel.schema_encoding == "protobuf"), None)
    return None if explained is None else proto_type_from(explained.schema_name, explained.schema)


class BoardReplay(_Replay):
    """Replay in the role of the boards: the datagrams that the bridge received are sent to a bridge again."""

    def __init__(self, recording: Recording, registry: Registry, peer: str | None = None) -> None:
        """Select the payloads of one peer, or with None all datagrams. Raises `SetupError` for an unknown peer."""
        super().__init__(recording, registry)
        self._peer = registry.peer(peer).name if peer else None

    def messages(self, since: int = 0) -> Iterator[Timed]:
        """Yield the received datagrams, converted to the current schema. If it has not changed, the bytes are kept.

        ``since`` is the time of the first one, in nanoseconds since 1970.
        """
        for recorded in self._recording.messages(since):
            if not recorded.channel.topic.startswith(RECEIVED):
                continue
            try:
                datagram = self.adapter.adapt(recorded.data)
            except DatagramError as error:
                self.refused[str(error)] += 1
                continue
            if self._peer in (None, *self._peers_of(datagram)):
                yield Timed(recorded.time, "", datagram)

    def _peers_of(self, datagram: bytes) -> Iterator[str]:
        """Yield the peers that a datagram belongs to; none for a link message."""
        for number in envelope.payload_numbers(envelope.restore(datagram)) if self._peer else ():
            if (handler := self._registry.by_number.get(number)) is not None:
                yield handler.route.peer


class RosReplay(_Replay):
    """Replay in the role of ROS 2 nodes: the recorded messages are published on their topics.

    If the definition of a topic's message is unchanged, the recorded messages are published. If it has changed, the
    current handlers make the messages again from the recorded datagrams.
    """

    def __init__(
        self, recording: Recording, registry: Registry, topics: Collection[str] = (), commands: bool = False
    ) -> None:
        """Select topics by fully qualified name; if ``topics`` is empty, the topics of all rows are selected.

        Unless ``commands`` is true, topics that go from ROS 2 to a peer are left out, because they would move the
        rover.
        """
        super().__init__(recording, registry)
        self._translator = Translator(registry)
        self._types = {handler.message_type.__msgtype__: handler for handler in registry.handlers}
        self.endpoints: dict[str, Endpoint] = {}
        self.left_out: list[str] = []
        """Topics that were left out because they command the rover."""
        self._reconverted: dict[int, str] = {}  # topics by the number of the payload in the recording
        for topic, channel in self._channels.items():
            if channel.encoding == "cdr" and (topic in topics if topics else "number" in channel.metadata):
                self._add(topic, channel, commands)

    def _add(self, topic: str, channel: Channel, commands: bool) -> None:
        # Safety: replaying a drive command would move the rover, so it needs an explicit option.
        if channel.metadata.get("direction", "").startswith("ros_to_") and not commands:
            self.left_out.append(topic)
            return
        handler = self._types.get(channel.schema_name)
        definition = channel.schema.decode()
        if handler is not None and definition_of(handler.message_type) == definition:
            self.endpoints[topic] = Endpoint(handler.message_type, handler.route.qos)
        elif "number" in channel.metadata:
            self._reconvert(topic, int(channel.metadata["number"]))
        else:
            self.endpoints[topic] = Endpoint(message_type_from(channel.schema_name, definition), Qos())

    def _reconvert(self, topic: str, number: int) -> None:
        handler = self._handler(number)
        if handler is None:
            self.refused[f"{topic}: {self.adapter.refused.get(number, 'the table has no row with its number')}"] += 1
        elif not any(name.startswith((RECEIVED, SENT)) for name in self._channels):
            self.refused[
                f"{topic}: its message type has changed, and the recording has no datagrams to make the messages from"
            ] += 1
        else:
            self._reconverted[number] = topic
            self.endpoints[topic] = Endpoint(handler.message_type, handler.route.qos)

    def _handler(self, number: int) -> AnyHandler | None:
        """Return the current handler for a payload number in the recording; None if the table has no such row today."""
        if number in self.adapter.refused:
            return None
        return self._registry.by_number.get(self.adapter.number_today(number))

    @property
    def notes(self) -> list[str]:
        """Texts for the user about messages that are not replayed exactly as they were recorded."""
        made = sorted(self._reconverted.values())
        return [*super().notes, *([f"made again from the recorded datagrams: {', '.join(made)}"] if made else [])]

    def messages(self, since: int = 0) -> Iterator[Timed]:
        """Yield the messages to publish, each with its topic, from the time ``since`` (nanoseconds since 1970)."""
        for recorded in self._recording.messages(since):
            topic = recorded.channel.topic
            if recorded.channel.encoding == "cdr":
                if topic in self.endpoints and topic not in self._reconverted.values():
                    yield Timed(recorded.time, topic, recorded.data)
            elif self._reconverted and topic.startswith((RECEIVED, SENT)):
                yield from self._convert_again(recorded)

    def _convert_again(self, recorded: Recorded) -> Iterator[Timed]:
        numbers = envelope.payload_numbers(envelope.restore(recorded.data))
        topic = self._reconverted.get(numbers[-1]) if numbers else None
        if topic is None:
            return
        try:
            message = self._translator.parse(self.adapter.adapt(recorded.data))
            name = str(message.WhichOneof(self._registry.oneof))
            handler = self._registry.by_name[name]
            if handler.route.inbound == recorded.channel.topic.startswith(RECEIVED):
                yield Timed(recorded.time, topic, handler.to_cdr(getattr(message, name)))
        except (DatagramError, ConversionError) as error:
            self.refused[f"{topic}: {error}"] += 1
