"""Rules about numbers that a comment in a .proto file names for something else."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.schema import ProtoField, ProtoMessage
from roverlink.generator.table import Numbered


class NumberClaimed(LintRule, id="ENV108", severity=Severity.WARNING):
    """A payload takes a number that a comment in the envelope names for another payload.

    A member that is commented out was often in use once, or is in use on another branch. Boards may still send it. Ask
    the author of the comment before you use the number.

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

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row or signature whose number a comment gives to another payload."""
        claims = list(context.envelope_claims())
        for row in context.table.numbered:
            for claim, span in claims:
                if claim.number == row.number and not _is_same_payload(claim, row):
                    claimed = f"{claim.name!r} ({claim.type})"
                    message = f"{row.name!r} takes field {row.number}, which a comment declares for {claimed}"
                    help = f"give {row.name!r} the number {context.next_number()}, or delete the comment if it is wrong"
                    also = [(span, "in this comment")]
                    yield cls.of_row(context.table, row, "number", message, help, also)


def _is_same_payload(claim: ProtoField, row: Numbered) -> bool:
    return claim.name == row.name or claim.type.rpartition(".")[2] == row.proto.rpartition(".")[2]


class FieldNumberClaimed(LintRule, id="ENV109", severity=Severity.WARNING):
    """A field takes a number that a comment in the same message names for another field.

    A field that is commented out was often in use once, or is in use on another branch. Boards may still send it, and
    the rover would read its value as the new field. A comment does not protect a number, but `reserved` does.

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

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each field whose number a comment gives to another field.

        The envelope is left out, because another rule checks its members.
        """
        for path, file in context.files.items():
            for message in file.messages:
                if message.claims and message.full_name != context.table.envelope.message:
                    yield from _claimed_fields(path, message, context)


def _claimed_fields(path: str, declared: ProtoMessage, context: Context) -> Iterator[Diagnostic]:
    compiled = context.schema.messages.get(declared.full_name)
    fields = compiled.fields if compiled and compiled.file == path else ()
    for field in fields:
        for claim in declared.claims:
            if claim.number == field.number and claim.name != field.name:
                message = f"{field.name!r} takes number {field.number}, which a comment declares for {claim.name!r}"
                help = f"take another number and reserve {field.number}, or delete the comment if it is wrong"
                also = [(context.place(path, claim.span.line, claim.span.column), "in this comment")]
                span = field.at("number")
                yield FieldNumberClaimed.at(span, message, help, also, type=declared.full_name, number=field.number)
