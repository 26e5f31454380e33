"""Start a project in this folder, with an example board or from existing .proto files.

Start a project in this folder. A project has a table, mapping.yaml, with a row for each message that the
bridge converts between protobuf and ROS 2. At the end, the command prints the next steps.

Without --from, the command writes mapping.yaml with one message of one board and its .proto file, and runs
`roverlink generate`. It also writes a GitHub workflow, a configuration for pre-commit and a .gitignore file.

With --from, the project starts with your .proto files. One of them declares the envelope, the protobuf
message that holds each payload in a oneof. mapping.yaml gets a row for each member of this oneof. Values
that the command had to guess have the comment `guessed`. If a message with a oneof is inside another one,
the outermost one is the envelope. Files that do not compile together with the others
are excluded. Numbers that git's history used and the envelope no longer uses are retired. Your .proto files
do not change, with one exception: if the envelope's file contains nothing but the envelope,
`roverlink generate` overwrites it from now on.

Example: roverlink init
         roverlink init --from proto --envelope components/common/envelope.proto --message PBEnvelope
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Collection, Iterable
from pathlib import Path

from roverlink.console import (
    FINDINGS,
    OK,
    TABLE,
    UNABLE,
    Subparsers,
    documented_command,
    finish_interrupted,
    print_note,
)
from roverlink.diagnostic_text import Sources, show_error, show_without_hints
from roverlink.generator.adopt import Adoption, AdoptionRequest, adopt
from roverlink.generator.diagnostics import DiagnosticsError, Severity
from roverlink.generator.emit.writer import Change, write
from roverlink.generator.git import Repository
from roverlink.generator.new_project import NewProject, new_project
from roverlink.generator.source_files import repository_top, visible
from roverlink.installed_packages import git_source
from roverlink.numerals import counted
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError

_WORKFLOW = ".github/workflows/roverlink.yml"
_IN_TOP_FOLDER = (_WORKFLOW, ".pre-commit-config.yaml")


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "--from",
        dest="root",
        type=Path,
        metavar="PROTO_ROOT",
        help="start the project with the .proto files in this folder",
    )
    parser.add_argument(
        "--envelope",
        default="",
        metavar="FILE",
        help="with --from: the .proto file that declares the envelope, relative to PROTO_ROOT",
    )
    parser.add_argument(
        "--message",
        default="",
        metavar="NAME",
        help="with --from: name of the envelope's protobuf message (default: the message with the largest oneof, or "
        "the outermost one that contains it)",
    )
    parser.add_argument(
        "--oneof",
        default="",
        metavar="NAME",
        help="with --from: name of the oneof with the payloads (default: the largest oneof)",
    )
    parser.add_argument(
        "--package", default="comms", metavar="NAME", help="name of the generated ROS 2 package (default: %(default)s)"
    )
    parser.add_argument("--dry-run", action="store_true", help="print mapping.yaml, but write no file")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the files of the new project, and print the next steps. If one file cannot be made, none is written."""
    finish_interrupted(Path.cwd())
    table = Path(TABLE)
    if table.exists():
        raise SetupError(f"{table} exists already; `roverlink add` adds a row to it")
    if arguments.root is None and any((arguments.envelope, arguments.message, arguments.oneof)):
        raise SetupError("--envelope, --message and --oneof need --from PROTO_ROOT")
    try:
        if arguments.root is None:
            started = new_project(Path.cwd(), arguments.package, git_source("roverlink"))
            if _write(started.changes, arguments.dry_run):
                _print_started(started)
            return OK
        wanted = AdoptionRequest(
            arguments.root,
            arguments.envelope,
            arguments.message,
            arguments.oneof,
            arguments.package,
            git_source("roverlink"),
        )
        with progress("reading history") as report:
            adoption = adopt(table, wanted, report)
        if _write(adoption.changes, arguments.dry_run):
            _print_adoption(adoption, wanted.source)
    except DiagnosticsError as error:
        show_error(error, Path.cwd())
        print_note("nothing was written")
        return UNABLE if any(finding.severity is Severity.FATAL for finding in error.findings) else FINDINGS
    return OK


def _write(changes: Iterable[Change], dry_run: bool) -> bool:
    """Write the changed files; with ``dry_run``, only print mapping.yaml. Return true if the files were written."""
    if dry_run:
        sys.stdout.writelines(change.after or "" for change in changes if change.path == TABLE)
    else:
        write(Path.cwd(), changes)
    return not dry_run


