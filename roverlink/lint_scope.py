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
        "--exclude",
        type=not_empty,
        action="append",
        default=[],
        metavar="FILE",
        help="with PROTO_ROOT: leave out this .proto file, for example because it clashes with others; the path "
        "is relative to PROTO_ROOT; may be repeated",
    )
    parser.add_argument(
        "--envelope",
        type=not_empty,
        metavar="FILE",
        help="with --message: check that this .proto file declares the envelope; the path is relative to PROTO_ROOT. "
        "The envelope is found without it",
    )
    parser.add_argument(
        "--message",
        type=not_empty,
        metavar="NAME",
        help="with PROTO_ROOT: name of the envelope (the protobuf message that holds each payload in a oneof), such as "
        "PBEnvelope; without it, the rules about payloads do not run",
    )


def not_empty(text: str) -> str:
    """Parse an argument that must not be empty, because an empty one would turn a check off."""
    if not text.strip():
        raise argparse.ArgumentTypeError("the value is empty; is a variable of the CI server not set?")
    return text


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
    from roverlink.generator.lint.bare_tree import TreeOptions
    from roverlink.generator.lint.project import lint_project, lint_tree

    root: Path | None = arguments.root
    if root is None and (arguments.envelope or arguments.message or arguments.exclude):
        raise SetupError(
            "--envelope, --message and --exclude need PROTO_ROOT, a folder of .proto files without mapping.yaml; "
            "write it right after the command, before options that take several values"
        )
    if root is None:
        return lint_project(table_file(arguments.table), question)
    return lint_tree(
        root, TreeOptions(arguments.envelope or "", arguments.message or "", tuple(arguments.exclude)), question
    )


def folder_of(arguments: argparse.Namespace) -> Path:
    """Return the folder to which the paths in diagnostics are relative.

    It is the folder of .proto files that the options name, or else the folder of the table.
    """
    root: Path | None = arguments.root
    return root or table_file(arguments.table).parent


def sources(found: Linted) -> Sources:
    """Return access to the source files that the diagnostics of a check name."""
    return Sources(found.folder, found.texts, found.commit_of)


def reported(found: Linted, *, with_known: bool = False) -> Reported:
    """Return the findings of a check for the output formats, which show the known ones only ``with_known``."""
    from roverlink.generator.lint.rules import lint_rules

    pinned = found.context.past.pinned if found.context.past else None
    return Reported("roverlink lint", found.findings, sources(found), lint_rules(), pinned, with_known=with_known)


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
