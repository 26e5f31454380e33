"""Options that select the .proto files to check, and the start of the checks, for lint, number history and number next.

These commands check a project with a table (mapping.yaml), or a folder of .proto files without a table.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from roverlink.console import OK, UNABLE, add_table, table_file
from roverlink.diagnostic_text import Sources, show
from roverlink.generator.diagnostics import Severity
from roverlink.generator.git import Repository
from roverlink.reports.reported import Reported
from roverlink.runtime.core.errors import SetupError

if TYPE_CHECKING:  # slow to import
    from roverlink.generator.lint.project import Linted, Question

# Field numbers have at most nine digits (2**29 - 1), enum values ten and a sign (int32).
_NUMBER = re.compile(r"(?:\.?(?P<owner>[A-Za-z_][\w.]*):(?=.)|(?=[0-9]))(?P<number>-?[0-9]{1,10})")


def add_subject(parser: argparse.ArgumentParser) -> None:
    """Add the options that select what to check to a parser: the table, or a folder of .proto files without a table."""
    parser.add_argument(
        "root",
        nargs="?",
        type=Path,
        metavar="PROTO_ROOT",
        help="folder of .proto files to check; give it only if there is no mapping.yaml",
    )
    add_table(parser)
    parser.add_argument(
        "--envelope",
        default="",
        metavar="FILE",
        help="with --message: check that this .proto file declares the envelope; the path is relative to PROTO_ROOT. "
        "The envelope is found without it",
    )
    parser.add_argument(
        "--message",
        default="",
        metavar="NAME",
        help="with PROTO_ROOT: name of the envelope (the protobuf message that holds each payload in a oneof), such as "
        "PBEnvelope; without it, the rules about payloads do not run",
    )


def type_and_number(text: str) -> tuple[str, int]:
    """Parse an argument that is a number of the envelope, or the number of a message or enum: ``rover.ImuInfo:3``.

    Return the name of the message or enum, which is empty for the envelope, and the number.
    """
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number, such as 18 or rover.ImuInfo:3")
    return match["owner"] or "", int(match["number"])


def linted(arguments: argparse.Namespace, question: Question) -> Linted:
    """Check the folder of .proto files that the options name, or else the project of the table.

    ``question`` holds the additional checks that the user requests, such as that of git's history. Raises `SetupError`
    if the options name an envelope, but no folder of .proto files.
    """
    from roverlink.generator.lint.bare_tree import EnvelopeName
    from roverlink.generator.lint.project import lint_project, lint_tree

    root: Path | None = arguments.root
    if root is None and (arguments.envelope or arguments.message):
        raise SetupError(
            "--envelope and --message need PROTO_ROOT, a folder of .proto files without mapping.yaml; write it right "
            "after the command, before options that take several values"
        )
    if root is None:
        return lint_project(table_file(arguments.table), question)
    return lint_tree(root, EnvelopeName(arguments.envelope, arguments.message), question)


def folder_of(arguments: argparse.Namespace) -> Path:
    """Return the folder to which the paths in diagnostics are relative.

    It is the folder of .proto files that the options name, or else the folder of the table.
    """
    root: Path | None = arguments.root
    return root or table_file(arguments.table).parent


def sources(found: Linted) -> Sources:
    """Return access to the source files that the diagnostics of a check name."""
    return Sources(found.folder, found.texts, found.commit_of)


def reported(found: Linted) -> Reported:
    """Return the findings of a check for the output formats."""
    from roverlink.generator.lint.rules import lint_rules

    pinned = found.context.past.pinned if found.context.past else None
    return Reported("roverlink lint", found.findings, sources(found), lint_rules(), pinned)


def print_limits(found: Linted, owner: str) -> int:
    """Print the diagnostics because of which an answer about a message or enum may be incomplete, on standard error.

    An example is a shallow clone. ``owner`` is the full name of the message or enum. Return the exit code: 2 if one of
    these diagnostics is fatal, else 0. Commands that print no other diagnostics of the check call this function.
    """
    limits = found.limits(owner)
    show(limits, sources(found), sys.stderr)
    return UNABLE if any(finding.severity is Severity.FATAL for finding in limits) else OK


def in_repository(folder: Path) -> bool:
    """Return true if the folder is in a git repository whose history can be read."""
    return Repository(folder).exists()
