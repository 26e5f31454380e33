"""Basics of all commands: exit codes, the project's folder, option types, messages, loggers."""

from __future__ import annotations

import argparse
import contextlib
import json
import logging
import math
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from roverlink.runtime.core.errors import SetupError

N = TypeVar("N", int, float)

OK = 0
FINDINGS = 1
UNABLE = 2

TABLE = "mapping.yaml"
_A_YEAR_S = 366 * 24 * 3600
Subparsers = Any  # argparse names its type only in private


class NoProjectError(SetupError):
    """A command was started outside a project."""


def print_error(message: str) -> None:
    """Print the reason why a command cannot run, on standard error."""
    print(f"roverlink: {message}", file=sys.stderr)


def print_note(message: str) -> None:
    """Print a message for the user on standard error while a command runs."""
    print(message, file=sys.stderr, flush=True)


def counted(count: int, what: str) -> str:
    """Return a number with its noun: ``1 row``, ``2 rows``."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def command(commands: Subparsers, name: str, help: str, example: str, description: str = "") -> argparse.ArgumentParser:
    """Create a subcommand; its help ends with the example."""
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=help,
        description=description or f"{help[0].upper()}{help[1:]}.",
        epilog=f"example: {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    return parser


def add_project(parser: argparse.ArgumentParser) -> None:
    """Add the option for the folder of the generated code."""
    parser.add_argument(
        "--project",
        type=Path,
        metavar="DIR",
        help="folder with mapping.yaml and generated/ (default: this folder or the nearest one above it)",
    )


def add_table(parser: argparse.ArgumentParser) -> None:
    """Add the option for the table."""
    parser.add_argument(
        "--table",
        type=Path,
        metavar="FILE",
        help=f"the table (default: {TABLE} in this folder or the nearest one above it)",
    )


def table_file(given: Path | None) -> Path:
    """Return the given table or the nearest one; if there is none, the path in the current folder."""
    here = Path.cwd()
    near = (folder / TABLE for folder in (here, *here.parents))
    # lexists: a dangling link named mapping.yaml is a mistake to report, not a reason to look further up.
    found = given or next((path for path in near if os.path.lexists(path)), here / TABLE)
    return Path(os.path.relpath(found))


def port(text: str) -> int:
    """Parse a port number; 0 means any free port."""
    return _number(text, int, lambda number: 0 <= number < 65_536, "a port number from 0 to 65535")


def count(text: str) -> int:
    """Parse a number above 0."""
    return _number(text, int, lambda number: number > 0, "a whole number above 0")


def rate(text: str) -> float:
    """Parse a frequency in hertz; less than once a year is refused."""
    return _number(
        text, float, lambda number: 1 / _A_YEAR_S < number < math.inf, "a frequency above 0 (at least once a year)"
    )


def seconds(text: str) -> float:
    """Parse a duration in seconds, at most a year, since larger values overflow the system's clocks."""
    return _number(text, float, lambda number: 0 <= number <= _A_YEAR_S, "a duration in seconds (0 to one year)")


def megabytes(text: str) -> int:
    """Parse a size in megabytes; return bytes."""
    return int(1e6 * _number(text, float, lambda number: 0 < number < math.inf, "a size in megabytes"))


def _number(text: str, read: Callable[[str], N], fits: Callable[[N], bool], what: str) -> N:
    with contextlib.suppress(ValueError):
        if fits(number := read(text)):
            return number
    raise argparse.ArgumentTypeError(f"{text!r} is not {what}")


def project_folder(given: Path | None) -> Path:
    """Return the given folder, or the nearest one with a project. Raises `NoProjectError`."""
    if given is not None:
        return given
    here = Path.cwd()
    for folder in (here, *here.parents):
        if os.path.lexists(folder / TABLE) or (folder / "generated" / "registry.py").is_file():
            return folder
    raise NoProjectError(
        f"no {TABLE} in {here} or a folder above it; start a project here with `roverlink init`, "
        "or name its folder with --project DIR"
    )


def isolate_ros() -> None:
    """Restrict ROS 2 to this host, in a domain that others on this host are unlikely to use.

    The ports of domains above 100 are in the range that Linux gives to any program (ephemeral ports).
    """
    # Kilted knows only the range, Humble only the other variable; Jazzy knows both, and warns of the other one.
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    if os.environ.get("ROS_DISTRO") == "humble":
        os.environ["ROS_LOCALHOST_ONLY"] = "1"
    os.environ.setdefault("ROS_DOMAIN_ID", str(20 + os.getpid() % 80))


class _RosFormatter(logging.Formatter):
    """Formats records as ROS 2 nodes do: ``[INFO] [1700000000.123456] [udp_forwarder]: text``."""

    def format(self, record: logging.LogRecord) -> str:
        level = {"WARNING": "WARN", "CRITICAL": "FATAL"}.get(record.levelname, record.levelname)
        return f"[{level}] [{record.created:.6f}] [{record.name}]: {record.getMessage()}"


class _JsonFormatter(logging.Formatter):
    """Formats records as one JSON object per line: time, level, logger, message, and the record's ``facts``."""

    def format(self, record: logging.LogRecord) -> str:
        facts: dict[str, Any] = getattr(record, "facts", {})
        said = {"time": record.created, "level": record.levelname.lower(), "logger": record.name}
        return json.dumps({**said, "message": record.getMessage(), **facts})


LOG_FORMATS = {"ros": _RosFormatter, "json": _JsonFormatter}
"""Formatters of log records, by the name of the format."""


def node_logger(name: str, level: str | None, format: str = "ros") -> logging.Logger:
    """Return a logger to standard error with the levels of ROS 2; with level None it prints nothing."""
    handler = logging.StreamHandler() if level else logging.NullHandler()
    handler.setFormatter(LOG_FORMATS[format]())
    logger = logging.getLogger(name)
    logger.handlers = [handler]
    level = level or "info"
    logger.setLevel({"warn": logging.WARNING, "fatal": logging.CRITICAL}.get(level, level.upper()))
    # Handlers of the root logger would print each line a second time.
    logger.propagate = False
    return logger
