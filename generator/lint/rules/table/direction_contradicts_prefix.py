"""A row's direction names one peer, and its message's name another.

The `prefixes` of a peer say what its messages are called. A row that sends a board's message to the basestation, or
awaits it from there, is mostly a slip of the hand: the payload would never arrive, and nothing would say so.

Bad::

    peers:
      hardware: {prefixes: [SensorBoard, ArmBoard]}
      basestation: {prefixes: [Basestation]}
    messages:
      - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: basestation_to_ros}

Good::

    messages:
      - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.table import PeerSettings

RULE = Rule("TAB105", "direction-contradicts-prefix", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Rows whose message is called as those of another peer are."""
    table = context.table
    if not table.whole:
        return  # the prefix may be among what could not be read
    peers = table.peers_by_name()
    for row in table.rows:
        own = peers.get(row.peer)
        if own is None or not own.prefixes or _prefix_of(own, row.proto):
            continue  # who has no prefixes takes anything
        for other in table.peers:
            if prefix := _prefix_of(other, row.proto):
                message = f"{row.name} goes {row.direction}, but {row.proto} is called as the messages of {other.name}"
                direction = f"{other.name}_to_ros" if row.inbound else f"ros_to_{other.name}"
                help = f"write `direction: {direction}`, or add a prefix to {own.name}"
                also = [(other.at(f"prefixes.{prefix}"), f"{other.name} has the prefix {prefix}")]
                span, envelope = row.at("direction"), table.envelope.message
                yield RULE.at(span, message, help, also, type=envelope, number=row.number)
                break


def _prefix_of(peer: PeerSettings, proto: str) -> str:
    """The peer's prefix that a message's name starts with, the proto package aside; empty for none."""
    names = (proto, proto.rpartition(".")[2])
    return next((prefix for prefix in peer.prefixes if any(name.startswith(prefix) for name in names)), "")
