"""What the commands of the lint share: which project or tree is meant."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from roverlink.console import OK, UNABLE, add_table, table_file
from roverlink.diagnostic_text import Sources, show
from roverlink.generator.diagnostics import Severity
from roverlink.generator.git import Repository
from roverlink.generator.lint.bare_tree import EnvelopeName
from roverlink.generator.lint.project import Linted, Question, lint_project, lint_tree
from roverlink.runtime.core.errors import SetupError


def add_subject(parser: argparse.ArgumentParser) -> None:
    """The options that say what is looked at: a table, or a tree of .proto files without one."""
    parser.add_argument(
        "root", nargs="?", type=Path, metavar="PROTO_ROOT", help="a tree of .proto files that has no mapping.yaml"
    )
    add_table(parser)
    parser.add_argument("--envelope", default="", metavar="FILE", help="the envelope's file, in a tree without table")
    parser.add_argument("--message", default="", metavar="NAME", help="the envelope's message, in a tree without table")


def linted(arguments: argparse.Namespace, root: Path | None, question: Question) -> Linted:
    """The lint of the tree, or of the table's project. Raises `SetupError` where an envelope is named, and no tree."""
    if root is None and (arguments.envelope or arguments.message):
        raise SetupError("--envelope and --message are for a tree without mapping.yaml: name its folder, too")
    if root is None:
        return lint_project(table_file(arguments.table), question)
    return lint_tree(root, EnvelopeName(arguments.envelope, arguments.message), question)


def folder_of(arguments: argparse.Namespace) -> Path:
    """Return the folder from which diagnostics name their files: the tree, or that of the table."""
    root: Path | None = arguments.root
    return root or table_file(arguments.table).parent


def sources(found: Linted) -> Sources:
    """Return the files that the diagnostics of a lint name."""
    return Sources(found.folder, commit_of=found.commit_of)


def say_limits(found: Linted) -> int:
    """Say on standard error what was not looked at, for commands that show no other finding; their exit code."""
    show(found.limits, sources(found), sys.stderr)
    return UNABLE if any(finding.severity is Severity.FATAL for finding in found.limits) else OK


def in_repository(folder: Path) -> bool:
    """Whether there is a git repository whose history can be read."""
    return Repository(folder).exists()
