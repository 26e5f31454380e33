"""Web page of the link: shows the state of a bridge in a browser, for ``roverlink run --page`` and ``top --web``."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING

from roverlink.console import listen_address

if TYPE_CHECKING:
    from roverlink.link_page.live_link import LiveLink

PORT = 8600
"""TCP port of the page by default."""


def add_option(parser: argparse.ArgumentParser, name: str) -> None:
    """Add the option that requests the page, such as ``--page``, to a parser; its value is None or host and port."""
    parser.add_argument(
        name,
        type=listen_address,
        nargs="?",
        const=("127.0.0.1", PORT),
        metavar="[HOST:]PORT",
        help="serve a web page that shows the link live: peers, rows, stops, alarms, the log and plots; without HOST, "
        f"only this computer can open it, and HOST 0.0.0.0 stands for all addresses (without a value: port {PORT})",
    )


def serve(live: LiveLink, address: tuple[str, int], stack: ExitStack, say: Callable[[str], object]) -> None:
    """Serve the page until ``stack`` is closed, and tell its address with ``say``.

    Raises `SetupError` if the port is not available.
    """
    from roverlink.link_page.link_server import LinkServer  # imported here: its HTTP server is slow to import
    from roverlink.runtime.net.page_requests import is_loopback

    host, port = address
    server = stack.enter_context(LinkServer(host, port, live))
    stack.enter_context(live)
    say(f"page: {server.url}")
    if not is_loopback(host):
        say(f"anyone who can reach {host} sees the state, the values and the log on the page")
