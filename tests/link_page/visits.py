"""Requests to a page of the link, as a browser or something else sends them."""

from __future__ import annotations

import http.client
import json
import time
import urllib.request
from collections.abc import Callable
from typing import Any

from polling import PATIENCE_S


def port_of(url: str) -> int:
    """The port of a page."""
    return int(url.rstrip("/").rpartition(":")[2])


def ask(url: str, path: str, method: str = "GET", content: object = None, **headers: str) -> tuple[int, bytes]:
    """The status and the body of an answer; a content is sent as JSON, and bytes as they are."""
    body = content if content is None or isinstance(content, bytes) else json.dumps(content)
    connection = http.client.HTTPConnection("127.0.0.1", port_of(url), timeout=PATIENCE_S)
    try:
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        endless = path.startswith("/events") and answer.status == 200
        return answer.status, b"" if endless else answer.read()
    finally:
        connection.close()


def act(url: str, path: str, content: object, token: str, **headers: str) -> tuple[int, str]:
    """The status and the text of the answer to an action on the page itself, with a token."""
    own = {"Origin": url.rstrip("/"), "Authorization": f"Bearer {token}"}
    status, body = ask(url, path, "POST", content, **{**own, **headers})
    return status, body.decode().strip()


class Events:
    """The events of a page, as a browser reads them."""

    def __init__(self, url: str, bridge: str = "") -> None:
        self._deadline = time.monotonic() + PATIENCE_S
        self._bridges: dict[str, Any] = {"alarms": []}
        self._stream = urllib.request.urlopen(f"{url}events?bridge={bridge}", timeout=PATIENCE_S)

    def next(self, name: str) -> Any:
        """The content of the next event with this name."""
        while True:
            line = self._stream.readline().decode()
            assert line, "the stream has ended"
            assert time.monotonic() < self._deadline, f"still waiting for {name}"
            event = line.removeprefix("event: ").rstrip("\n")
            if event not in (name, "bridges") or not line.startswith("event: "):
                continue
            content = json.loads(self._stream.readline().decode().removeprefix("data: "))
            if event == "bridges":
                self._bridges = content
            if event == name:
                return content

    def alarm(self, subject: str, wanted: Callable[[dict[str, Any]], bool] = bool) -> dict[str, Any]:
        """The alarm with this subject, as soon as it is as wanted.

        The page sends its alarms only when they change, so the last ones may have come while another event was awaited.
        """
        while True:
            found = next((alarm for alarm in self._bridges["alarms"] if alarm["subject"] == subject), None)
            if found is not None and wanted(found):
                return found
            self.next("bridges")

    def until(self, name: str, wanted: Callable[[Any], object]) -> Any:
        """The content of the next event with this name that is as wanted."""
        while not wanted(content := self.next(name)):
            pass
        return content

    def __enter__(self) -> Events:
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the page."""
        self._stream.close()
