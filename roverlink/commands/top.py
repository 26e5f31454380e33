"""``roverlink top``: show the live state of a bridge on the terminal."""

from __future__ import annotations

import argparse
import json
import queue
import sys
import time
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.live import Live

from roverlink import top_screen, topic_types
from roverlink.console import FINDINGS, OK, Subparsers, add_middleware, command, seconds
from roverlink.runtime import NODE
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray
from roverlink.runtime.middleware import open_middleware
from roverlink.runtime.monitoring import diagnostic_array

_REFRESH_S = 0.5
_QUIET_S = 3.0  # time without a message after which the screen reports it


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "top",
        "show the state of a running bridge live: message rates, time since the last message, drops, queues",
        "roverlink top",
        "Show the state of a running bridge live: for each row, the messages a second, the time since the last\n"
        "message, and the dropped messages. It also shows how full the bridge's queues are. The command reads the\n"
        "topic /diagnostics, so the bridge may run on any machine of the same ROS 2 domain.",
    )
    parser.add_argument("--node", default=NODE, help="name of the bridge's node (default: %(default)s)")
    parser.add_argument(
        "--once",
        action="store_true",
        help="show the state once, and exit with code 0; or with 1 if the state is not OK",
    )
    parser.add_argument(
        "--json",
        action="store_true",
        help="print the state as a JSON object every second; with --once, print one object",
    )
    parser.add_argument(
        "--timeout", type=seconds, default=10.0, metavar="S", help="wait at most S seconds for the bridge (default: 10)"
    )
    add_middleware(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Show the state of a bridge until Ctrl-C, or only once.

    The exit code is 1 if no bridge is found. With ``--once`` it is also 1 if the state is not OK.
    """
    arrived: queue.Queue[bytes] = queue.Queue()

    def keep(messages: Sequence[bytes]) -> None:
        for message in messages:
            arrived.put(message)

    with open_middleware(arguments.middleware, topic_types.identity("top")) as middleware:
        middleware.subscribe(diagnostic_array.TOPIC, DiagnosticArray, diagnostic_array.QOS, keep)
        page = _next_page(arrived, arguments.node, arguments.timeout)
        if page is None:
            print(
                f"no messages of a bridge named {arguments.node!r} on {diagnostic_array.TOPIC} within "
                f"{arguments.timeout:g} s",
                file=sys.stderr,
            )
            return FINDINGS
        if arguments.once:
            _show(page, arguments.json)
            return FINDINGS if top_screen.has_problems(page) else OK
        return _follow(arrived, page, arguments)


def _follow(arrived: queue.Queue[bytes], page: dict[str, Any], arguments: argparse.Namespace) -> int:
    if arguments.json:
        while True:
            print(json.dumps(page), flush=True)
            while (next_page := _next_page(arrived, arguments.node, _QUIET_S)) is None:
                pass
            page = next_page
    updated = time.monotonic()
    with Live(console=Console(), screen=True, auto_refresh=False) as live:
        while True:
            live.update(top_screen.render(page, quiet=time.monotonic() - updated > _QUIET_S), refresh=True)
            if (next_page := _next_page(arrived, arguments.node, _REFRESH_S)) is not None:
                page, updated = next_page, time.monotonic()


def _next_page(arrived: queue.Queue[bytes], node: str, seconds: float) -> dict[str, Any] | None:
    """Return the next state that the bridge publishes; None if no state comes in ``seconds``."""
    deadline = time.monotonic() + seconds
    # Other nodes publish on /diagnostics too, so a message may be from another node.
    while (left := deadline - time.monotonic()) > 0:
        try:
            data = arrived.get(timeout=left)
        except queue.Empty:
            return None
        if page := top_screen.page_of(cdr.decode(DiagnosticArray, data), node):
            return page
    return None


def _show(page: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print(json.dumps(page, indent=2))
    else:
        Console().print(top_screen.render(page))
