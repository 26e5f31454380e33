"""A field number is given to a field with another meaning.

The new type can read the old bytes, so there is no error: the old value is read as the new quantity. The lint judges
the meaning by the names. A name keeps the meaning if it only has another spelling style, plural, usual short form or
word order, or a qualifier more or less: `motor_speed` for `speed`. A rename to another word, to an opposite (`left`
and `right`), to another number or to the name of another field is reported here. If the new name is only a better
one, keep the old name as the field's `json_name`.

Bad::

    message Motor { float left_speed = 1; }     // before
    message Motor { float left_current = 1; }   // after

Good::

    message Motor { reserved 1; reserved "left_speed"; float left_current = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.judged_fields import judged_fields

RULE = Rule("WIR114", "field-meaning-replaced", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose new name or type shows another meaning."""
    return judged_fields(RULE, context, Meaning.OTHER)
