"""A field takes a number that a comment in the same message names for another field.

A field that is commented out was often in use once, or is in use on another branch. Boards may still send it, and the
rover would read its value as the new field. A comment does not protect a number, but `reserved` does.

Bad::

    message SensorBoardWind {
      // uint32 gust = 3;
      uint32 direction = 3;
    }

Good::

    message SensorBoardWind {
      reserved 3;
      reserved "gust";
      uint32 direction = 4;
    }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.protos.schema import ProtoMessage

RULE = Rule("ENV109", "field-number-claimed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field whose number a comment gives to another field.

    The envelope is left out, because another rule checks its members.
    """
    for path, file in context.files.items():
        for message in file.messages:
            if message.claims and message.full_name != context.table.envelope.message:
                yield from _check(path, message, context)


def _check(path: str, declared: ProtoMessage, context: Context) -> Iterator[Diagnostic]:
    compiled = context.schema.messages.get(declared.full_name) if context.schema else None
    fields = compiled.fields if compiled and compiled.file == path else ()
    for field in fields:
        for claim in declared.claims:
            if claim.number == field.number and claim.name != field.name:
                message = f"{field.name!r} takes number {field.number}, which a comment declares for {claim.name!r}"
                help = f"take another number and reserve {field.number}, or delete the comment if it is wrong"
                also = [(context.place(path, claim.span.line, claim.span.column), "in this comment")]
                span = field.at("number")
                yield RULE.at(span, message, help, also, type=declared.full_name, number=field.number)
