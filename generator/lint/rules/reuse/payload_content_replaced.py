"""The content of a payload was replaced in history, but its name stayed the same.

The envelope looks unchanged, but the receiver reads the bytes of the old payload as fields of the new payload.

Bad::

    message Status { float voltage = 1; float current = 2; float power = 3; }            // until May
    message Status { uint32 mode = 1; string text = 2; bool ready = 3; float age = 4; }  // since then

Good::

    message StatusReport { uint32 mode = 1; string text = 2; bool ready = 3; float age = 4; }  // under a new number

The past cannot be undone. The command in the help of the diagnostic accepts it (`roverlink explain HIS101`). If the
content is replaced again later, the lint reports it again.
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Kind
from roverlink.generator.lint.history_diagnostics import reported, reuses_by_number

RULE = Rule("HIS103", "payload-content-replaced", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number of the envelope whose payload kept its name, but not its fields."""
    for owner, number, reuses in reuses_by_number(context, frozenset({Kind.REPLACED})):
        yield reported(RULE, context, owner, number, reuses)
