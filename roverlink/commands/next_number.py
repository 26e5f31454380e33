"""``roverlink next-number``: the number for the next payload."""

from __future__ import annotations

import argparse
import sys

from generator.findings import FindingsError
from generator.git import GitError, Repository
from generator.linting import Question
from roverlink.console import OK, UNABLE, Subparsers, command, table_file
from roverlink.linted import add_subject, linted, progress


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
            question = Question(branches=_in_repository(arguments), report=report)
            subject = linted(arguments, arguments.root, question).subject
    except FindingsError as error:
        print(error, file=sys.stderr)
        return UNABLE
    number, taken = subject.next_number(), subject.taken()
    for skipped in range(subject.largest_number() + 1, number):
        if skipped in taken:
            print(f"{skipped} {taken[skipped]}", file=sys.stderr)
    if subject.past is None:
        print("there is no git repository here, so that the history was not looked at", file=sys.stderr)
    print(number)
    return OK


def _in_repository(arguments: argparse.Namespace) -> bool:
    try:
        Repository(arguments.root or table_file(arguments.table).parent).resolve("HEAD")
    except GitError:
        return False
    return True
