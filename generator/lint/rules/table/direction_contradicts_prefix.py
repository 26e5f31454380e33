"""A row's direction names one peer, but its message's name belongs to another peer.

The key `prefixes` of a peer lists the beginnings of its messages' names. A row that expects a board's message from the
basestation is probably a mistake: the payload would never arrive, and there would be no error.

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

RULE = Rule("TAB105", "direction-contradicts-prefix", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row whose message's name begins with the prefix of another peer."""
    table = context.table
    if not table.whole:
        return  # the prefix may be in a part that could not be read
    peers = table.peers_by_name()
    for row in table.rows:
        own = peers.get(row.peer)
        if own is None or not own.prefixes or own.prefix_of(row.proto):
            continue  # a peer without prefixes accepts any message
        for other in table.peers:
            if prefix := other.prefix_of(row.proto):
                prefixed = f"{row.proto!r} has the prefix of the peer {other.name!r}"
                message = f"{row.name!r} has direction {row.direction!r}, but {prefixed}"
                direction = f"{other.name}_to_ros" if row.inbound else f"ros_to_{other.name}"
                help = f"write `direction: {direction}`, or add the prefix to `prefixes` of the peer {own.name!r}"
                also = [(other.at(f"prefixes.{prefix}"), f"the peer {other.name!r} has the prefix {prefix!r}")]
                span, envelope = row.at("direction"), table.envelope.message
                yield RULE.at(span, message, help, also, type=envelope, number=row.number)
                break
