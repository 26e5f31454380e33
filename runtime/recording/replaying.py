"""What of a recording goes where when it is replayed, in today's schema."""

from __future__ import annotations

import itertools
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator
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
    """Something to replay: when it was, where it goes (a topic; empty for the bridge's port), and what."""

    time: int
    topic: str
    data: bytes


class Endpoint(NamedTuple):
    """A topic to publish on."""

    message_type: type[Message]
    qos: Qos


def paced(
    messages: Iterable[Timed],
    speed: float,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Iterator[Timed]:
    """The messages, each when its time has come: as in the run, ``speed`` times as fast."""
    messages = iter(messages)
    first = next(messages, None)
    if first is None:
        return
    start = clock()
    for message in itertools.chain([first], messages):
        sleep(max(0.0, start + (message.time - first.time) / 1e9 / speed - clock()))
        yield message


class _Replay:
    """What both ways of replaying share: the recorded envelope, and what could not be replayed."""

    def __init__(self, recording: Recording, registry: Registry) -> None:
        self._recording, self._registry = recording, registry
        self._channels = {topic: channel for topic, (channel, count) in recording.channels().items() if count}
        self.adapter = Adapter(_envelope(self._channels.values()) or registry.envelope, registry)
        self.refused: Counter[str] = Counter()
        """Messages that were not replayed, by the reason."""

    @property
    def notes(self) -> list[str]:
        """What is not as it was in the run."""
        changed = self.adapter.changed
        return [f"carried over by name into today's schema: {', '.join(changed)}"] if changed else []


def _envelope(channels: Iterable[Channel]) -> type[ProtoMessage] | None:
    explained = next((channel for channel in channels if channel.schema_encoding == "protobuf"), None)
    return None if explained is None else proto_type_from(explained.schema_name, explained.schema)


class BoardReplay(_Replay):
    """The datagrams that the bridge received, to be sent to a bridge again."""

    def messages(self) -> Iterator[Timed]:
        """The datagrams, byte for byte where the schema is the run's."""
        for recorded in self._recording.messages():
            if not recorded.channel.topic.startswith(RECEIVED):
                continue
            try:
                yield Timed(recorded.time, "", self.adapter.adapt(recorded.data))
            except DatagramError as error:
                self.refused[str(error)] += 1


class RosReplay(_Replay):
    """The topics of a run, in today's message types.

    A topic whose type is defined as it was is published as it was recorded. Where the type has changed, the messages
    are made anew, by today's handlers, from the datagrams that they came from or became.
    """

    def __init__(
        self, recording: Recording, registry: Registry, topics: Collection[str] = (), commands: bool = False
    ) -> None:
        """``topics`` are those wanted, fully qualified; empty means every row's.

        Without ``commands``, topics that go from ROS to a peer are left out: they would move the rover.
        """
        super().__init__(recording, registry)
        self._translator = Translator(registry)
        self._types = {handler.message_type.__msgtype__: handler for handler in registry.handlers}
        self.endpoints: dict[str, Endpoint] = {}
        self.left_out: list[str] = []
        """Topics that command the rover."""
        self._remade: dict[int, str] = {}  # the number of a payload in the run, and its topic
        for topic, channel in self._channels.items():
            if channel.encoding == "cdr" and (topic in topics if topics else "number" in channel.metadata):
                self._add(topic, channel, commands)

    def _add(self, topic: str, channel: Channel, commands: bool) -> None:
        if channel.metadata.get("direction", "").startswith("ros_to_") and not commands:
            self.left_out.append(topic)
            return
        handler = self._types.get(channel.schema_name)
        definition = channel.schema.decode()
        if handler is not None and definition_of(handler.message_type) == definition:
            self.endpoints[topic] = Endpoint(handler.message_type, handler.route.qos)
        elif "number" in channel.metadata:
            self._remake(topic, int(channel.metadata["number"]))
        else:
            self.endpoints[topic] = Endpoint(message_type_from(channel.schema_name, definition), Qos())

    def _remake(self, topic: str, number: int) -> None:
        handler = self._handler(number)
        if handler is None:
            self.refused[f"{topic}: {self.adapter.refused.get(number, 'no row of today has its number')}"] += 1
        elif not any(name.startswith((RECEIVED, SENT)) for name in self._channels):
            self.refused[f"{topic}: its type has changed, and the recording's datagrams are not there"] += 1
        else:
            self._remade[number] = topic
            self.endpoints[topic] = Endpoint(handler.message_type, handler.route.qos)

    def _handler(self, number: int) -> AnyHandler | None:
        """The row that is today what a number was in the run."""
        if number in self.adapter.refused:
            return None
        return self._registry.by_number.get(self.adapter.number_today(number))

    @property
    def notes(self) -> list[str]:
        """What is not as it was in the run."""
        made = sorted(self._remade.values())
        return [*super().notes, *([f"made anew from the datagrams: {', '.join(made)}"] if made else [])]

    def messages(self) -> Iterator[Timed]:
        """The messages to publish."""
        for recorded in self._recording.messages():
            topic = recorded.channel.topic
            if recorded.channel.encoding == "cdr":
                if topic in self.endpoints and topic not in self._remade.values():
                    yield Timed(recorded.time, topic, recorded.data)
            elif self._remade and topic.startswith((RECEIVED, SENT)):
                yield from self._made_anew(recorded)

    def _made_anew(self, recorded: Recorded) -> Iterator[Timed]:
        numbers = envelope.payload_numbers(envelope.restore(recorded.data))
        topic = self._remade.get(numbers[-1]) if numbers else None
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
