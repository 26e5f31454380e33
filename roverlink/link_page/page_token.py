"""Token of a page that may act: its file, and the check of requests."""

from __future__ import annotations

import hmac
import logging
import secrets
import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable
from http import HTTPStatus
from pathlib import Path

from roverlink.runtime.bridge.account import ThrottledWarnings
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.page_requests import Answer
from roverlink.runtime.private_files import create_private, read_private

_SHORTEST, _LONGEST = 16, 1024  # characters
_LONGEST_DELAY_S = 10
_WITHIN_S = 60.0
_REMEMBERED = 256  # addresses


def read_or_make(path: Path, logger: logging.Logger) -> str:
    """Return the token in a file; if the file does not exist, make it with a random token, readable for its owner only.

    Raises `SetupError` if the file cannot be used, if others can read it, or if its token is too short.
    """
    try:
        try:
            content = read_private(path, "the token of the page", _LONGEST + 2)
        except FileNotFoundError:
            return _made(path, logger)
    except OSError as error:
        cure = "name a file that this user can read and write, or that does not exist yet in a folder that does"
        raise SetupError(f"{path}: cannot use the file for the token of the page: {error.strerror}; {cure}") from error
    token = content.decode("ascii", "replace").strip()
    if not _SHORTEST <= len(token) <= _LONGEST or not all("!" <= character <= "~" for character in token):
        raise SetupError(
            f"{path}: the token of the page must have {_SHORTEST} to {_LONGEST} ASCII characters without spaces; "
            "remove the file, and roverlink makes a random token"
        )
    return token


def _made(path: Path, logger: logging.Logger) -> str:
    token = secrets.token_urlsafe(24)
    create_private(path, f"{token}\n")
    logger.info("made the file %s with a random token for the page", path)
    return token


class PageToken:
    """Token that a request must carry to act. Thread-safe.

    Who sends wrong tokens has to wait longer and longer for the answers. The right token is never kept waiting: at the
    end of a tunnel, all browsers have the same address.
    """

    def __init__(self, token: str, logger: logging.Logger, clock: Callable[[], float] = time.monotonic) -> None:
        self._token, self._warnings, self._clock = token.encode(), ThrottledWarnings(logger), clock
        self._wrong: OrderedDict[str, deque[float]] = OrderedDict()
        self._lock = threading.Lock()

    def refusal(self, authorization: str | None, address: str) -> Answer | None:
        """Return the answer that refuses a request; None if its header ``Authorization`` has the token.

        ``address`` is the IP address of the client. The answer to a wrong token waits a second for each earlier wrong
        token of the address, in the last minute.
        """
        scheme, _, given = (authorization or "").partition(" ")
        if scheme.lower() != "bearer" or not given:
            return _unauthorized("this needs the token of the page; press Unlock")
        if hmac.compare_digest(given.strip().encode("utf-8", "surrogateescape"), self._token):
            return None
        now = self._clock()
        with self._lock:
            wrong = self._wrong.setdefault(address, deque(maxlen=_LONGEST_DELAY_S))
            delay = sum(time > now - _WITHIN_S for time in wrong)
            wrong.append(now)
            self._wrong.move_to_end(address)
            if len(self._wrong) > _REMEMBERED:
                self._wrong.popitem(last=False)
        self._warnings.warn("page_token", f"the page refused a wrong token from {address}")
        return _unauthorized("the token is wrong", delay)


def _unauthorized(why: str, delay: int = 0) -> Answer:
    headers = {"WWW-Authenticate": "Bearer"}
    return Answer(HTTPStatus.UNAUTHORIZED, body=f"{why}\n".encode(), headers=headers, delay_s=delay)
