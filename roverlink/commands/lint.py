"""``roverlink lint``: check the table and the .proto files, also against an earlier state and git's history."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from roverlink.console import FINDINGS, OK, UNABLE, Subparsers, command, table_file
from roverlink.diagnostic_text import show_error
from roverlink.generator.diagnostics import DiagnosticsError, Severity
from roverlink.generator.lint.project import Linted, Question
from roverlink.lint_scope import add_subject, folder_of, linted
from roverlink.progress import progress
from roverlink.reports import FORMATS
from roverlink.runtime.core.errors import SetupError

_COUNTED = ("error", "warning", "hint")


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "lint",
        "find reused numbers and other mistakes that make two machines misread each other",
        "roverlink lint --against main",
        "Find mistakes that make two machines misread each other, such as an envelope number that was given to a\n"
        "second payload. Use it before a commit and in CI. The command checks mapping.yaml, the .proto files and the\n"
        "ledger (mapping.lock, which lists every number that was ever published). With --against, it also checks the\n"
        "changes since an earlier state. With --history, it also checks all commits in git.\n\n"
        "Each finding has a place, a severity, the ID of a rule and a message, for example\n"
        "`mapping.yaml:19:12: error[ENV101] ...`. `roverlink explain ENV101` describes the rule.\n\n"
        "Exit code 0: there is no finding, or only findings that are less severe than --fail-on; 1: there are\n"
        "findings; 2: a check could not run.",
    )
    add_subject(parser)
    parser.add_argument(
        "--against",
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
        action="store_true",
        help="with --history: write the reused numbers that were found into mapping.lock, so that lint does not report "
        "them again",
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
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the checks, print the findings, and return the exit code."""
    try:
        found = _lint(arguments)
        if arguments.accept:
            return _accept(arguments, found)
    except DiagnosticsError as error:
        show_error(error, folder_of(arguments), sys.stderr)
        return UNABLE
    FORMATS[arguments.format](found)
    severities = {finding.severity for finding in found.findings}
    if Severity.FATAL in severities:
        return UNABLE
    limit = Severity(arguments.fail_on).rank
    return FINDINGS if any(severity.rank <= limit for severity in severities) else OK


def _lint(arguments: argparse.Namespace) -> Linted:
    of_history = Path(arguments.history) if arguments.history and Path(arguments.history).is_dir() else None
    newest = "" if of_history else arguments.history or ""
    if newest and arguments.accept:
        raise SetupError(f"--accept writes down the state on disk; leave out '{newest}' after --history")
    if of_history is not None and arguments.root is not None:
        raise SetupError(
            f"two folders of .proto files are given, '{arguments.root}' and '{of_history}'; give only one of them"
        )
    if arguments.with_buf and not arguments.against:
        raise SetupError("--with-buf compares two states; name the earlier state with --against")
    root = of_history or arguments.root
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
        return linted(arguments, root, question)


def _accept(arguments: argparse.Namespace, found: Linted) -> int:
    """Write the reused numbers that the check of git's history has found to the ledger (mapping.lock).

    Write the other generated files, too, print the changed files, and return the exit code.
    """
    # Imported here: a plain lint does not need the slow import of the emitter.
    from roverlink.generator.accept import accept
    from roverlink.generator.emit.writer import write

    changes, accepted = accept(table_file(arguments.table), found)
    write(found.folder, changes)
    for change in changes:
        print(f"{change.verb:>8} {change.path}")
    print(
        f"accepted {accepted} reused numbers from the history: they are in mapping.lock, and lint reports them no more"
    )
    return OK
