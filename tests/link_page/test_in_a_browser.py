"""The page of the link in a real browser: what an operator sees, hears and clicks."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

import pytest

from bench.watched_link import watched_link
from rover.bench.vision.browser import Visitor
from rover.tests.vision.browsing import visiting

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def visitor() -> Iterator[Visitor]:
    with visiting() as opened:
        yield opened


CURVE = """
const canvas = document.getElementById("plot");
const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
copy.drawImage(canvas, 0, 0);  // Chromium complains about a canvas of the page that is read often
const pixels = copy.getImageData(0, 0, canvas.width, canvas.height).data;
let blue = 0;
for (let at = 0; at < pixels.length; at += 4) blue += pixels[at] < 60 && pixels[at + 2] > 150 && pixels[at + 3] > 200;
return blue;
"""


BROKEN_WORDS = """
const broken = [];
const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (texts.nextNode()) {
  if (!texts.currentNode.parentElement.checkVisibility()) continue;
  for (const word of texts.currentNode.textContent.matchAll(/[\\w.]+/g)) {
    const range = document.createRange();
    range.setStart(texts.currentNode, word.index);
    range.setEnd(texts.currentNode, word.index + word[0].length);
    if (new Set([...range.getClientRects()].map((part) => part.top)).size > 1) broken.push(word[0]);
  }
}
return broken;
"""
OPEN_ALARMS = "return [...document.querySelectorAll('#alarms li:not(.acknowledged)')].map((item) => item.dataset.key)"
HEAD = "return [...['level', 'worst'].map((id) => document.getElementById(id).innerText), icon.href]"
FITS = "return document.documentElement.scrollWidth <= document.documentElement.clientWidth"  # without the scroll bar


def _worst(visitor: Visitor) -> str:
    """The head of the page, which shows the worst of everything; the icon has the same sign. Empty while it loads."""
    sign, worst, icon = visitor.run(HEAD)
    assert f">{sign[:1]}<" in unquote(icon) or not sign
    return f"{sign}: {worst}"


def test_an_operator_watches_a_drive(visitor: Visitor) -> None:
    """Rows, values and plot are live; a stop is a latched alarm with sound, which stays acknowledged after a reload."""
    with watched_link() as link:
        visitor.screen(1280, 900)
        visitor.open(link.url)
        visitor.until(lambda: visitor.text("#connection") == "live" and visitor.shown("#no-alarms"))
        link.boards_speak = link.driver_speaks = True
        visitor.until(lambda: "alive" in visitor.text("#peers"))
        visitor.until(lambda: visitor.count("#rows [data-key='ph_info'] .fields button"))
        visitor.click("#rows [data-key='ph_info'] .fields [data-key='voltage']")
        visitor.until(lambda: visitor.run(CURVE) > 100)
        assert "ph_info voltage: now 2" in visitor.text("#plot-note")

        visitor.click("#sound")
        before = visitor.run("return beeps")
        link.driver_speaks = False
        visitor.until(lambda: "told to stop: drive_motor" in visitor.text("#peers"))
        visitor.until(lambda: "no command drive_motor for " in visitor.text("#alarms"))
        visitor.until(lambda: _worst(visitor).startswith("✕ ERROR: no command drive_motor for "))
        assert "at rest, no command yet: arm_ctrl" in visitor.text("#peers")
        assert "STOP" in visitor.text("#rows [data-key='drive_motor'] .state")
        visitor.until(lambda: visitor.run("return beeps") > before)
        assert re.match(r"\([1-9]\d*\) ✕ ERROR ", visitor.run("return document.title"))
        assert visitor.run(BROKEN_WORDS) == []

        link.driver_speaks = True
        visitor.until(lambda: "It was: no command drive_motor" in visitor.text("#alarms"))  # latched
        visitor.until(lambda: _worst(visitor) == "… WAITING: no message yet from basestation")
        latched = set(visitor.run(OPEN_ALARMS))
        assert latched
        visitor.run("document.getElementById('acknowledge-all').click()")
        visitor.until(lambda: latched.isdisjoint(visitor.run(OPEN_ALARMS)))
        visitor.open(link.url)
        visitor.until(lambda: visitor.text("#connection") == "live" and visitor.text("#peers"))
        assert latched.isdisjoint(visitor.run(OPEN_ALARMS))

        link.send(b"\xff\xff")
        visitor.until(lambda: "not a valid PBEnvelope" in visitor.text("#log"))
        assert visitor.complaints() == []


@pytest.mark.parametrize("width", [320, 390, 768, 1280])
def test_the_page_fits_screens(visitor: Visitor, width: int) -> None:
    """Nothing is wider than the screen, a phone's among them, with values, alarms and drops."""
    with watched_link() as link:
        visitor.screen(width, 800)
        visitor.open(link.url)
        link.boards_speak = True
        link.command()
        link.send_payload("imu_info")
        link.send(b"\xff\xff")
        visitor.until(lambda: visitor.count("#alarms li") and visitor.count(".more"))
        visitor.run("document.querySelectorAll('.more').forEach((button) => button.click())")
        assert visitor.run(FITS)
        assert visitor.complaints() == []


