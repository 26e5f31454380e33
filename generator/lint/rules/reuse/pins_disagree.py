"""Two projects use commits of the protos that give one number of the envelope to different payloads.

The rover, the boards and the basestation each build the protos from the commit to which the project is pinned. If these
commits disagree about a number, the receiver decodes the wrong payload without an error.

Bad::

    rover        4f1c2ab   # PBEnvelope: Gps gps = 12
    basestation  9d03e77   # PBEnvelope: Wind wind = 12

Good::

    rover        9d03e77
    basestation  9d03e77
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.pinned_numbers import Pinned

RULE = Rule("PIN102", "pins-disagree", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number that has different payloads in two projects that use the protos."""
    past, envelope = context.past, context.table.envelope.message
    if past is None:
        return
    # Every pair: the rover may agree with both of two boards which disagree with each other about a number it does not
    # have.
    for one, other in combinations(past.pinned, 2):
        for number in one.disagreements(other):
            message = (
                f"number {number} of {envelope!r} is {_payload(other, number)} in the project {other.pin.consumer!r}, "
                f"but {_payload(one, number)} in the project {one.pin.consumer!r}"
            )
            also = [(one.pin.span, f"{one.pin.consumer!r} is pinned to {one.commit}")]
            help = f"pin both projects to the same commit; {other.pin.consumer!r} is pinned to {other.commit}"
            yield RULE.at(other.pin.span, message, help, also, type=envelope, number=number)


def _payload(pinned: Pinned, number: int) -> str:
    type, name = pinned.numbers[number]
    return f"{name!r} ({type})"
