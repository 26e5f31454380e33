"""Find reused numbers and other mistakes that make two machines misread each other.

Find mistakes that make two machines misread each other, such as an envelope number that was given to a
second payload. Use it before a commit and in CI. The command checks mapping.yaml, the .proto files and the
ledger (mapping.lock, which lists every number that was ever published). With --against, it also checks the
changes since an earlier state. With --history, it also checks all commits in git.

Each finding has a place, a severity, the ID of a rule and a message, for example
`mapping.yaml:19:12: error[ENV101] ...`. `roverlink explain ENV101` describes the rule.

Exit code 0: there is no finding, or only findings that are less severe than --fail-on; 1: there are
findings; 2: a check could not run.

Example: roverlink lint --against main
"""

from __future__ import annotations

import argparse
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from roverlink.console import FINDINGS, OK, UNABLE, Subparsers, documented_command, table_file
from roverlink.generator.diagnostics import DiagnosticsError, Severity, shown
from roverlink.generator.known_results import KnownResult
from roverlink.generator.ledger_names import ACCEPTED, LEDGER
from roverlink.lint_scope import add_subject, folder_of, linted, not_empty, reported, type_and_number
from roverlink.numerals import counted
from roverlink.progress import progress
from roverlink.reports import FORMATS, NO_PROBLEMS
from roverlink.runtime.core.errors import SetupError

if TYPE_CHECKING:  # slow to import
    from roverlink.generator.lint.project import Linted
    from roverlink.generator.lock import Settled

    _Wanted: TypeAlias = tuple[list[tuple[str, int]], list[Settled]]

