"""A field was renamed, and its new name says another unit, scale or reference.

Number and type are the same, so there is no error. The receiver reads millimetres of an old sender as metres,
hundredths of a degree as degrees, or a difference as a position.

Bad::

    message Arm { int32 reach_mm = 1; }   // before
    message Arm { int32 reach_m = 1; }    // after

Good::

    message Arm { reserved 1; reserved "reach_mm"; int32 reach_m = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.judged_fields import judged_fields
from roverlink.generator.lint.judged_ledger import reused_fields

RULE = Rule("WIR115", "field-unit-changed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose old and new name contain the same quantity in different units."""
    yield from judged_fields(RULE, context, Meaning.UNIT)
    yield from reused_fields(RULE, context, {Meaning.UNIT})
