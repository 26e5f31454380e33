"""Options of a camera program for its outputs."""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.console import MIDDLEWARES_HELP

NO_MIDDLEWARE = "none"
"""Value of the option ``--middleware`` of programs that publish nothing."""


def add_outputs(parser: argparse.ArgumentParser, results: str) -> None:
    """Add the options of a camera program for its outputs to a parser: ``--json``, ``--save`` and ``--middleware``.

    ``results`` says what the program computes, in the plural.
    """
    from roverlink.runtime.middleware import NAMES  # here: a middleware is slow to import

    parser.add_argument("--json", action="store_true", help=f"print the {results} as a JSON object for each image")
    parser.add_argument("--save", type=Path, metavar="FILE", help=f"save a video with the {results} drawn into it")
    parser.add_argument(
        "--middleware",
        choices=(*NAMES, NO_MIDDLEWARE),
        help=f"{MIDDLEWARES_HELP}; {NO_MIDDLEWARE}: publish nothing (default: auto, or {NO_MIDDLEWARE} with --json "
        "or --save)",
    )


def middleware_of(arguments: argparse.Namespace) -> str | None:
    """Return the middleware that the options of `add_outputs` select; None if nothing is to be published."""
    chosen: str | None = arguments.middleware
    if chosen is None:
        return None if arguments.json or arguments.save else "auto"
    return None if chosen == NO_MIDDLEWARE else chosen
