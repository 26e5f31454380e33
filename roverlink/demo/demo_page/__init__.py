"""Web page of ``roverlink demo``: the stream of the simulated camera."""

from __future__ import annotations

from pathlib import Path

from roverlink.video.video_page import StreamsHandler


class DemoHandler(StreamsHandler):
    """Handler of the page of the demo."""

    folder = Path(__file__).parent
