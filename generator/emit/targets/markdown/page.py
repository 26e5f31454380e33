"""Content of docs/messages.md, as the template ``messages.md.j2`` reads it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit import extra_topic_text
from roverlink.generator.emit.targets.markdown.diagram import Diagram, diagram
from roverlink.generator.emit.targets.markdown.examples import Example, Examples
from roverlink.generator.emit.targets.markdown.payloads import Payload, Payloads, Value, cell
from roverlink.generator.ir.msg_types import msg_type


@dataclass(frozen=True, slots=True)
class Topic:
    """Topic on the page docs/messages.md, with its ROS message."""

    name: str
    message: str
    qos: str
    """Quality of service in words; empty for the default."""
    fields: tuple[tuple[str, str], ...] = ()
    """Path of each filled field of a standard message, and the text that tells where its value comes from."""


@dataclass(frozen=True, slots=True)
class Row:
    """Section of docs/messages.md for a row of the table."""

    number: int
    name: str
    comment: str
    anchor: str
    sender: str
    receiver: str
    forward: tuple[str, ...]
    topic: Topic
    extra_topics: tuple[Topic, ...]
    proto: str
    file: str
    size: ir.WireSize | None
    max_rate: int | None
    expect_rate: int | None
    priority: int
    deadman: ir.Deadman | None
    payload: Payload | None
    """Payload of the row; None if the section of an earlier row shows the same payload."""
    payload_anchor: str
    """Anchor of the section in which the payload is shown."""
    example: Example

    @property
    def receivers(self) -> tuple[str, ...]:
        """Receiver of the row, and the peers to which the row is forwarded."""
        return (self.receiver, *self.forward)

    @property
    def topics(self) -> tuple[Topic, ...]:
        """The row's own topic, then its extra topics."""
        return (self.topic, *self.extra_topics)


@dataclass(frozen=True, slots=True)
class Enum:
    """Section of docs/messages.md for an enum."""

    name: str
    comment: str
    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Helper:
    """Generated ROS 2 message that belongs to no proto message: it is made for a map's entry, an enum, or an Any."""

    name: str
    fields: str
    source: str


@dataclass(frozen=True, slots=True)
class Page:
    """Content of the whole page docs/messages.md."""

    table: str
    package: str
    default_qos: str
    envelope: ir.Envelope
    peers: tuple[ir.Peer, ...]
    diagram: Diagram
    rows: tuple[Row, ...]
    nested: tuple[Payload, ...]
    enums: tuple[Enum, ...]
    helpers: tuple[Helper, ...]

    @property
    def names_hosts(self) -> bool:
        """True if the table names the host of a peer or of a board."""
        return any(end.host for peer in self.peers for end in peer.ends)


def page(bridge: ir.Bridge) -> Page:
    """Return the content of docs/messages.md."""
    payloads = Payloads(bridge)
    carried = {route.proto for route in bridge.routes}
    shown = [message for message in bridge.wire_messages if message.name != bridge.envelope.message]
    own = [message for message in shown if not message.map_entry and not message.name.startswith("google.protobuf.")]
    return Page(
        table=bridge.table,
        package=bridge.package,
        default_qos=_qos_words(ir.Qos()),
        envelope=bridge.envelope,
        peers=bridge.peers,
        diagram=diagram(bridge),
        rows=tuple(_rows(bridge, payloads)),
        nested=tuple(payloads.of(message.name) for message in own if message.name not in carried),
        enums=tuple(
            Enum(enum.name, enum.comment, payloads.values(enum))
            for enum in bridge.wire_enums
            if not enum.name.startswith("google.protobuf.")
        ),
        helpers=tuple(_helpers(bridge)),
    )


def _rows(bridge: ir.Bridge, payloads: Payloads) -> Iterator[Row]:
    examples = Examples(bridge)
    files = {member.number: member.file for member in bridge.envelope.members}
    seen: set[str] = set()
    for route in bridge.routes:
        yield _row(route, bridge.package, files[route.number], payloads, examples, new=route.proto not in seen)
        seen.add(route.proto)


def _row(route: ir.Route, package: str, file: str, payloads: Payloads, examples: Examples, *, new: bool) -> Row:
    ends = (route.peer, "ROS 2") if route.inbound else ("ROS 2", route.peer)
    return Row(
        number=route.number,
        name=route.name,
        comment=payloads.comment(route.proto),
        anchor=payloads.anchor_of_row(route),
        sender=ends[0],
        receiver=ends[1],
        forward=route.forward,
        topic=_topic(route, package),
        extra_topics=tuple(_extra_topic(standard) for standard in route.extra_topics),
        proto=route.proto,
        file=file,
        size=route.size,
        max_rate=route.max_rate,
        expect_rate=route.expect_rate,
        priority=route.priority,
        deadman=route.deadman,
        payload=payloads.of(route.proto) if new else None,
        payload_anchor=payloads.anchor(route.proto),
        example=examples.of(route),
    )


def _topic(route: ir.Route, package: str) -> Topic:
    if route.standard is not None:
        return _extra_topic(route.standard)
    return Topic(route.topic, f"{package}/msg/{route.conversion.ros if route.conversion else ''}", _qos(route.qos))


def _extra_topic(standard: ir.StandardTopic) -> Topic:
    fields = tuple((name, cell(words)) for name, words in extra_topic_text.fields(standard))
    return Topic(standard.topic, standard.message, _qos(standard.qos), fields)


def _qos(qos: ir.Qos) -> str:
    return "" if qos == ir.Qos() else _qos_words(qos)


def _qos_words(qos: ir.Qos) -> str:
    depth = f" {qos.depth}" if qos.history == "keep_last" else ""
    return f"{qos.reliability}, {qos.durability}, {qos.history}{depth}".replace("_", " ")


def _helpers(bridge: ir.Bridge) -> Iterator[Helper]:
    converted = bridge.conversions()
    for message in bridge.messages:
        if message.name not in converted:
            fields = ", ".join(f"`{msg_type(field.type)} {field.name}`" for field in message.fields)
            yield Helper(message.name, fields, message.source)
