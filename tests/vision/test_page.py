"""The page in a real browser: on a phone, beside other sites, with a report; all of it at work is in `tests/cli`."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from bench.vision.browser import Visitor
from roverlink.vision.calibration import CharucoBoard, Collection, calibrate
from roverlink.vision.calibration.page.live_calibration import LiveCalibration
from roverlink.vision.calibration.page.server import PageServer
from roverlink.vision.calibration.report import report
from tests.vision.boards import BOARD, CAMERA, views
from tests.vision.browsing import visiting
from tests.vision.test_live_calibration import left, near, tilted

pytestmark = pytest.mark.slow

SMALL = CharucoBoard(7, 5, 0.038, 0.028)


@pytest.fixture(scope="module")
def visitor() -> Iterator[Visitor]:
    with visiting() as opened:
        yield opened


@pytest.fixture
def live() -> LiveCalibration:
    """Three views, and calibrations that are of others."""
    live = LiveCalibration(
        "http://a.very.long.name.of.a.camera.example:8080/with/a/path/that/does/not/break",
        Collection(SMALL),
        lambda _: calibrate(views(CAMERA, 12, 3), BOARD),
        lambda calibration: report(calibration, BOARD, {"roverlink": "1.0"}),
        lambda _: "Saved to a.yml.",
    )
    for number, frame in enumerate((near(), left(), tilted())):
        for again in range(2):
            live.add_frame(frame, 10**18 + (2 * number + again) * 33_000_000, "a frame")
    return live


@pytest.mark.parametrize("width", [320, 360, 1280])
def test_the_page_and_the_report_fit_screens(visitor: Visitor, live: LiveCalibration, width: int) -> None:
    """Nothing is wider than the screen, before there is a result and with it.

    The report has its colours, though its policy lets it load nothing and run nothing.
    """
    with PageServer("127.0.0.1", 0, live) as server:
        visitor.screen(width, 700)
        visitor.open(server.url)
        visitor.until(lambda: visitor.count("#views li") == 3)
        assert visitor.run("return document.documentElement.scrollWidth") <= width
        visitor.click("#calibrate")
        visitor.until(lambda: visitor.shown("#result"))
        assert visitor.run("return document.documentElement.scrollWidth") <= width
        visitor.open(f"{server.url}report")
        colour = "return getComputedStyle(document.querySelector('rect.level2, rect.level3, rect.level4')).fill"
        assert visitor.run(colour) not in ("rgb(0, 0, 0)", "none")
        assert visitor.run("return document.documentElement.scrollWidth") <= width
        assert visitor.complaints() == []


HOSTILE = """<!DOCTYPE html><title>Another site</title>
<img id="stolen" src="{url}picture"><iframe name="framed"></iframe><iframe id="shown" src="{url}"></iframe>
<form id="form" method="post" action="{url}views/1/drop" target="framed"></form>
<script>
const blocked = fetch("{url}state").then(() => false, () => true);
const clicked = fetch("{url}views/2/drop", {{method: "POST", mode: "no-cors"}});
document.getElementById("form").submit();
</script>"""


def test_another_site_sees_nothing_and_clicks_nothing(visitor: Visitor, live: LiveCalibration) -> None:
    """Not by a form, not by a program, not by an image; and what it shows in a frame is not the page."""
    with PageServer("127.0.0.1", 0, live) as server:

        class Other(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(HOSTILE.format(url=server.url).encode())

            def log_message(self, *_: object) -> None:
                pass

        other = ThreadingHTTPServer(("127.0.0.1", 0), Other)
        threading.Thread(target=other.serve_forever, args=(0.02,), daemon=True).start()
        visitor.screen(800, 600)
        visitor.open(f"http://127.0.0.1:{other.server_port}/")
        assert visitor.run("return blocked")
        visitor.run("return clicked.then(() => 0, () => 0)")
        visitor.until(lambda: visitor.run("return document.getElementById('stolen').complete"))
        assert visitor.run("return document.getElementById('stolen').naturalWidth") == 0
        visitor.until(lambda: visitor.run("return document.readyState") == "complete")
        said = "\n".join(visitor.complaints())
        other.shutdown()
        other.server_close()
    assert "frame-ancestors" in said
    assert "/views/1/drop - Failed to load resource: the server responded with a status of 403" in said
    assert [view["number"] for view in live.state(0)["views"]] == [1, 2, 3]
