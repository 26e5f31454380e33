"""A payload takes a burned number: a number that several other payloads had in the past.

A burned number must never be used again, because boards and recordings disagree on its meaning. The command `roverlink
lint --history --accept` finds such numbers in git's history, and lists them as burned in the ledger (mapping.lock).

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

RULE = Rule("ENV110", "burned-number-taken", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row or signature with a burned number, which must never be used again.

    A row is left out if its payload already had the number when the user accepted the number's history.
    """
    envelope = context.table.envelope.message
    burned = context.ledger.burned_in(envelope)
    for row in context.table.numbered:
        one = burned.get(row.number)
        if one is not None and (one.now is None or one.now[0] != row.proto):
            told = " and ".join(dict.fromkeys(repr(type) for type, _ in one.uses))
            help = f"give {row.name!r} the number {context.next_number()}, which was never used"
            message = f"field {row.number} was used for {told} in the past, and must never be used again"
            yield RULE.at(row.at("number"), message, help, type=envelope, number=row.number)
