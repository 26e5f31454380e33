"""Parts that the commands share: exit codes, common options, the search for the project, messages, and loggers."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import json
import logging
import math
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from roverlink.dds_domain import claim_domain
from roverlink.generator import journal
from roverlink.numerals import counted
from roverlink.runtime.core.errors import SetupError

N = TypeVar("N", int, float)

OK = 0
"""Exit code for success."""
FINDINGS = 1
"""Exit code of a command that found problems, such as diagnostics of ``roverlink lint``."""
UNABLE = 2
"""Exit code of a command that could not run, for example because a file is missing."""
INTERRUPTED = 130
"""Exit code of a command that a signal ended before its work was done: 128 plus SIGINT, as shells have it."""

TABLE = "mapping.yaml"
"""File name of the table, which lists the bridged messages."""
_A_YEAR_S = 366 * 24 * 3600
SUMMARY = "summary"
"""Default of a command's parser that is the line about the command in the help of the whole command line."""
Subparsers = Any  # argparse names its type only in private


class NoProjectError(SetupError):
    """Error of a command that needs a project, but was started outside of a folder with mapping.yaml."""


def print_error(message: str) -> None:
    """Print the reason why a command cannot run on standard error, as ``roverlink: <message>``."""
    print(f"roverlink: {message}", file=sys.stderr)


def print_note(message: str) -> None:
    """Print a message for the user on standard error while a command runs."""
    print(message, file=sys.stderr, flush=True)


def print_undelivered(counts: Mapping[str, int]) -> None:
    """Print that datagrams were not sent over a line, with their numbers by reason."""
    reasons = ", ".join(f"{reason} {count}" for reason, count in sorted(counts.items()))
    print_note(f"{counted(sum(counts.values()), 'datagram')} did not leave over the line: {reasons}")


