"""The state of a bridge: what each row does, what is wrong with it, and how full things are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum

from roverlink.runtime.monitoring.histogram import Latencies


class Level(IntEnum):
    """How a thing is, as diagnostic_msgs numbers it."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True)
class RowState:
    """One row of the table."""

    number: int
    name: str
    direction: str
    topic: str
    peer: str
    count: int
    """Messages that have crossed."""
    rate: float
    """Messages a second, over the last two seconds."""
    age: float | None
    """Seconds since the last one; None where none has crossed."""
    expect_rate: float | None
    """Messages a second that the table expects at least."""
    dropped: Mapping[str, int]
    """What did not cross, by reason."""
    level: Level
    message: str


@dataclass(frozen=True)
class Recording:
    """How a recording is doing."""

    path: str
    waiting: int
    lost: int
    bytes: int
    failure: str | None


@dataclass(frozen=True)
class State:
    """A bridge at one moment."""

    node: str
    fingerprint: str
    rows: tuple[RowState, ...]
    received: int
    received_rate: float
    forwarded: Mapping[str, int]
    """Raw datagrams handed on, by peer."""
    unsent: Mapping[str, int]
    """Datagrams that the network refused, by peer."""
    dropped: Mapping[str, int]
    """Datagrams that were not bridged, by reason; of which row is known or not."""
    kernel_drops: int
    socket_waiting: int
    """Bytes that wait in the socket."""
    socket_size: int
    """Bytes that the socket holds at most."""
    level: Level
    """Of the datagrams as a whole."""
    message: str
    latencies: Latencies = field(default=Latencies((), 0.0))
    recording: Recording | None = None
