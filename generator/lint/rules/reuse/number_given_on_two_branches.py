"""Open branches have given the same number to different payloads, fields or enum values.

The branch that is merged second takes the number from the first. Then the rover misreads boards with the firmware of
the first branch. Before the merge, it is enough to change the number in one line. All messages that the envelope can
contain are compared. If the two perhaps mean the same, this is a warning.

Bad::

    Wind wind = 22;     // on the branch wind-sensor
    Water water = 22;   // on the branch water-sensor

Good::

    Wind wind = 22;     // on the branch wind-sensor
    Water water = 23;   // on the branch water-sensor
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Use
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Allocation, whereabouts
from roverlink.generator.lint.history_diagnostics import number_never_used, place_of
from roverlink.generator.protos.schema import Fact

RULE = Rule("HIS104", "number-given-on-two-branches", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number to which branches have given different payloads since they diverged."""
    past, envelope = context.past, context.table.envelope.message
    if past is None or not past.of_branches:
        return
    for found in past.history.collisions(envelope):
        owner, number = found.owner, found.number
        message = f"number {number} of {owner!r} is {' and '.join(map(_said, found.allocations))}"
        free = number_never_used(context, past.history, owner)
        other = f"the number {free}, which no branch uses" if free else "a number in another type"
        finding = RULE.at(
            place_of(context, owner, number),
            message if found.certain else f"{message}: {found.reason}",
            f"keep the number for one of them, and give the other one {other}",
            type=owner,
            number=number,
            uses=[_use(context, number, one) for one in found.allocations],
        )
        yield finding if found.certain else dataclasses.replace(finding, severity=Severity.WARNING)


def _use(context: Context, number: int, one: Allocation) -> Use:
    declaration = Fact(number, one.name, one.type).text
    place = context.place(one.path, one.line, 0)
    return Use(one.type, one.name, one.came, None, (declaration,), place, whereabouts(one.refs))


def _said(allocation: Allocation) -> str:
    called = f"{allocation.name!r} ({allocation.type})" if allocation.type else repr(allocation.name)
    return f"{called} {whereabouts(allocation.refs)}"
