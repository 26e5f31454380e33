"""A payload takes a number that a comment in the envelope names for another payload.

A member that is commented out was often in use once, or is in use on another branch. Boards may still send it. Ask the
author of the comment before you use the number.

Bad::

    oneof payload {
      // SensorBoardTimeout timeout = 30;
      SensorBoardWind wind = 30;
    }

Good::

    oneof payload {
      // SensorBoardTimeout timeout = 30;
      SensorBoardWind wind = 31;
    }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.protos.schema import ProtoField
from roverlink.generator.table import Numbered

RULE = Rule("ENV108", "number-claimed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row or signature whose number a comment in the envelope gives to another payload."""
    envelope = context.table.envelope.message
    claims = list(context.envelope_claims())
    for row in context.table.numbered:
        for claim, span in claims:
            if claim.number == row.number and not _is_same_payload(claim, row):
                message = (
                    f"{row.name!r} takes field {row.number}, which a comment declares for {claim.name!r} ({claim.type})"
                )
                help = f"give {row.name!r} the number {context.next_number()}, or delete the comment if it is wrong"
                also = [(span, "in this comment")]
                yield RULE.at(row.at("number"), message, help, also, type=envelope, number=row.number)


def _is_same_payload(claim: ProtoField, row: Numbered) -> bool:
    return claim.name == row.name or claim.type.rpartition(".")[2] == row.proto.rpartition(".")[2]