_COUNTED = ("error", "warning", "hint")
_RULE = re.compile(r"(?P<rule>[A-Z]{3}[0-9]{3})(?::(?P<subject>.*[^0-9].*))?")


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_subject(parser)
    parser.add_argument(
        "--against",
        type=not_empty,
        metavar="STATE",
        help="earlier state to compare with: a git ref (branch, tag or commit), a folder, or a file with a descriptor "
        "set of protoc",
    )
    parser.add_argument(
        "--with-buf",
        action="store_true",
        help="with --against: run also the program buf, which must be installed; it finds changes that break generated "
        "code or JSON",
    )
    parser.add_argument(
        "--history",
        nargs="?",
        const="",
        metavar="REF|PROTO_ROOT",
        help="check also every commit in git's history, on all branches, up to the changes that are not committed yet. "
        "REF is a branch, tag or commit whose state is checked instead of the files on disk. PROTO_ROOT may be given "
        "here instead of at the end",
    )
    parser.add_argument(
        "--branches",
        action="store_true",
        help="find numbers of the envelope, and of all messages and enums in it, that two unmerged branches of this "
        "repository give to different things",
    )
    parser.add_argument(
        "--pins",
        nargs="+",
        type=Path,
        default=[],
        metavar="FILE|REPO",
        help="find numbers of the envelope, and of all messages and enums in it, that have different meanings in two "
        "projects or here, because the projects use different commits of the .proto files; also print which projects "
        "misread each other. REPO is the folder of a project; the commit is read from its submodules or from GIT_TAG "
        "in CMake. FILE is a text file with a line `project commit` for each project",
    )
    parser.add_argument(
        "--accept",
        nargs="*",
        action="extend",
        metavar="NUMBER|TYPE:NUMBER|RULE|RULE:TYPE",
        help="with --history: state that the earlier meanings of a reused number are known: it was only renamed, or "
        "does no harm. lint then reports only further meanings. NUMBER is a number of the envelope; for a number of "
        "another message or of an enum, write its full name first: rover.ImuInfo:3. Without a number, everything that "
        "--history reports is accepted. The numbers are written into mapping.lock, or for a PROTO_ROOT without a table "
        f"into the file {ACCEPTED} in it; commit this file. There, also without --history: RULE, such as "
        "NAM103, makes all findings of the rule hints; RULE:TYPE or RULE:FILE only those about a type or a file",
    )
    parser.add_argument(
        "--reason",
        metavar="TEXT",
        help="with --accept: why they are accepted; one line for the readers of the file",
    )
    parser.add_argument(
        "--format", choices=FORMATS, default="text", help="format of the findings (default: %(default)s)"
    )
    parser.add_argument(
        "--fail-on",
        choices=_COUNTED,
        default="warning",
        help="lowest severity that gives exit code 1 (default: %(default)s)",
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help="show also the known problems: those that the state of --against has already, or that were accepted",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the checks, print the findings, and return the exit code."""
    wanted = _wanted(arguments)
    if arguments.history and Path(arguments.history).is_dir():
        if arguments.root is not None:
            raise SetupError(
                f"two folders of .proto files are given, '{arguments.root}' and '{arguments.history}'; "
                "give only one of them"
            )
        arguments.root, arguments.history = Path(arguments.history), ""
    known = KnownResult(table_file(arguments.table), "lint") if _is_plain(arguments) else None
    if known and known.value:
        print(NO_PROBLEMS)
        return OK
    try:
        found = _lint(arguments)
        if wanted is not None:
            return _accept(arguments, found, wanted)
    except DiagnosticsError as error:
        from roverlink.generator.lint.project import not_linted

        FORMATS[arguments.format](reported(not_linted(error, folder_of(arguments))))
        return UNABLE
    FORMATS[arguments.format](reported(found, with_known=arguments.all))
    if known and not found.findings:
        known.save(found.context.table.proto.root, True)
    severities = {finding.severity for finding in found.findings if not finding.known}
    if Severity.FATAL in severities:
        return UNABLE
    limit = Severity(arguments.fail_on).rank
    return FINDINGS if any(severity.rank <= limit for severity in severities) else OK


def _is_plain(arguments: argparse.Namespace) -> bool:
    """Return True if the command checks the files on disk of a project with a table, and nothing else."""
    # A hook of `git commit` checks the index of git. Each option here names something else to check or to do.
    others = ("root", "exclude", "envelope", "message", "with_buf", "branches", "pins")
    asked = any(getattr(arguments, name) for name in others) or "GIT_INDEX_FILE" in os.environ
    past = arguments.against is arguments.history is arguments.accept is None
    return not asked and past and arguments.format == "text"


def _lint(arguments: argparse.Namespace) -> Linted:
    from roverlink.generator.lint.project import Question  # here: it is slow to import

    newest = arguments.history or ""
    if newest and arguments.accept is not None:
        raise SetupError(f"--accept writes down the state on disk; leave out '{newest}' after --history")
    if arguments.with_buf and not arguments.against:
        raise SetupError("--with-buf compares two states; name the earlier state with --against")
    with progress("reading history") as report:
        question = Question(
            against=arguments.against,
            with_buf=arguments.with_buf,
            history=arguments.history is not None,
            newest=newest,
            branches=arguments.branches,
            pins=tuple(arguments.pins),
            report=report,
        )
        return linted(arguments, question)


def _wanted(arguments: argparse.Namespace) -> _Wanted | None:
    """Return the numbers after --accept, each with the full name of its message or enum, and the rules.

    The name may be empty. Returns None without --accept. Raises `SetupError` for a word that is none of both.
    """
    if arguments.reason is not None:
        if arguments.accept is None:
            raise SetupError("--reason says why numbers or rules are accepted; name them with --accept")
        arguments.reason = " ".join(arguments.reason.split())
        if not arguments.reason.isprintable() or not arguments.reason:
            raise SetupError("--reason needs a text of printable characters")
    if arguments.accept is None:
        return None
    from roverlink.generator.lock import Settled  # here: it is slow to import

    rules = [(word, match) for word in arguments.accept if (match := _RULE.fullmatch(word))]
    settled = [Settled(match["rule"], match["subject"] or "") for _, match in rules]
    try:
        return [type_and_number(word) for word in arguments.accept if word not in dict(rules)], settled
    except argparse.ArgumentTypeError as error:
        raise SetupError(f"--accept: {error}; write a folder of .proto files before --accept") from error


def _accept(arguments: argparse.Namespace, found: Linted, wanted: _Wanted) -> int:
    """Write the reused numbers that the check of git's history has found, or rules, to the ledger.

    In a project with a table, write the other generated files, too. Print the changed files, and return the exit code.
    """
    # Imported here: a plain lint does not need the slow import of the emitter.
    from roverlink.generator.accept import accept
    from roverlink.generator.emit.writer import write

    table = None if found.context.tree else table_file(arguments.table)
    numbers, rules = wanted
    changes, count = accept(table, found, numbers, rules, arguments.reason or "")
    write(found.folder, changes)
    for change in changes:
        print(f"{change.verb:>8} {shown(found.context.tree, change.path)}")
    ledger = ACCEPTED if table is None else LEDGER
    for settled in rules:
        about = f" about {settled.subject}" if settled.subject else ""
        print(f"{settled.rule} accepted in {ledger}; from now on, findings{about} are hints")
    if numbers or not rules:
        print(
            f"{counted(count, 'reused number')} accepted in {ledger}; from now on, lint reports only further meanings"
        )
    return OK
