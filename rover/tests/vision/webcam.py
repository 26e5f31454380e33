"""A phone with an app that shows its camera on the network: the real protocol, on loopback."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import count, islice


class Webcam:
    """A page at /, and at /video a stream of JPEGs: so many, over and over, with a pause after each."""

    def __init__(
        self, pictures: Sequence[bytes], frames: int | None = None, pause_s: float = 0.01, port: int = 0
    ) -> None:
        """Without a number of `frames` the stream has no end; without a port, the system selects one."""
        self.frames, self.hang, self.visits, self.sent = frames, False, 0, 0
        self._pause_s = pause_s
        self.pictures = pictures
        """Images of the stream; a change also reaches a stream that has begun."""
        self._released = threading.Event()
        webcam = self

        class Handler(BaseHTTPRequestHandler):
            def log_message(self, *_: object) -> None:
                pass

            def do_GET(self) -> None:
                with suppress(OSError):  # whoever looked has gone
                    webcam.answer(self)

        self._server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self.port = self._server.server_port
        self.address = f"127.0.0.1:{self.port}"
        threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True).start()

    def answer(self, to: BaseHTTPRequestHandler) -> None:
        """Send the page, or a stream."""
        video = to.path == "/video"
        to.send_response(200)
        to.send_header("Content-Type", "multipart/x-mixed-replace; boundary=next" if video else "text/html")
        to.end_headers()
        if not video:
            to.wfile.write(b"<html>The app</html>")
            return
        self.visits += 1
        for number in islice(count(), self.frames):
            jpeg = self.pictures[number % len(self.pictures)]
            if self._released.is_set():
                return
            to.wfile.write(b"--next\r\nContent-Type: image/jpeg\r\nContent-Length: %d\r\n\r\n" % len(jpeg))
            to.wfile.write(jpeg + b"\r\n")
            self.sent += 1
            time.sleep(self._pause_s)  # the rate of its frames
        if self.hang:
            self._released.wait()

    def close(self) -> None:
        """Be gone."""
        self._released.set()
        self._server.shutdown()
        self._server.server_close()
