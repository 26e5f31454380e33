"""A field number is given to a field with another meaning.

The new type can read the old bytes, so there is no error: the old value is read as the new quantity. The lint judges
the meaning by the names. If a field only gets a better name, let the new name share a word with the old name, or keep
the old name as its `json_name`.

Bad::

    message Motor { float voltage = 1; }       // before
    message Motor { float temperature = 1; }   // after

Good::

    message Motor { reserved 1; reserved "voltage"; float temperature = 2; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import FieldPair, SchemaChange, each_once, fields
from roverlink.generator.lint.comparison.field_renames import Rename, names_another_field, rename
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import name_place
from roverlink.generator.lint.free_numbers import NewNumbers, changed_field

RULE = Rule("WIR114", "field-meaning-replaced", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose new name shows another meaning.

    Such a name shares no word with the old name, or was the name of another field.
    """
    return each_once(context.changes, lambda change: _findings(context, change))


def _findings(context: Context, change: SchemaChange) -> Iterator[Diagnostic]:
    numbers = NewNumbers(context, change)
    for pair in fields(change):
        # The meaning of a payload is its type. Other rules check that.
        if rename(pair) is Rename.MEANING and pair.owner != context.table.envelope.message:
            yield changed_field(RULE, numbers, pair, _message(pair), name_place)


def _message(pair: FieldPair) -> str:
    message = f"field number {pair.new.number} was {pair.old.name!r} and is now {pair.new.name!r}"
    if names_another_field(pair):
        return f"{message}, which had another number: old values of {pair.old.name!r} are read as {pair.new.name!r}"
    return f"{message}: old values of {pair.old.name!r} are read as {pair.new.name!r}"
