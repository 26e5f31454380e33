"""The deadman of a published row was removed, waits longer, or sends another payload.

The deadman stops the rover when the commanding topic falls silent. Without it, the rover goes on with its last command.
The ledger (mapping.lock) contains the deadman of each row at the last `roverlink generate`. With `--against`, the
deadman of the earlier state counts, too. A shorter time is no finding. To change a deadman on purpose, lower this rule
in the row until the change is merged, and give the reason.

Bad::

    # mapping.lock says `2 ArmControl deadman after: 500ms`
    - {number: 2, name: arm_ctrl, proto: ArmControl, topic: arm_ctrl, direction: ros_to_hardware}

Good::

    - number: 2
      name: arm_ctrl
      proto: ArmControl
      topic: arm_ctrl
      direction: ros_to_hardware
      deadman: {after: 500ms, send: {}}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span
from roverlink.generator.lint.context import ChangedSetting, Context
from roverlink.generator.lock import DEADMAN
from roverlink.generator.table import Row

RULE = Rule("TAB110", "deadman-weakened", __doc__)
_HELP = "restore the deadman; or lower TAB110 under `lint` of the row, with the reason"


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each part of a row's deadman that stops the peer later, or in another way, than before."""
    for row in context.table.rows:
        if row.inbound:
            continue  # nothing is sent to the peer; TAB109 reports the new direction
        changed = context.changed_settings(row)
        for key in DEADMAN:
            for message, span in _weaker(row, key, changed[key]) if key in changed else ():
                place = row.at("direction")
                yield context.diagnostic_of_change(RULE, row, changed[key], message, _HELP, span, rests_on=place)


def _weaker(row: Row, key: str, change: ChangedSetting) -> Iterator[tuple[str, Span]]:
    if change.now is None:
        if key == DEADMAN[0]:  # the other parts are gone with it
            yield f"the deadman of {row.name!r} was removed", row.at("name")
        return
    name = key.removeprefix("deadman ")
    message = f"the deadman of {row.name!r} has `{name}` {change.now.text!r}; {change.published}"
    if name == "send" or change.now.amount > min(setting.amount for setting in change.before.values()):
        yield message, change.now.span
