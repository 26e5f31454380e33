"""What the commands of the lint share: which project or tree is meant, and how long work shows that it goes on."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from generator.findings import Severity
from generator.git import Repository
from generator.linting import Linted, Question, lint_project, lint_tree
from generator.tree import EnvelopeName
from roverlink.console import OK, UNABLE, add_table, table_file
from runtime.errors import SetupError

Report = Callable[[int, int], None]


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


def say_limits(found: Linted) -> int:
    """Say on standard error what was not looked at, for commands that show no other finding; their exit code."""
    for finding in found.limits:
        print(finding.render(), file=sys.stderr)
    return UNABLE if any(finding.severity is Severity.FATAL for finding in found.limits) else OK


def in_repository(folder: Path) -> bool:
    """Whether there is a git repository whose history can be read."""
    return Repository(folder).exists()


@contextmanager
def progress(what: str) -> Iterator[Report]:
    """A bar on a terminal, which goes when it is full; nothing elsewhere."""
    with Progress(console=Console(file=sys.stderr), transient=True, disable=not sys.stderr.isatty()) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
