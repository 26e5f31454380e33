"""A payload takes a burned number: a number that several other payloads had in the past.

Boards and recordings disagree on the meaning of such a number. The user accepted its past with the command `roverlink
lint --history --accept`, which lists it as burned in the ledger: mapping.lock, or accepted-numbers.lock in a folder of
.proto files without a table. A payload that had the number then keeps it. If no payload had it, no payload may use it
again. An earlier payload may not come back, either; accept the number again if it does no harm.

Bad::

    # mapping.lock says under `burned`: `PBEnvelope 18: Foo foo | Bar bar`
    - {number: 18, name: baz, proto: Baz, topic: baz, direction: hardware_to_ros}

Good::

    - {number: 22, name: baz, proto: Baz, topic: baz, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.lock import PastUse

RULE = Rule("ENV110", "burned-number-taken", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row with a burned number that its payload must not have."""
    envelope = context.table.envelope.message
    for row in context.table.members:
        burned = context.ledger.must_not_be(envelope, row.number, PastUse(row.proto, row.name))
        # The type says what a payload means, so the payload may have another name.
        if burned and not (burned.now and burned.now.type == row.proto):
            help = f"give {row.name!r} the number {context.next_number()}, which was never used"
            message = f"field {row.number} was used for {burned.told} in the past, and must never be used again"
            yield RULE.at(row.at("number"), message, help, type=envelope, number=row.number)
