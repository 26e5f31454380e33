"""Print the envelope number for the next payload, and why other numbers are skipped.

Print the number for the next payload of the envelope, the protobuf message that holds each payload in a
oneof. Use it if you write a row of mapping.yaml yourself; `roverlink add` uses this number on its own.

The number is greater than all numbers in use, and it was never used before: it is not in mapping.yaml or
mapping.lock, not reserved or commented out in the envelope, not in git's history, and not on another
branch. If numbers are skipped, the reasons are printed on standard error.

Example: roverlink number next
"""

from __future__ import annotations

import argparse

from roverlink.console import UNABLE, Subparsers, documented_command, print_note
from roverlink.diagnostic_text import show_error
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.ir.protobuf_facts import LARGEST_FIELD_NUMBER
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.project import Question
from roverlink.lint_scope import add_subject, folder_of, in_repository, linted, print_limits
from roverlink.progress import progress


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_subject(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the next number on standard output, and the reasons for skipped numbers on standard error."""
    try:
        with progress("reading history") as report:
            question = Question(branches=in_repository(folder_of(arguments)), envelope=True, report=report)
            found = linted(arguments, question)
    except DiagnosticsError as error:
        show_error(error, folder_of(arguments))
        return UNABLE
    code = print_limits(found, found.context.table.envelope.message)
    if found.context.past is None:
        print_note("not a git repository, so the history was not checked")
    envelope, schema = found.context.table.envelope, found.context.schema
    if envelope.message in schema.messages and not envelope.oneof:
        print_note(f"{envelope.message!r} has no oneof, so all its fields count as payloads")
    print_skipped(found.context)
    number = found.context.next_number()
    if number > LARGEST_FIELD_NUMBER:
        print_note(f"no number is left: numbers end at {LARGEST_FIELD_NUMBER}")
        return UNABLE
    print(number)
    return code


def print_skipped(context: Context) -> None:
    """Print on standard error the numbers skipped before the next free one, each with the reason: ``14 is retired``."""
    largest, number = context.largest_number(), context.next_number()
    for start in [largest + 1] if number > largest else [largest + 1, 1]:
        for first, last, why in context.occupied(start):
            print_note(f"{first if first == last else f'{first} to {last}'} {why}")
