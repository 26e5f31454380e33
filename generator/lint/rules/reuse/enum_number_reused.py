"""A number of a deleted enum value is used again.

The value was deleted long ago, and its number is no longer reserved. The ledger (mapping.lock) has every number that
was ever published. A board with old firmware may still send the old value, and the rover reads it as the new one. A
value with a similar name counts as the old one (`roverlink explain WIR114`). The same holds for a burned number, whose
past was accepted with `roverlink lint --history --accept` (`roverlink explain WIR111`).

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; }   // once
    enum Mode { IDLE = 0; }              // later
    enum Mode { IDLE = 0; ARM = 1; }     // now

Good::

    enum Mode { reserved 1; reserved "DRIVE"; IDLE = 0; ARM = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.judged_ledger import burned_values, reused_values

RULE = Rule("WIR112", "enum-number-reuse", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each enum value whose number belonged to another value in the ledger."""
    reused = list(reused_values(RULE, context, {Meaning.OTHER, Meaning.WIRE}))
    yield from reused
    told = {finding.span for finding in reused}
    yield from (finding for finding in burned_values(RULE, context) if finding.span not in told)
