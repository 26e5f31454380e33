"""A published row has another direction or another peer, or is no longer forwarded to a peer.

A board that still has the old direction sends what the rover sends, too, and both wait for a payload that never comes.
No machine reports an error. The ledger (mapping.lock) contains the direction and the `forward` list of each row at the
last `roverlink generate`. With `--against`, those of the earlier state count, too. To change a direction on purpose,
lower this rule in the row until the change is merged, and give the reason.

Bad::

    # mapping.lock says `16 ControlMode direction: basestation_to_ros`
    - {number: 16, name: control_mode, proto: ControlMode, topic: control_mode, direction: ros_to_basestation}

Good::

    - {number: 16, name: control_mode, proto: ControlMode, topic: control_mode, direction: basestation_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context

RULE = Rule("TAB109", "direction-changed", __doc__)
_HELP = "or update every machine that uses the row, and lower TAB109 under `lint` of the row, with the reason"


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row with another direction, and for each row that forwards to fewer peers."""
    for row in context.table.rows:
        changed = context.changed_settings(row)
        if direction := changed.get("direction"):
            peers = {_peer(text) for text in direction.before} - {row.peer}
            kind = f"another peer, {row.peer!r}" if peers else "the opposite direction"
            message = f"{row.name!r} has {kind}: its direction is {row.direction!r}; {direction.published}"
            span = row.at("direction")
            help = f"restore the direction; {_HELP}"
            yield context.diagnostic_of_change(RULE, row, direction, message, help, span, rests_on=span)
        if forward := changed.get("forward"):
            before = {peer for text in forward.before for peer in text.split()}
            if lost := sorted(before - {*row.forward}):
                peers_lost = " and ".join(map(repr, lost))
                message = f"{row.name!r} is no longer forwarded to {peers_lost}"
                span = row.at("forward") if row.forward else row.at("direction")
                help = f"restore `forward`; {_HELP}"
                yield context.diagnostic_of_change(RULE, row, forward, message, help, span, rests_on=span)


def _peer(direction: str) -> str:
    return direction.removesuffix("_to_ros").removeprefix("ros_to_")
