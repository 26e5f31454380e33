"""``roverlink next-number``: the number for the next payload."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from generator.findings import FindingsError
from generator.linting import Question
from generator.subject import Subject
from roverlink.console import OK, UNABLE, Subparsers, command, table_file
from roverlink.linted import add_subject, in_repository, linted
from roverlink.progress import progress


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "next-number",
        "print the envelope number for the next payload, and why others are skipped",
        "roverlink next-number",
        "Print the smallest number above those of today that nothing ever had: not the table, the ledger, what is\n"
        "reserved or commented out, git's history, or another branch. Why others are skipped goes to standard error.",
    )
    add_subject(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the number."""
    try:
        with progress("reading history") as report:
            question = Question(branches=in_repository(_folder(arguments)), report=report)
            subject = linted(arguments, arguments.root, question).subject
    except FindingsError as error:
        print(error, file=sys.stderr)
        return UNABLE
    number = subject.next_number()
    say_skipped(subject, number)
    if subject.past is None:
        print("there is no git repository here, so that the history was not looked at", file=sys.stderr)
    print(number)
    return OK


def say_skipped(subject: Subject, number: int) -> None:
    """Say on standard error why the numbers before one are not given."""
    taken = subject.taken()
    for skipped in range(subject.largest_number() + 1, number):
        if skipped in taken:
            print(f"{skipped} {taken[skipped]}", file=sys.stderr)


def _folder(arguments: argparse.Namespace) -> Path:
    root: Path | None = arguments.root
    return root or table_file(arguments.table).parent
