"""A published row lost a limit, or has a weaker one: `max_rate`, `priority` or `expect_rate`.

`max_rate` protects a board from too many messages, `priority` lets a stop overtake other messages, and `expect_rate`
warns when a sensor falls silent. The ledger (mapping.lock) contains the limits of each row at the last `roverlink
generate`, which then writes the new ones, so this warning appears once.

Bad::

    # mapping.lock says `2 ArmControl max_rate: 50`
    - {number: 2, name: arm_ctrl, proto: ArmControl, topic: arm_ctrl, direction: ros_to_hardware, max_rate: 500}

Good::

    - {number: 2, name: arm_ctrl, proto: ArmControl, topic: arm_ctrl, direction: ros_to_hardware, max_rate: 50}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import ChangedSetting, Context
from roverlink.generator.lock import LIMITS

RULE = Rule("TAB111", "safety-limit-weakened", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each limit of a row that is gone, or weaker than it was published."""
    for row in context.table.rows:
        changed = context.changed_settings(row)
        for key in LIMITS:
            # a row from a peer has no priority; TAB109 reports the new direction
            if key not in changed or (key == "priority" and row.inbound) or not _is_weaker(key, changed[key]):
                continue
            limit = changed[key].now
            now = f"has `{key}` {limit.text!r}" if limit else f"has no `{key}`"
            message = f"{row.name!r} {now}; {changed[key].published}"
            span = limit.span if limit else row.at("name")
            help, place = "restore the limit, or check the boards and nodes that rely on it", row.at("direction")
            yield context.diagnostic_of_change(RULE, row, changed[key], message, help, span, rests_on=place)


def _is_weaker(key: str, change: ChangedSetting) -> bool:
    before = [setting.amount for setting in change.before.values()]
    if change.now is None:
        return True
    return change.now.amount > min(before) if key == "max_rate" else change.now.amount < max(before)
