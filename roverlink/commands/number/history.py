"""Show every payload that has or had a number in the envelope, with the first and the last commit of each.

Show every payload that has or had the number NUMBER, or that of the row ROW of mapping.yaml, in the
envelope (the protobuf message that holds each payload in a oneof); or every field or value that has or had
a number of another message or of an enum. The command reads all commits of all branches in git. Use it if
`roverlink lint` reports a reused number, or to find out which payload an old recording or an old firmware
means.

For each payload, the output has its type and name, then the commits that added and removed it, and the
branches that still have it. Exit code 1: no commit ever used the number.

Example: roverlink number history 18
"""

from __future__ import annotations

import argparse
from posixpath import normpath

from roverlink.completion import complete, numbers, rows
from roverlink.console import FINDINGS, UNABLE, Subparsers, documented_command
from roverlink.diagnostic_text import show_error
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.git import Repository
from roverlink.generator.lint.history import History, Usage, whereabouts
from roverlink.generator.lint.project import Question
from roverlink.generator.table import Table
from roverlink.lint_scope import add_subject, folder_of, linted, print_limits, type_and_number
from roverlink.numerals import counted
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError
from roverlink.suggestions import nearest, nearest_names


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    number = parser.add_argument(
        "number",
        type=_row_or_number,
        metavar="NUMBER|ROW|TYPE:NUMBER",
        help="number of a payload in the envelope, or the name of its row; for a number of another message or of an "
        "enum, write its name first: rover.ImuInfo:3",
    )
    complete(number, numbers, rows)
    add_subject(parser)
    parser.set_defaults(run=run)


def _row_or_number(text: str) -> tuple[str, int | str]:
    """Parse the argument like `type_and_number`; for the name of a row, return an empty text and the name."""
    return ("", text) if text.isidentifier() else type_and_number(text)


def run(arguments: argparse.Namespace) -> int:
    """Print the payloads, fields or values that a number has had. The exit code is 1 if it has had none."""
    named, wanted = arguments.number
    try:
        with progress("reading history") as report:
            question = Question(history=True, envelope=not named, report=report)
            found = linted(arguments, question)
    except DiagnosticsError as error:
        show_error(error, folder_of(arguments))
        return UNABLE
    context = found.context
    owner = named or context.table.envelope.message
    code = print_limits(found, owner)
    if context.past is None:
        return UNABLE
    history = context.past.history
    number = wanted if isinstance(wanted, int) else _number_of(wanted, context.table)
    if named and not history.files(named):
        raise SetupError(f"no commit and no file declares a message or enum {named!r}; {_known(named, history)}")
    usages, claims = history.numbers(owner).get(number, ()), history.claims(owner).get(number, ())
    if not usages and not claims:
        print(f"{owner} never used the number {number} in {counted(history.commits, 'commit')}")
        return max(code, FINDINGS)
    folder = Repository(found.folder / context.table.proto.root).prefix()
    for usage in usages:
        _print_usage(usage, f"{usage.type} {usage.name}".strip(), folder)
    for usage in claims:
        _print_usage(usage, f"in a comment: {usage.type} {usage.name}".strip(), folder)
    burned = context.ledger.burned_in(owner).get(number)
    if burned:
        print(f"accepted{': ' if burned.reason else ''}{burned.reason}")
    return code


def _number_of(name: str, table: Table) -> int:
    """Return the number of a row of the table, or of a retired row. Raises `SetupError` if there is none."""
    found = {row.name: row.number for row in table.retired} | {row.name: row.number for row in table.rows}
    if name not in found:
        hint = nearest(name, found) if found else "give the number"
        raise SetupError(f"no row of mapping.yaml is named {name!r}; {hint}")
    return found[name]


def _known(name: str, history: History) -> str:
    """Return a hint for an unknown message or enum: the names that are similar, or else all."""
    known = (*history.messages, *history.enums)
    similar = nearest_names(name, known)
    return f"did you mean {' or '.join(map(repr, similar))}?" if similar else nearest(name, known)


def _print_usage(usage: Usage, what: str, folder: str) -> None:
    """Print the commits of a usage. ``folder`` is the path of the proto root in the repository."""
    print(what)
    for interval in usage.intervals:
        print(f"  added {interval.came} ({normpath(folder + interval.path)}:{interval.line})")
        for went in interval.went:
            print(f"  removed {went}")
    if usage.live_at:
        print(f"  exists {whereabouts(usage.live_at)}")