def documented_command(
    commands: Subparsers, module: str, documentation: str | None, more: str = "", name: str = ""
) -> argparse.ArgumentParser:
    """Add the subcommand that a module is to the command line, and return its parser.

    ``module`` is the name of the module. ``documentation`` is its docstring: the line about the subcommand in the help
    of the whole command line, then the description in the subcommand's own help, and after ``Example:`` a command line.
    ``more`` are lines at the end of the description. ``name`` is the subcommand's name if it is not the module's.
    """
    text, _, example = (documentation or "").rstrip().rpartition("\n\nExample: ")
    summary, _, description = text.partition("\n\n")
    help = f"{summary[:1].lower()}{summary[1:-1]}"
    parser: argparse.ArgumentParser = commands.add_parser(
        name or module.rpartition(".")[2].replace("_", "-"),
        help=help,
        description=f"{description or summary}{more}",
        epilog=f"example: {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(**{SUMMARY: help})
    return parser


def add_subcommands(parser: argparse.ArgumentParser, package: str, subcommands: Iterable[str]) -> None:
    """Add the ``subcommands`` to the parser of a command; each is a module of ``package`` with a function ``add``."""
    choices = parser.add_subparsers(required=True, metavar="command")
    for module in subcommands:
        importlib.import_module(f"{package}.{module}").add(choices)


def add_project(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--project`` to a parser: the folder that contains mapping.yaml and the generated code."""
    parser.add_argument(
        "--project",
        type=Path,
        metavar="DIR",
        help="folder with mapping.yaml and generated/ (default: this folder or the nearest such folder above it, "
        "or else the generated code in the ROS 2 package that is sourced)",
    )


def add_end(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--as`` to a parser: the end of the link at which this computer is."""
    parser.add_argument(
        "--as",
        dest="end",
        default="",
        metavar="PEER",
        help="be this peer of the table (or a board), with ROS 2 at this end, too: send what the peer sends from "
        "topics to the rover, and publish what the rover sends to it (default: be the rover)",
    )


def add_key_file(parser: argparse.ArgumentParser, help: str) -> None:
    """Add the option ``--key-file`` to a parser: files with keys for signatures; ``help`` says what they are for."""
    parser.add_argument("--key-file", type=Path, action="append", default=[], metavar="FILE", help=help)


def add_destination(parser: argparse._ActionsContainer, what: str = "address of the bridge") -> None:
    """Add the option ``--to`` to a parser or a group of options: the address of a bridge, which ``what`` describes."""
    from roverlink.runtime.ros_arguments.parameters import LISTEN_PORT  # here: few commands need the parameters

    parser.add_argument(
        "--to",
        default=f"127.0.0.1:{LISTEN_PORT}",
        metavar="HOST:PORT",
        help=f"{what}, or a line to it: serial:/dev/ttyACM0, tcp:10.0.0.5:7000 (default: %(default)s)",
    )


def add_table(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--table`` to a parser: the path of mapping.yaml."""
    parser.add_argument(
        "--table",
        type=Path,
        metavar="FILE",
        help=f"path of the table (default: {TABLE} in this folder or the nearest folder above it)",
    )


MIDDLEWARES_HELP = (
    "software that connects to ROS 2. dds: Cyclone DDS, which needs no installed ROS 2; rclpy: the installed ROS 2; "
    "zenoh: nodes of rmw_zenoh_cpp, through a router and without an installed ROS 2; memory: topics only inside this "
    "process, without ROS 2; auto: rclpy if Python can import it, else zenoh if RMW_IMPLEMENTATION=rmw_zenoh_cpp, "
    "else dds"
)


def add_middleware(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--middleware`` to a parser: the software that connects to ROS 2."""
    from roverlink.runtime.middleware import NAMES  # here: a middleware is slow to import

    parser.add_argument("--middleware", choices=NAMES, default="auto", help=f"{MIDDLEWARES_HELP} (default: auto)")


def add_recording(parser: argparse.ArgumentParser) -> None:
    """Add the argument ``recording`` to a parser: the path of a file that ``roverlink record`` wrote."""
    parser.add_argument(
        "recording",
        type=Path,
        help="any file of a recording, such as run.mcap (topics) or run.datagrams.mcap (datagrams); the other files "
        "of the recording are found beside it",
    )


def table_file(given: Path | None) -> Path:
    """Return the path of the table: ``given``, or else the nearest mapping.yaml in this folder or above it.

    If there is none, return the path at which it would be in this folder. If a command that wrote the project's files
    was killed, its work is completed or rolled back first.
    """
    if given:
        finish_interrupted(given.resolve().parent)
        return Path(os.path.relpath(given))
    here = Path.cwd()
    for folder in (here, *here.parents):
        finish_interrupted(folder)
        # lexists: a dangling link named mapping.yaml is a mistake to report, not a reason to look further up.
        if os.path.lexists(folder / TABLE):
            return Path(os.path.relpath(folder / TABLE))
    return Path(os.path.relpath(here / TABLE))


def finish_interrupted(project: Path) -> None:
    """Complete or roll back what a killed command has left half written in a project, and print a note about it.

    Raises `SetupError` if this is not possible, because the files of the project then do not fit together.
    """
    try:
        finished = journal.finish(project)
    except OSError as error:
        raise SetupError(
            f"{project}: an earlier command was interrupted while it wrote files, and this cannot be completed: "
            f"{error.filename}: {error.strerror}; if {journal.FOLDER} is not from roverlink, move it to another place, "
            "else correct the cause and run the command again"
        ) from error
    if finished is None:
        return
    done = "completed" if finished.completed else "rolled back"
    print_note(f"{project}: {done} what an interrupted command had begun to write")
    for path in finished.left:
        print_note(f"{project}: {path!r} was changed since then and is left as it is; run `roverlink generate --check`")


def port(text: str) -> int:
    """Parse the value of an option that is a port number; 0 means any free port."""
    return parsed_number(text, int, lambda number: 0 <= number < 65_536, "a port number from 0 to 65535")


def listen_address(text: str) -> tuple[str, int]:
    """Parse the value of an option of the form ``[HOST:]PORT``; without HOST, only this computer can connect."""
    host, _, number = text.rpartition(":")
    if ":" in host:
        raise argparse.ArgumentTypeError(f"{text!r} is not [HOST:]PORT; HOST is an IPv4 address or a name")
    return host or "127.0.0.1", port(number)


def count(text: str) -> int:
    """Parse the value of an option that is a whole number above 0."""
    return parsed_number(text, int, lambda number: number > 0, "a whole number above 0")


def rate(text: str) -> float:
    """Parse the value of an option that is a frequency in hertz. A frequency of less than once a year is refused."""
    return parsed_number(
        text, float, lambda number: 1 / _A_YEAR_S < number < math.inf, "a frequency above 0 (at least once a year)"
    )


def seconds(text: str) -> float:
    """Parse the value of an option that is a duration in seconds, at most a year.

    Larger values would overflow the clocks of the system.
    """
    return parsed_number(text, float, lambda number: 0 <= number <= _A_YEAR_S, "a duration in seconds (0 to one year)")


def megabytes(text: str) -> int:
    """Parse the value of an option that is a size in megabytes, and return the size in bytes."""
    return int(1e6 * parsed_number(text, float, lambda number: 0 < number < math.inf, "a size in megabytes"))


def parsed_number(text: str, read: Callable[[str], N], fits: Callable[[N], bool], what: str) -> N:
    """Parse the value of an option that is a number. The error says that it is not ``what``, if it does not fit."""
    with contextlib.suppress(ValueError):
        if fits(number := read(text)):
            return number
    raise argparse.ArgumentTypeError(f"{text!r} is not {what}")


def project_folder(given: Path | None) -> Path:
    """Return the folder of the project: ``given``, or else this folder or the nearest one above it with a project.

    A folder has a project if it contains mapping.yaml or generated/registry.py. Elsewhere, the project is that of the
    first sourced ROS 2 package which has installed generated code. Raises `NoProjectError` if there is no project. If a
    command that wrote the project's files was killed, its work is completed or rolled back first.
    """
    if given is not None:
        finish_interrupted(given)
        return given
    here = Path.cwd()
    for folder in (here, *here.parents):
        finish_interrupted(folder)
        if os.path.lexists(folder / TABLE) or (folder / "generated" / "registry.py").is_file():
            return folder
    if (sourced := _sourced_project()) is not None:
        return sourced
    raise NoProjectError(
        f"no {TABLE} in {here} or a folder above it; start a project here with `roverlink init`, "
        "or name its folder with --project DIR"
    )


def _sourced_project() -> Path | None:
    """Return the folder into which a sourced ROS 2 package has installed generated code; None if none has."""
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        for registry in sorted(Path(prefix, "lib").glob("*/project/**/registry.py")):
            return next(folder for folder in registry.parents if folder.name == "project")
    return None


def isolate_ros(held: contextlib.ExitStack) -> None:
    """Restrict ROS 2 in this process and its children to this host, so that simulated messages reach no real rover.

    Unless ROS_DOMAIN_ID is set, the DDS domain is one that no other program on this host is in; it is ours until
    ``held`` is closed.

    Raises `OSError` if no domain is free, and `MiddlewareError` if ROS_DOMAIN_ID is set to something that is no domain.
    """
    # The variables are read when a participant joins its domain, and child processes inherit them. Kilted knows only
    # the range, Humble only the other variable; Jazzy knows both, and warns of the other one.
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    if os.environ.get("ROS_DISTRO") == "humble":
        os.environ["ROS_LOCALHOST_ONLY"] = "1"
    if "ROS_DOMAIN_ID" in os.environ:
        from roverlink.runtime.middleware.ros_domain import ros_domain  # here: a middleware is slow to import

        ros_domain()  # a wrong one is told here, and not by each process
    else:
        os.environ["ROS_DOMAIN_ID"] = str(claim_domain(held))
        held.callback(os.environ.pop, "ROS_DOMAIN_ID", None)


class _RosFormatter(logging.Formatter):
    """Formatter that writes log records as ROS 2 nodes do: ``[INFO] [1700000000.123456] [udp_forwarder]: text``."""

    def format(self, record: logging.LogRecord) -> str:
        level = {"WARNING": "WARN", "CRITICAL": "FATAL"}.get(record.levelname, record.levelname)
        # rcutils' default, "[{severity}] [{time}] [{name}]: {message}" (RCUTILS_CONSOLE_OUTPUT_FORMAT), but with
        # microseconds.
        return f"[{level}] [{record.created:.6f}] [{record.name}]: {record.getMessage()}"


class _JsonFormatter(logging.Formatter):
    """Formatter that writes a log record as one line of JSON: time, level, logger, message, and the record's facts.

    The facts are more keys with values, such as ``{"kept_back": 4}``. The code that logs passes them as
    ``extra={"facts": ...}``.
    """

    def format(self, record: logging.LogRecord) -> str:
        facts: dict[str, Any] = getattr(record, "facts", {})
        said = {"time": record.created, "level": record.levelname.lower(), "logger": record.name}
        return json.dumps({**said, "message": record.getMessage(), **facts})


LOG_FORMATS = {"ros": _RosFormatter, "json": _JsonFormatter}
"""Classes that format log records, by the format's name in the option ``--log-format``."""


def node_logger(name: str, level: str | None, format: str = "ros") -> logging.Logger:
    """Return the logger of the ROS 2 node ``name``, which writes to standard error.

    ``level`` is the lowest level that is written: ``debug``, ``info``, ``warn``, ``error`` or ``fatal``. If it is None,
    the logger writes nothing. ``format`` is a key of `LOG_FORMATS`.
    """
    handler = logging.StreamHandler() if level else logging.NullHandler()
    handler.setFormatter(LOG_FORMATS[format]())
    # Not getLogger: the level of one node would stay for all loggers of its name in this process.
    level = level or "info"
    logger = logging.Logger(name, {"warn": logging.WARNING, "fatal": logging.CRITICAL}.get(level, level.upper()))
    logger.addHandler(handler)
    return logger
