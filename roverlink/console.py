"""What the commands share: exit codes, where the project is, how to complain."""

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
    """A command that needs a project runs outside of one."""


def complain(message: str) -> None:
    """Say on standard error why a command cannot run."""
    print(f"roverlink: {message}", file=sys.stderr)


def note(message: str) -> None:
    """Say on standard error what is worth knowing while a command runs."""
    print(message, file=sys.stderr, flush=True)


def counted(count: int, what: str) -> str:
    """How many of something there are, in words: ``1 row``, ``2 rows``."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def command(commands: Subparsers, name: str, help: str, example: str, description: str = "") -> argparse.ArgumentParser:
    """A subcommand with its help and an example."""
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=help,
        description=description or f"{help[0].upper()}{help[1:]}.",
        epilog=f"example: {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    return parser


def add_project(parser: argparse.ArgumentParser) -> None:
    """The option that says where the generated code is."""
    parser.add_argument(
        "--project",
        type=Path,
        metavar="DIR",
        help="folder of mapping.yaml and generated/ (default: this folder or the nearest above it that has them)",
    )


def add_table(parser: argparse.ArgumentParser) -> None:
    """The option that says which table."""
    parser.add_argument(
        "--table",
        type=Path,
        metavar="FILE",
        help=f"the table (default: {TABLE} in this folder or in the nearest above it that has one)",
    )


def table_file(given: Path | None) -> Path:
    """The table: what was given, else the nearest; where there is none, the one that this folder should have."""
    here = Path.cwd()
    near = (folder / TABLE for folder in (here, *here.parents))
    found = given or next((path for path in near if os.path.lexists(path)), here / TABLE)
    return Path(os.path.relpath(found))


def port(text: str) -> int:
    """A UDP port on the command line; 0 takes a free one."""
    return _number(text, int, lambda number: 0 <= number < 65_536, "a UDP port, 0 to 65535")


def count(text: str) -> int:
    """How many, on the command line."""
    return _number(text, int, lambda number: number > 0, "a whole number above 0")


def rate(text: str) -> float:
    """How many a second, on the command line; less than one a year is none."""
    return _number(
        text, float, lambda number: 1 / _A_YEAR_S < number < math.inf, "a number above 0, one a year at least"
    )


def seconds(text: str) -> float:
    """A time on the command line, of a year at most: the system's clocks end somewhere."""
    return _number(text, float, lambda number: 0 <= number <= _A_YEAR_S, "a number of seconds")


def megabytes(text: str) -> int:
    """A size in megabytes on the command line, as bytes."""
    return int(1e6 * _number(text, float, lambda number: 0 < number < math.inf, "a number of megabytes"))


def _number(text: str, read: Callable[[str], N], fits: Callable[[N], bool], what: str) -> N:
    with contextlib.suppress(ValueError):
        if fits(number := read(text)):
            return number
    raise argparse.ArgumentTypeError(f"{text!r} is not {what}")


def project_folder(given: Path | None) -> Path:
    """Return the folder of the generated code: what was given, else the nearest. Raises `NoProjectError`."""
    if given is not None:
        return given
    here = Path.cwd()
    for folder in (here, *here.parents):
        if os.path.lexists(folder / TABLE) or (folder / "generated" / "registry.py").is_file():
            return folder
    raise NoProjectError(
        f"there is no {TABLE} in {here} or a folder above it; `roverlink init` starts a project here, "
        "and --project DIR names one elsewhere"
    )


def keep_to_ourselves() -> None:
    """Stay on this host, and out of the ROS 2 domain of anyone else on it.

    The ports of a domain above 100 are among those that Linux hands out to anybody.
    """
    os.environ["ROS_LOCALHOST_ONLY"] = "1"
    os.environ.setdefault("ROS_DOMAIN_ID", str(20 + os.getpid() % 80))


class _RosFormatter(logging.Formatter):
    """``[INFO] [1700000000.123456] [udp_forwarder]: text``, as ROS 2 nodes log."""

    def format(self, record: logging.LogRecord) -> str:
        level = {"WARNING": "WARN", "CRITICAL": "FATAL"}.get(record.levelname, record.levelname)
        return f"[{level}] [{record.created:.6f}] [{record.name}]: {record.getMessage()}"


class _JsonFormatter(logging.Formatter):
    """One JSON object a line: time, level, logger and message, and whatever facts the record has."""

    def format(self, record: logging.LogRecord) -> str:
        facts: dict[str, Any] = getattr(record, "facts", {})
        said = {"time": record.created, "level": record.levelname.lower(), "logger": record.name}
        return json.dumps({**said, "message": record.getMessage(), **facts})


LOG_FORMATS = {"ros": _RosFormatter, "json": _JsonFormatter}
"""How records are written, by the name of the format."""


def node_logger(name: str, level: str | None, format: str = "ros") -> logging.Logger:
    """A logger to standard error with ROS 2's levels; without a level, one that says nothing."""
    handler = logging.StreamHandler() if level else logging.NullHandler()
    handler.setFormatter(LOG_FORMATS[format]())
    logger = logging.getLogger(name)
    logger.handlers = [handler]
    level = level or "info"
    logger.setLevel({"warn": logging.WARNING, "fatal": logging.CRITICAL}.get(level, level.upper()))
    logger.propagate = False
    return logger
