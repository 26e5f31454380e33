"""Web page with all received streams: the newest image of each, how old it is, and statistics.

The images are sent as an endless sequence of JPEG (``multipart/x-mixed-replace``), which each browser shows without a
script. A browser that is slow gets fewer images, and never older ones.
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path

from roverkit.video.received_stream import ReceivedStream
from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import (
    EVENT_STREAM,
    IMAGE_STREAM,
    Answer,
    PageHandler,
    file_answer,
    image_part,
    not_found,
    refusal,
)

_FOLDER = Path(__file__).parent
_FILES = ("/streams.js", "/streams.css")
_IMAGES = "/video/"
"""Start of the path of a stream's images; its name follows."""
_STATE_S = 0.5
_WAIT_S = 1.0
_SILENT_S = 10.0
"""Time in seconds without a new image after which the last one is sent again, so that a lost browser is noticed."""
_OWN_SITES = ("same-origin", "none", None)


class StreamsHandler(PageHandler):
    """Handler of a page with streams.

    A page shows them if it loads streams.js and streams.css, and has elements with the ids streams and connection.
    """

    folder = _FOLDER
    streams: Mapping[str, ReceivedStream]

    def get(self, path: str, query: Mapping[str, list[str]]) -> Answer | None:  # noqa: ARG002  # as the base class
        """Answer a request for the script, the style, the states or the images of the streams."""
        if path in _FILES:
            return file_answer(_FOLDER / path[1:])
        # Another site may link to the page, but not show its images.
        if self.headers["Sec-Fetch-Site"] not in _OWN_SITES:
            return refusal("only the page itself may show the video")
        stream = self.streams.get(path.removeprefix(_IMAGES)) if path.startswith(_IMAGES) else None
        if path == "/events":
            self._send_states()
        elif stream is not None:
            self._send_images(stream)
        else:
            return not_found()
        return None

    def _send_states(self) -> None:
        """Send the state of all streams as server-sent events until the browser leaves."""
        self.close_connection = True
        self.send_head(Answer(HTTPStatus.OK, EVENT_STREAM))
        while True:
            states = [stream.state() for stream in self.streams.values()]
            self.wfile.write(b"data: " + json.dumps(states).encode() + b"\n\n")
            time.sleep(_STATE_S)

    def _send_images(self, stream: ReceivedStream) -> None:
        """Send the images of a stream until the browser leaves."""
        self.close_connection = True
        self.send_head(Answer(HTTPStatus.OK, IMAGE_STREAM))
        number, jpeg, sent = 0, b"", time.monotonic()
        while not stream.ended:
            newest = stream.next_jpeg(number, _WAIT_S)
            if newest is not None:
                number, jpeg = newest
            elif not jpeg or time.monotonic() - sent < _SILENT_S:
                continue
            sent = time.monotonic()
            self.wfile.write(image_part(jpeg))


class StreamsServer(HttpServer):
    """HTTP server of a page with streams. A context manager."""

    def __init__(
        self,
        address: str,
        port: int,
        streams: Mapping[str, ReceivedStream],
        handler: type[StreamsHandler] = StreamsHandler,
    ) -> None:
        """Bind the port; for port 0, the system selects a free port. Raises `SetupError` if it is not available."""
        super().__init__(address, port, "page", type("Handler", (handler,), {"streams": streams}))
