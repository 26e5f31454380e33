"""Open branches have given the same number of the envelope to different payloads.

The branch that is merged second takes the number from the first. Then the rover misreads boards with the firmware of
the first branch. Before the merge, it is enough to change the number in one line.

Bad::

    Wind wind = 22;     // on the branch wind-sensor
    Water water = 22;   // on the branch water-sensor

Good::

    Wind wind = 22;     // on the branch wind-sensor
    Water water = 23;   // on the branch water-sensor
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span, Use
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Allocation, branch_name
from roverlink.generator.lint.history_diagnostics import place_of

RULE = Rule("HIS104", "number-given-on-two-branches", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number to which branches have given different payloads since they diverged."""
    past, envelope = context.past, context.table.envelope.message
    if past is None or not past.of_branches:
        return
    for collision in past.history.collisions(envelope):
        number, given = collision.number, collision.allocations
        message = f"number {number} of {envelope!r} is {' and '.join(map(_said, given))}"
        free = context.next_number()
        help = f"keep the number for one payload, and give the other payload the number {free}, which no branch uses"
        also = [
            (
                Span(f"{branch_name(one.refs[0])}:{one.path}", one.line),
                f"{one.name!r} ({one.type}) was added with {one.came}",
            )
            for one in given
        ]
        uses = [Use(one.type, one.name, one.came, None) for one in given]
        yield RULE.at(place_of(context, envelope, number), message, help, also, type=envelope, number=number, uses=uses)


def _said(allocation: Allocation) -> str:
    branches = " and ".join(f"the branch {branch_name(ref)!r}" for ref in allocation.refs)
    return f"{allocation.name!r} ({allocation.type}) on {branches}"
