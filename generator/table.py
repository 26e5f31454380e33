"""The table as it stands in mapping.yaml: plain values that remember where they stand."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from generator.diagnostics import Span
from generator.ir import Qos


@dataclass(frozen=True, slots=True)
class Placed:
    """A part of the table, with the place of each of its keys."""

    span: Span
    spans: Mapping[str, Span] = field(repr=False)

    def at(self, key: str) -> Span:
        """Where a key's value stands; the part's own place where the key is absent."""
        return self.spans.get(key, self.span)


@dataclass(frozen=True, slots=True)
class ProtoSettings(Placed):
    """Where the .proto files are."""

    root: str
    """Folder, relative to the table, from which imports are resolved."""
    exclude: tuple[str, ...]
    """Files that never take part in a build, relative to the root."""


@dataclass(frozen=True, slots=True)
class EnvelopeSettings(Placed):
    """The message that carries every payload."""

    file: str
    message: str
    oneof: str
    owner: str
    """``mapping``: generate writes the file; ``proto``: it is somebody else's, and only checked."""


@dataclass(frozen=True, slots=True)
class PeerSettings(Placed):
    """A machine at the other end of the datagrams."""

    name: str
    prefixes: tuple[str, ...]
    """What the names of its messages start with."""
    parameter: str
    """The node's parameter that holds its UDP port."""
    port: int
    """That parameter's default."""
    strip_trailing_zeros: bool
    max_size: int | None
    """Largest envelope in bytes that it can take or send; None where it has memory enough."""
    sources: tuple[str, ...] = ()
    """Addresses and networks from which it speaks; empty for any."""
    source_rate: int | None = None
    """Datagrams a second that are taken from each of its addresses; None for any number."""


@dataclass(frozen=True, slots=True)
class Lowered(Placed):
    """A rule whose findings count for less."""

    rule: str
    severity: str
    """``warning``, ``hint``, or ``off``."""
    reason: str


@dataclass(frozen=True, slots=True)
class Bound:
    """How much a microcontroller has room for in a field."""

    length: int | None
    """Bytes of a text or of `bytes`."""
    count: int | None
    """Values of a repeated field."""


@dataclass(frozen=True, slots=True)
class DeadmanSettings(Placed):
    """What a peer is told when the topic that commands it falls silent."""

    after_ms: int
    repeat_ms: int
    send: Mapping[str, str]
    """Values as they are written, by the path of the proto field."""


@dataclass(frozen=True, slots=True)
class Form:
    """What a row says of a field of a standard message: a value, a list, or a mapping of more of them."""

    span: Span
    value: bool | str | int | Fraction | float | None = None
    """Of a scalar."""
    items: tuple[Form, ...] | None = None
    """Of a list."""
    entries: Mapping[str, Form] | None = field(default=None, hash=False)
    """Of a mapping."""


@dataclass(frozen=True, slots=True)
class FeedSettings(Placed):
    """A topic with a message of ROS 2's common interfaces."""

    topic: str
    ros: str
    """With its package: ``sensor_msgs/Imu``."""
    qos: Qos
    frame_id: str | None
    stamp: Form | None
    fields: Mapping[str, Form]
    """What fills each field of the message, by its path."""
    unset: tuple[str, ...]
    """Paths of fields that nothing fills."""
    ignore: tuple[str, ...]
    """Paths of proto fields that the message does not tell."""


@dataclass(frozen=True, slots=True)
class Row(Placed):
    """One message: what travels under which number, between which peer and which topic."""

    number: int
    name: str
    proto: str
    ros: str
    topic: str
    direction: str
    qos: Qos
    fields: Mapping[str, str]
    """Renames: path of a proto field to the ROS field that takes it."""
    ignore: tuple[str, ...]
    """Paths of proto fields that no ROS field takes."""
    forward: tuple[str, ...]
    """Peers that also get the raw datagram."""
    bounds: Mapping[str, Bound]
    """By the path of the proto field."""
    lint: tuple[Lowered, ...]
    """What counts for less where it is about this row."""
    presence: Mapping[str, bool] = field(default_factory=dict)
    """Paths of proto fields, and whether a ROS field says that they are set."""
    anys: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Paths of google.protobuf.Any fields, and the messages that they may hold."""
    recursion: int | None = None
    """How often a message that holds itself may stand in itself; None where it must not."""
    deadman: DeadmanSettings | None = None
    max_rate: int | None = None
    """Most messages a second."""
    priority: int = 0
    expect_rate: int | None = None
    """Messages a second that diagnostics expect at least."""
    feed: FeedSettings | None = None
    """What the row itself becomes, where that is a standard message."""
    also: tuple[FeedSettings, ...] = ()
    """Its further topics."""

    @property
    def feeds(self) -> tuple[FeedSettings, ...]:
        """Everything that it becomes of standard messages."""
        return (self.feed, *self.also) if self.feed else self.also

    @property
    def inbound(self) -> bool:
        """Whether the payload comes from a peer and goes to a topic."""
        return self.direction.endswith("_to_ros")

    @property
    def peer(self) -> str:
        """The peer at the other end."""
        return self.direction.removesuffix("_to_ros").removeprefix("ros_to_")

    @property
    def ros_span(self) -> Span:
        """Where the ROS message's name stands, or the proto's, from which it is taken."""
        return self.spans.get("ros", self.at("proto"))


@dataclass(frozen=True, slots=True)
class RetiredRow(Placed):
    """A payload that is gone; its number and its name never come back."""

    number: int
    name: str
    proto: str


@dataclass(frozen=True, slots=True)
class EnumSettings(Placed):
    """An enum that is a ROS message of its own."""

    proto: str
    ros: str
    field: str


@dataclass(frozen=True, slots=True)
class Outputs(Placed):
    """What the table is compiled to."""

    targets: tuple[str, ...]
    templates: tuple[str, ...]
    """Folders of a user's own templates, relative to the table."""

    def and_further(self, targets: tuple[str, ...], templates: tuple[str, ...]) -> Outputs:
        """The same and others, each once."""
        return dataclasses.replace(
            self,
            targets=tuple(dict.fromkeys((*self.targets, *targets))),
            templates=tuple(dict.fromkeys((*self.templates, *templates))),
        )


@dataclass(frozen=True, slots=True)
class Table:
    """mapping.yaml: all of it, or what of it is whole."""

    file: str
    whole: bool
    """Whether nothing was left out; what concludes from an absence must ask."""
    numbers: frozenset[int]
    """Every number that stands in the file, also in a row that is not whole."""
    proto: ProtoSettings
    envelope: EnvelopeSettings
    package: str
    package_span: Span
    maintainer: str
    """``Name <address>``, of the ROS 2 package."""
    peers: tuple[PeerSettings, ...]
    rows: tuple[Row, ...]
    retired: tuple[RetiredRow, ...]
    enums: tuple[EnumSettings, ...]
    outputs: Outputs
    lint: tuple[Lowered, ...]
    """What counts for less everywhere."""
    distro: str = ""
    """The distribution whose standard messages are meant; empty where they must be the same in all."""

    def peers_by_name(self) -> dict[str, PeerSettings]:
        """The peers by name."""
        return {peer.name: peer for peer in self.peers}
