"""A field or enum value was renamed, and the names do not show if the number has kept its meaning.

The names are similar, but not so similar that they certainly mean the same:

- Two words often mean the same, but not always: `speed` and `velocity`.
- Two words nearly have the same letters: `lattitude` and `latitude`. This may be a correction.
- Only one of the names has a word that may change the quantity, such as `max`, `left`, `target`, `limit` or a number.
- One word of a long name is another one, but not the last: `range_test_plugin_enabled` and `range_test_module_enabled`.
- A name such as `value` does not say what is meant.
- The field's type is another message or enum, which may be the old one with another name.

If the meaning is the same, keep the old name as the field's `json_name`, or lower this rule for the message.

Bad::

    message Motor { float speed = 1; }      // before
    message Motor { float velocity = 1; }   // after

Good::

    message Motor { reserved 1; reserved "speed"; float velocity = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.judged_fields import judged_fields
from roverlink.generator.lint.judged_ledger import reused_fields, reused_values
from roverlink.generator.lint.judged_values import judged_values

RULE = Rule("WIR116", "meaning-doubtful", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field and enum value whose new name may or may not have the old meaning."""
    yield from judged_fields(RULE, context, Meaning.DOUBTFUL)
    yield from judged_values(RULE, context, Meaning.DOUBTFUL)
    yield from reused_fields(RULE, context, {Meaning.DOUBTFUL})
    yield from reused_values(RULE, context, {Meaning.DOUBTFUL})
