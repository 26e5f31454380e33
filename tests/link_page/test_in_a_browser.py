"""The page of the link in a real browser: what an operator sees, hears and clicks."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from bench.followed_page import followed_page
from bench.vision.browser import Visitor
from bench.watched_link import watched_link
from tests.vision.browsing import visiting

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


FITS = "return document.documentElement.scrollWidth <= document.documentElement.clientWidth"  # without the scroll bar


def test_an_operator_watches_a_drive(visitor: Visitor) -> None:
    """Rows, values and plot are live; a stop is a latched alarm with sound, which stays acknowledged after a reload."""
    with watched_link() as link:
        visitor.screen(1280, 900)
        visitor.open(link.url)
        link.boards_speak = link.driver_speaks = True
        visitor.until(lambda: visitor.text("#connection") == "live" and "alive" in visitor.text("#peers"))
        visitor.until(lambda: visitor.count("#rows [data-key='ph_info'] .fields button"))
        visitor.click("#rows [data-key='ph_info'] .fields [data-key='voltage']")
        visitor.until(lambda: visitor.run(CURVE) > 100)
        assert "ph_info voltage: now 2" in visitor.text("#plot-note")
        assert visitor.shown("#no-alarms")

        visitor.click("#sound")
        before = visitor.run("return beeps")
        link.driver_speaks = False
        visitor.until(lambda: "stop drive_motor" in visitor.text("#alarms"))
        assert "told to stop" in visitor.text("#peers")
        assert "STOP" in visitor.text("#rows [data-key='drive_motor'] .state")
        visitor.until(lambda: visitor.run("return beeps") > before)
        assert visitor.run("return document.title").startswith("(1) ")

        link.driver_speaks = True
        visitor.until(lambda: "is over" in visitor.text("#alarms"))  # latched, although the commands are back
        visitor.click("#alarms button")
        visitor.until(lambda: visitor.shown("#no-alarms"))
        visitor.open(link.url)
        visitor.until(lambda: visitor.text("#connection") == "live" and visitor.text("#peers"))
        assert visitor.shown("#no-alarms")

        link.send(b"\xff\xff")
        visitor.until(lambda: "not a valid PBEnvelope" in visitor.text("#log"))
        assert visitor.complaints() == []


@pytest.mark.parametrize("width", [320, 390, 768, 1280])
def test_the_page_fits_screens(visitor: Visitor, tmp_path: Path, width: int) -> None:
    """Nothing is wider than the screen, a phone's among them, with values, alarms, drops and parameters."""
    token_file = tmp_path / "token"
    with watched_link(token_file) as link:
        visitor.screen(width, 800)
        visitor.open(link.url)
        visitor.until(lambda: visitor.shown("#unlock"))
        visitor.click("#unlock")
        visitor.enter("#token", token_file.read_text().strip())
        visitor.click("#unlock-form button")
        visitor.until(lambda: visitor.shown("#parameter-section"))
        link.boards_speak = True
        link.command()
        link.send_payload("imu_info")
        link.send(b"\xff\xff")
        visitor.until(lambda: visitor.count("#alarms li") and visitor.count(".more"))
        visitor.run("document.querySelectorAll('.more').forEach((button) => button.click())")
        assert visitor.run(FITS)
        visitor.run("sessionStorage.clear()")
        assert visitor.complaints() == []


def test_light_unless_dark_is_chosen(visitor: Visitor) -> None:
    """The page is black on white; the choice of dark is kept when the page is opened again."""
    ground = "return getComputedStyle(document.body).backgroundColor"
    with watched_link() as link:
        visitor.open(link.url)
        assert visitor.run(ground) == "rgb(255, 255, 255)"
        visitor.click("#theme")
        dark = visitor.run(ground)
        assert dark != "rgb(255, 255, 255)"
        visitor.open(link.url)
        assert visitor.run(ground) == dark


def test_a_bridge_that_ends_is_noticed(visitor: Visitor) -> None:
    """The page says that it has no connection; it does not go on showing old numbers as live."""
    with watched_link() as link:
        visitor.open(link.url)
        visitor.until(lambda: visitor.text("#connection") == "live")
    started = time.monotonic()
    visitor.until(lambda: "NO CONNECTION" in visitor.text("#connection"))
    assert time.monotonic() - started < 20


