"""What the commands of the lint share: which project or tree is meant."""

from __future__ import annotations

import argparse
from pathlib import Path

from generator.git import GitError, Repository
from generator.linting import Linted, Question, lint_project, lint_tree
from generator.tree import EnvelopeName
from roverlink.console import add_table, table_file


def add_subject(parser: argparse.ArgumentParser) -> None:
    """The options that say what is looked at: a table, or a tree of .proto files without one."""
    parser.add_argument(
        "root", nargs="?", type=Path, metavar="PROTO_ROOT", help="a tree of .proto files that has no mapping.yaml"
    )
    add_table(parser)
    parser.add_argument("--envelope", default="", metavar="FILE", help="the envelope's file, in a tree without table")
    parser.add_argument("--message", default="", metavar="NAME", help="the envelope's message, in a tree without table")


def linted(arguments: argparse.Namespace, root: Path | None, question: Question) -> Linted:
    """The lint of the tree, or of the table's project."""
    if root is None:
        return lint_project(table_file(arguments.table), question)
    return lint_tree(root, EnvelopeName(arguments.envelope, arguments.message), question)


def in_repository(folder: Path) -> bool:
    """Whether there is a git repository whose history can be read."""
    try:
        Repository(folder).resolve("HEAD")
    except GitError:
        return False
    return True
