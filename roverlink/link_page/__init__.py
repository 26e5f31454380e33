"""Web page of the link: shows the state of bridges in a browser, for ``roverlink run --page`` and ``top --web``."""

from __future__ import annotations

import argparse
import logging
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from roverlink.console import listen_address
from roverlink.runtime.core.errors import SetupError

if TYPE_CHECKING:
    from roverlink.link_page.live_page import LivePage

PORT = 8600
"""TCP port of the page by default."""


def add_options(parser: argparse.ArgumentParser, name: str, actions: str) -> None:
    """Add the options of the page to a parser: the one that requests it, such as ``--page``, and ``--page-token``.

    The value of the first is None or host and port. ``actions`` says in the help what the token allows.
    """
    parser.add_argument(
        name,
        type=listen_address,
        nargs="?",
        const=("127.0.0.1", PORT),
        metavar="[HOST:]PORT",
        help="serve a web page that shows the link live: peers, rows, stops, alarms, the log and plots; without HOST, "
        f"only this computer can open it, and HOST 0.0.0.0 stands for all addresses (without a value: port {PORT})",
    )
    parser.add_argument(
        "--page-token",
        type=Path,
        metavar="FILE",
        help=f"with {name}: whoever enters the token in FILE on the page can {actions}; if FILE does not exist, it is "
        "made with a random token (default: the page is read-only)",
    )


def check_options(name: str, address: tuple[str, int] | None, token_file: Path | None) -> None:
    """Raise `SetupError` if there is a token, but no page; ``name`` is the option that requests the page."""
    if token_file is not None and address is None:
        raise SetupError(f"--page-token is for the page; add {name}, or leave out --page-token")


def serve(
    page: LivePage, address: tuple[str, int], token_file: Path | None, stack: ExitStack, logger: logging.Logger
) -> None:
    """Serve the page until ``stack`` is closed, and log its address.

    Raises `SetupError` if the port is not available, or if the file of the token cannot be used.
    """
    from roverlink.link_page import page_token
    from roverlink.link_page.link_server import LinkServer  # imported here: its HTTP server is slow to import
    from roverlink.runtime.net.page_requests import is_loopback

    host, port = address
    token = None
    if token_file is not None:
        token = page_token.PageToken(page_token.read_or_make(token_file, logger), logger)
    server = stack.enter_context(LinkServer(host, port, page, token))
    stack.enter_context(page)
    logger.info("page: %s", server.url)
    if not is_loopback(host):
        logger.info("anyone who can reach %s sees the state, the values and the log on the page", host)
        if token is not None:
            logger.info("the token crosses the network unencrypted; on a network of strangers, use an SSH tunnel")
