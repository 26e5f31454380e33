"""A number of a deleted field is used again.

The field was deleted long ago, and its number is no longer reserved. The ledger (mapping.lock) has every number that
was ever published. A board with old firmware may still send the old field, and the rover reads its bytes as the new
field. A field with a similar name counts as the old one (`roverlink explain WIR114`).

The same holds for a burned number: one whose past was accepted with `roverlink lint --history --accept`. If it was free
then, no field may use it again. If a field had it, no earlier field may come back.

Bad::

    message Imu { float x = 1; float y = 2; }      // once
    message Imu { float x = 1; }                   // later
    message Imu { float x = 1; int32 state = 2; }  // now

Good::

    message Imu { float x = 1; reserved 2; reserved "y"; int32 state = 3; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.judged_ledger import burned_fields, reused_fields

RULE = Rule("WIR111", "field-number-reuse-in-message", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose number belonged to a field with another meaning in the ledger."""
    reused = list(reused_fields(RULE, context, {Meaning.OTHER, Meaning.WIRE}))
    yield from reused
    told = {finding.span for finding in reused}
    yield from (finding for finding in burned_fields(RULE, context) if finding.span not in told)
