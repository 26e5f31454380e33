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

from roverlink.generator.diagnostics import Diagnostic, Rule, Use
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Allocation, whereabouts
from roverlink.generator.lint.history_diagnostics import place_of
from roverlink.generator.protos.schema import Fact

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
        uses = [_use(context, number, one) for one in given]
        yield RULE.at(place_of(context, envelope, number), message, help, type=envelope, number=number, uses=uses)


def _use(context: Context, number: int, one: Allocation) -> Use:
    declaration = Fact(number, one.name, one.type).text
    place = context.place(one.path, one.line, 0)
    return Use(one.type, one.name, one.came, None, (declaration,), place, whereabouts(one.refs))


def _said(allocation: Allocation) -> str:
    return f"{allocation.name!r} ({allocation.type}) {whereabouts(allocation.refs)}"