def _print_started(started: NewProject) -> None:
    """Print the files that were written, and the next steps."""
    _print_kept(started.kept)
    own = [change.path for change in started.changes if not change.path.startswith("generated/")]
    print(f"wrote {', '.join(own)} and {counted(len(started.changes) - len(own), 'file')} in generated/")
    _print_places(started.kept, started.source)
    print("next:")
    print("  roverlink run                                        run the bridge until Ctrl-C")
    print(
        "  roverlink echo board_status                          in a second terminal: print the messages of the topic"
    )
    print("  roverlink send board_status battery_voltage=11.7     in a third one: send a datagram as the board does")


def _print_kept(kept: Iterable[str]) -> None:
    for path in kept:
        print(f"kept the existing {path}")


def _print_places(kept: Collection[str], source: str) -> None:
    """Print what the user has to do before GitHub and pre-commit use their files."""
    written = [path for path in _IN_TOP_FOLDER if path not in kept]
    here = Path.cwd()
    top = Path(repository_top(str(here)) or here)
    if top != here and written:
        print(f"GitHub and pre-commit look for {' and '.join(written)} in the top folder of the repository:")
        print(f"move them to {top}")
    if _WORKFLOW in written and not source:
        print(f"GitHub has to know from where it installs roverlink: set ROVERLINK in {_WORKFLOW}")


def _print_adoption(adoption: Adoption, source: str) -> None:
    """Print the rows, the guesses and the next steps of a project that was made from existing .proto files."""
    draft = adoption.draft
    print(f"{draft.message} in {draft.root}/{draft.file} has {counted(len(draft.rows), 'payload')} in {draft.oneof}")
    if draft.oneof_doubt:
        print(f"  {draft.oneof_doubt}")
    print(f"  {draft.owner_reason}")
    for row in draft.rows:
        print(f"  {row.number:>5} {row.name:<28} {row.direction:<24}{'  guessed' if row.doubt else ''}".rstrip())
    for file, why in draft.exclude.items():
        print(f"left out: {visible(file)}: {why}")
    ignored: dict[str, list[str]] = {}
    for row in draft.rows:
        for path, why in row.ignore.items():
            ignored.setdefault(why, []).append(f"{path} of {row.name}")
    for why, fields in ignored.items():
        print(f"not bridged: {', '.join(fields)}: {why}")
    for field in adoption.scalars:
        print(f"not bridged: {field} in {draft.oneof}, because it is not a message")
    for gone in draft.retired:
        print(f"retired: {gone.number} {gone.name} ({gone.proto}){f': {gone.note}' if gone.note else ''}")
    if adoption.past.reused:
        numbers = ", ".join(map(str, adoption.past.reused))
        print(f"numbers that had another meaning before: {numbers}; see `roverlink lint --history`")
    _print_findings(adoption)
    _print_kept(adoption.kept)
    added = [change.path for change in adoption.changes if change.verb == "added"]
    own = [path for path in added if path not in adoption.compiled.files]
    others = [change for change in adoption.changes if change.verb != "added"]
    print(
        f"wrote {', '.join(own)} and {counted(len(added) - len(own), 'generated file')}"
        + "".join(f"; {change.verb} {change.path}" for change in others)
    )
    _print_places(adoption.kept, source)
    print("next:")
    guessed = sum(bool(row.doubt) for row in draft.rows)
    guesses = ["the envelope"] * bool(draft.oneof_doubt) + [counted(guessed, "direction")] * bool(guessed)
    listed = f"{', '.join(guesses)} and " if guesses else ""
    print(f"  check {TABLE}: {listed}the peers' ports are guessed")
    steps = {
        "roverlink generate": "run after each change of the table",
        "roverlink lint": "check numbers, names and sizes",
        "roverlink run": "run the bridge",
    }
    if base := Repository(Path.cwd()).branch_to_compare():
        steps[f"roverlink lint --against {base} --history"] = "in CI, after `roverlink generate --check`"
    width = max(map(len, steps))
    for command, what in steps.items():
        print(f"  {command:<{width}}  {what}")


def _print_findings(adoption: Adoption) -> None:
    show_without_hints(adoption.findings, Sources(Path.cwd()), sys.stdout)
    draft = adoption.draft
    if lowered := sorted({*draft.lint, *(rule for row in draft.rows for rule in row.lint)}):
        print(
            f"{', '.join(lowered)}: these rules have findings in your files, so {TABLE} lowers them to a hint (`lint`);"
        )
        print("remove such an entry when you have solved the problem, or keep it and add your reason;")
        print(f"`roverlink explain {lowered[0]}` describes the rule")
