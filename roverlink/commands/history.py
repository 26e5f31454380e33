"""``roverlink history``: the life of a number."""

from __future__ import annotations

import argparse
import sys

from generator.diagnostics import DiagnosticsError
from generator.history import Life
from generator.linting import Question
from generator.retrospect import branch
from roverlink.console import FINDINGS, UNABLE, Subparsers, command, count
from roverlink.diagnostic_text import show_error
from roverlink.linted import add_subject, folder_of, linted, say_limits
from roverlink.progress import progress


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "history",
        "tell the life of one envelope number: what it stood for, from which commit to which",
        "roverlink history 18",
    )
    parser.add_argument("number", type=count, metavar="NUMBER", help="the number in the envelope")
    add_subject(parser)
    parser.add_argument(
        "--of", metavar="MESSAGE", help="the number of a field of this message, or of a value of this enum"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print its life; exit code 1 where it has none."""
    try:
        with progress("reading history") as report:
            question = Question(history=True, envelope=not arguments.of, report=report)
            found = linted(arguments, arguments.root, question)
    except DiagnosticsError as error:
        show_error(error, folder_of(arguments), sys.stderr)
        return UNABLE
    subject, code = found.subject, say_limits(found)
    if subject.past is None:
        return UNABLE
    owner = arguments.of or subject.table.envelope.message
    history = subject.past.history
    lives, claims = history.numbers(owner).get(arguments.number, ()), history.claims(owner).get(arguments.number, ())
    if not lives and not claims:
        print(f"{owner} never had the number {arguments.number} in {history.commits} commits")
        return max(code, FINDINGS)
    for life in lives:
        _tell(life, f"{life.type} {life.name}".strip())
    for life in claims:
        _tell(life, f"in a comment: {life.type} {life.name}".strip())
    return code


def _tell(life: Life, what: str) -> None:
    print(what)
    for interval in life.intervals:
        print(f"  came {interval.came} ({interval.path}:{interval.line})")
        for went in interval.went:
            print(f"  went {went}")
    if life.live_at:
        print(f"  is on {', '.join(branch(ref) for ref in life.live_at)}")
