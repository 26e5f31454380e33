"""Content of docs/messages.md, as the template ``messages.md.j2`` reads it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from roverlink.generator import ir
from roverlink.generator.emit import extra_topic_text
from roverlink.generator.emit.targets.markdown.examples import Example, Examples
from roverlink.generator.emit.targets.markdown.payloads import Payload, Payloads, Value, cell
from roverlink.generator.ir.msg_types import msg_type
from roverlink.transport_addresses import names_transport


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

    route: ir.Route
    comment: str
    anchor: str
    sender: str
    receiver: str
    topic: Topic
    extra_topics: tuple[Topic, ...]
    file: str
    payload: Payload | None
    """Payload of the row; None if the section of an earlier row shows the same payload."""
    payload_anchor: str
    """Anchor of the section in which the payload is shown."""
    example: Example

    @property
    def receivers(self) -> tuple[str, ...]:
        """Receiver of the row, and the peers to which the row is forwarded."""
        return (self.receiver, *self.route.forward)

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

    bridge: ir.Bridge
    default_qos: str
    diagram: Diagram
    rows: tuple[Row, ...]
    nested: tuple[Payload, ...]
    enums: tuple[Enum, ...]
    helpers: tuple[Helper, ...]

    @property
    def names_hosts(self) -> bool:
        """True if the table names the host of a peer or of a board."""
        return any(end.host for peer in self.bridge.peers for end in peer.ends)

    @staticmethod
    def port_of(end: ir.End) -> str:
        """Return the UDP port of a peer or of a board, or why it has none."""
        return "none" if names_transport(end.host) else str(end.port or "learned")


def page(bridge: ir.Bridge) -> Page:
    """Return the content of docs/messages.md."""
    payloads = Payloads(bridge)
    carried = {route.proto for route in bridge.routes}
    shown = [message for message in bridge.wire_messages if message.name != bridge.envelope.message]
    own = [message for message in shown if not message.map_entry and not message.name.startswith("google.protobuf.")]
    return Page(
        bridge=bridge,
        default_qos=_qos_words(ir.Qos()),
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
        route=route,
        comment=payloads.comment(route.proto),
        anchor=payloads.anchor_of_row(route),
        sender=ends[0],
        receiver=ends[1],
        topic=_topic(route, package),
        extra_topics=tuple(_extra_topic(standard) for standard in route.extra_topics),
        file=file,
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


_SHOWN = 12  # rows of a group; more would make the diagram too high


@dataclass(frozen=True, slots=True)
class End:
    """Sender or receiver in the diagram: a board, a whole peer, or ROS 2."""

    id: str
    label: str


@dataclass(frozen=True, slots=True)
class Group:
    """Rows with the same sender and the same receivers."""

    id: str
    rows: tuple[ir.Route, ...]
    """Rows that the diagram shows; the others are only counted in `more`."""
    more: int
    """Number of further rows in the group, which the diagram does not show."""
    sender: End
    receiver: End
    """Box of the diagram for all receivers of the rows. Forwarded rows get one box, because several arrows would cross.
    """


@dataclass(frozen=True, slots=True)
class Diagram:
    """Content of the diagram from left to right."""

    senders: tuple[End, ...]
    groups: tuple[Group, ...]
    receivers: tuple[End, ...]


def diagram(bridge: ir.Bridge) -> Diagram:
    """Return the diagram. Rows with the same sender and receivers share a group, so that the diagram has few arrows."""
    grouped: dict[tuple[bool, End, tuple[str, ...]], list[ir.Route]] = {}
    for route in sorted(bridge.routes, key=lambda route: not route.inbound):
        end = _end(route)
        grouped.setdefault((route.inbound, end, route.forward), []).append(route)
    groups = []
    for index, ((inbound, end, forward), rows) in enumerate(grouped.items()):
        sender, receiver = (end, _forwarded(_ROS, forward)) if inbound else (_ROS, end)
        ends = _as("from", sender), _as("to", receiver)
        groups.append(Group(f"rows_{index}", tuple(rows[:_SHOWN]), max(0, len(rows) - _SHOWN), *ends))
    senders = dict.fromkeys(group.sender for group in groups)
    return Diagram(tuple(senders), tuple(groups), tuple(dict.fromkeys(group.receiver for group in groups)))


_ROS = End("ros", "ROS 2")


def _forwarded(end: End, forward: tuple[str, ...]) -> End:
    if not forward:
        return end
    return End("_".join((end.id, *forward)), f"{end.label}<br>forwarded to {', '.join(forward)}")


def _as(role: str, end: End) -> End:
    return End(f"{role}_{end.id}", end.label)


def _end(route: ir.Route) -> End:
    """Return the diagram's box for the peer's end of a row: its board, or the whole peer if the row has no board."""
    peer = route.peer
    if not route.board:
        return End(peer, peer)
    return End(f"{peer}_{re.sub(r'[^A-Za-z0-9]', '_', route.board)}", f"{peer}: {route.board}")