def test_what_falls_silent_is_not_green(visitor: Visitor) -> None:
    """The head, the peers and the rows show the boards as silent and as alive, and the log tells when.

    Without the bridge, nothing is known: the page does not go on showing old numbers as live.
    """
    with watched_link() as link:
        visitor.open(link.url)
        visitor.until(lambda: _worst(visitor) == "… WAITING: no message yet from hardware, basestation")
        assert visitor.count(".OK, .alive") == 0
        link.boards_speak = True
        visitor.until(lambda: visitor.count("#rows .OK") and visitor.count("#peers .alive"))
        link.boards_speak = False
        visitor.until(lambda: _worst(visitor).startswith("✕ ERROR: hardware is silent: no message for "))
        assert visitor.count(".OK, .alive") == 0
        visitor.until(lambda: "DrivingBoard of hardware fell silent: no message for" in visitor.text("#log"))
        link.boards_speak = True
        visitor.until(lambda: "DrivingBoard of hardware speaks again after" in visitor.text("#log"))
        visitor.until(lambda: visitor.count("#rows .OK"))
    started = time.monotonic()
    visitor.until(lambda: "NO CONNECTION" in visitor.text("#connection"))
    assert time.monotonic() - started < 20
    visitor.until(lambda: visitor.count(".OK, .alive") == 0)
    assert _worst(visitor).startswith("? UNKNOWN: no connection to the bridge's page: all of this is old, from ")
    assert re.match(r"\([1-9]\d*\) \? UNKNOWN ", visitor.run("return document.title"))


def test_whoever_has_the_token_acts(visitor: Visitor, tmp_path: Path) -> None:
    """A wrong token is refused; the right one acknowledges for all and sets parameters, until it is locked again."""
    token_file = tmp_path / "token"
    with watched_link(token_file) as link:
        visitor.open(link.url)
        visitor.until(lambda: visitor.shown("#unlock"))
        assert not visitor.shown("#parameter-section")
        for token in ("a wrong token of somebody", token_file.read_text().strip()):
            if not visitor.shown("#unlock-dialog"):
                visitor.click("#unlock")
            visitor.enter("#token", token)
            visitor.click("#unlock-form button")
            visitor.until(lambda: visitor.text("#unlock-note") or visitor.shown("#parameter-section"))
            if token.startswith("a wrong"):
                assert visitor.text("#unlock-note") == "the token is wrong"
        assert "127.0.0.1" in visitor.text("#parameters [data-key='dst_ip']")

        visitor.enter("#parameters [name='dst_a_port']", "6010")
        visitor.click("#set")
        visitor.until(lambda: "6010" in visitor.text("#parameters [data-key='dst_a_port']"))

        link.command()
        visitor.until(lambda: "stop drive_motor" in visitor.text("#alarms"))
        visitor.run("scrollTo(0, 0)")
        visitor.click("#alarms button[aria-label*='drive_motor']")
        visitor.until(lambda: "acknowledged on the page" in visitor.text("#log"))
        visitor.run("localStorage.clear(); sessionStorage.clear()")  # as in another browser
        visitor.open(link.url)
        visitor.until(lambda: "acknowledged" in visitor.text("#alarms"))
        assert visitor.text("#unlock") == "Unlock"
        assert not visitor.shown("#parameter-section")
        complaints = [line for line in visitor.complaints() if "401" not in line and "409" not in line]
        assert complaints == []