def test_boards_are_shown_below_their_peer(visitor: Visitor) -> None:
    """The board that speaks is alive, and the others have not spoken yet."""
    with watched_link() as link:
        visitor.open(link.url)
        visitor.until(lambda: visitor.count(".boards li"))
        link.send_payload("imu_info")
        visitor.until(lambda: "alive" in visitor.text(".boards [data-key='SensorBoard']"))
        assert "no message yet" in visitor.text(".boards [data-key='DrivingBoard']")


def test_schema_and_statistics_stand_inside_the_board(visitor: Visitor) -> None:
    """Each board tells the state of its address, whether its schema is the same, and the loss; it fits a phone."""
    with followed_page() as page:
        page.hear("rover", ages={"imu_info": 0.2, "drive_diag": 0.1}, links=True)
        visitor.screen(390, 800)
        visitor.open(page.url)
        visitor.until(lambda: visitor.count(".boards li"))
        sensor, arm, driving = (
            visitor.text(f".boards [data-key='{name}Board']") for name in ("Sensor", "Arm", "Driving")
        )
        assert "the same schema" in sensor
        assert "loss in 2." in sensor
        assert "host not resolved" in arm
        assert "another schema of drive_diag, drive_motor" in driving
        assert "192.168.0.22:9" in driving
        assert visitor.run(FITS)


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

        visitor.enter("#parameters [name='dst_a_port']", "70000")
        visitor.click("#set")
        visitor.until(lambda: "a UDP port is a number from 1 to 65535" in visitor.text("#parameter-note"))
        visitor.run("document.querySelector('#parameters [name=dst_a_port]').value = ''")
        visitor.enter("#parameters [name='dst_a_port']", "6010")
        visitor.click("#set")
        visitor.until(lambda: "6010" in visitor.text("#parameters [data-key='dst_a_port']"))

        link.command()
        visitor.until(lambda: "stop drive_motor" in visitor.text("#alarms"))
        visitor.run("scrollTo(0, 0)")
        visitor.click("#alarms button")
        visitor.until(lambda: "acknowledged on the page" in visitor.text("#log"))
        visitor.run("localStorage.clear(); sessionStorage.clear()")  # as in another browser
        visitor.open(link.url)
        visitor.until(lambda: "acknowledged" in visitor.text("#alarms"))
        assert visitor.text("#unlock") == "Unlock"
        assert not visitor.shown("#parameter-section")
        complaints = [line for line in visitor.complaints() if "401" not in line and "409" not in line]
        assert complaints == []


def test_a_browser_selects_one_of_several_bridges(visitor: Visitor) -> None:
    """The tabs name the bridges with their new alarms, and the URL keeps the selection, also for a reload."""
    with followed_page() as page:

        def both_speak() -> None:
            for name in ("one", "two"):
                page.hear(name, ages={"imu_info": 9.0} if name == "two" else {"imu_info": 0.5})

        def until(wanted: Callable[[], object]) -> None:
            visitor.until(lambda: both_speak() or wanted())

        page.hear("one")
        visitor.open(page.url)
        visitor.until(lambda: visitor.text("#name") == "one")
        assert not visitor.shown("#tabs")
        until(lambda: visitor.count("#tabs a") == 2 and "1 new" in visitor.text("#tabs [data-key='/two']"))
        assert "/two" in visitor.text("#alarms")
        visitor.click("#tabs [data-key='/two']")
        until(lambda: visitor.text("#name") == "two" and "SILENT" in visitor.text("#peers"))
        assert visitor.run("return location.hash") == "#/two"
        visitor.open("about:blank")
        visitor.open(f"{page.url}#/two")
        until(lambda: visitor.text("#name") == "two" and "SILENT" in visitor.text("#peers"))
        for width in (320, 768, 1280):
            visitor.screen(width, 800)
            assert visitor.run(FITS)
        visitor.open("about:blank")
        visitor.open(f"{page.url}#/three")
        until(lambda: "waiting for the bridge /three" in visitor.text("#connection"))
        visitor.click("#tabs [data-key='/one']")
        until(lambda: visitor.text("#name") == "one" and visitor.text("#connection") == "live")
        assert visitor.complaints() == []
