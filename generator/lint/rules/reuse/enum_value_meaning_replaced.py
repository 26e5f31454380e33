"""A number of an enum is given to a value with another meaning.

The values of the enum were swapped or shifted, or a number has a new name that means something else. Boards with old
firmware still send the old numbers. The rover reads each number as another valid value, so there is no error. Names are
judged without the words that the enum and most of its values have, in the same way as the names of fields
(`roverlink explain WIR114`).

Bad::

    enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }   // before
    enum Mode { IDLE = 0; ARM = 1; DRIVE = 2; }   // after

Good::

    enum Mode { IDLE = 0; DRIVE = 1; ARM = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison.judgement import Meaning
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.judged_values import judged_values

RULE = Rule("WIR110", "enum-value-meaning-replaced", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each enum number whose value has another meaning."""
    return judged_values(RULE, context, Meaning.OTHER)
