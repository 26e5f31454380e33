"""Web page of ``roverlink demo``: the stream of the rover's camera, and a map with the paths of the rover."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http import HTTPStatus
from pathlib import Path

from roverkit.demo.driven_path import DrivenPath
from roverkit.video.video_page import StreamsHandler
from roverlink.runtime.net.page_requests import Answer, file_answer

_FILES = ("/map.js", "/map.css")


class DemoHandler(StreamsHandler):
    """Handler of the page of the demo."""

    folder = Path(__file__).parent
    driven: DrivenPath

    def get(self, path: str, query: Mapping[str, list[str]]) -> Answer | None:
        """Answer a request for the files or the content of the map, or for the streams."""
        if path in _FILES:
            return file_answer(self.folder / path[1:])
        if path == "/map":
            return Answer(HTTPStatus.OK, "application/json", json.dumps(self.driven.as_dict()).encode())
        return super().get(path, query)


def demo_handler(driven_path: DrivenPath) -> type[DemoHandler]:
    """Return the handler of a page that shows a path."""
    return type("DemoHandlerOfPath", (DemoHandler,), {"driven": driven_path})
